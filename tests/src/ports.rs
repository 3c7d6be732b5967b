//! Ports for exclusive use, each assigned once.
//!
//! Ports are assigned in blocks. A block belongs to the process that holds its first UDP port, the
//! guard, which the system releases when the process ends, for any reason. `tests/browser/ports.py`
//! and `Ports.java` in `sunrise/src/test` use the same blocks.

use std::{
    collections::HashSet,
    fs,
    net::{Ipv4Addr, SocketAddr, TcpListener, UdpSocket},
    ops::{Range, RangeInclusive},
    sync::{LazyLock, Mutex, PoisonError},
    vec,
};

/// Range below the ports that most systems assign to outgoing connections; ports below 10 000 are
/// for scripts with fixed ports.
const PORTS: Range<u16> = 10_000..30_000;

/// Number of ports of a block, with its guard.
const BLOCK: u16 = 50;

static RESERVED: LazyLock<Mutex<Reserved>> = LazyLock::new(|| Mutex::new(Reserved::new()));

/// Ports of this process.
struct Reserved {
    /// First ports of blocks not tried yet; the last entry is the next one.
    untried: Vec<u16>,
    guards: Vec<UdpSocket>,
    /// Ports of the newest block that were free when it was reserved, and have not been assigned.
    left: vec::IntoIter<u16>,
}

impl Reserved {
    fn new() -> Self {
        let mut untried: Vec<_> = PORTS.step_by(BLOCK.into()).collect();
        // Processes that start together seldom try the same block, and the block of an ended
        // process is not reused at once.
        let first = std::process::id() as usize % untried.len();
        untried.rotate_left(first);
        // An outgoing connection could use a port between its selection and its use: such blocks
        // come last.
        let outgoing = outgoing();
        untried.sort_by_key(|begin| {
            !(*outgoing.end() < *begin || begin + (BLOCK - 1) < *outgoing.start())
        });
        untried.reverse();
        Self { untried, guards: Vec::new(), left: Vec::new().into_iter() }
    }

    fn next(&mut self) -> Option<u16> {
        loop {
            if let Some(port) = self.left.next() {
                return Some(port);
            }
            let begin = self.untried.pop()?;
            if let Ok(guard) = UdpSocket::bind((Ipv4Addr::LOCALHOST, begin)) {
                self.guards.push(guard);
                self.left = free_of(begin + 1..begin + BLOCK).into_iter();
            }
        }
    }
}

/// Returns the ports that this system assigns to outgoing connections.
fn outgoing() -> RangeInclusive<u16> {
    let text = fs::read_to_string("/proc/sys/net/ipv4/ip_local_port_range").unwrap_or_default();
    let mut ends = text.split_whitespace().map_while(|end| end.parse().ok());
    // Without the file: the IANA range, which macOS and Windows use.
    ends.next().zip(ends.next()).map_or(49_152..=u16::MAX, |(first, last)| first..=last)
}

/// Returns the ports of a block that no program uses, including programs that do not use blocks.
fn free_of(block: Range<u16>) -> Vec<u16> {
    let Some(taken) = listed() else {
        return block.filter(|port| can_be_bound(*port)).collect();
    };
    block.filter(|port| !taken.contains(port)).collect()
}

/// Returns the ports of all sockets, if the system lists them. Trying to bind would be wrong: a
/// child process started by another thread inherits all sockets until it executes its own program,
/// and the port would remain in use that long.
fn listed() -> Option<HashSet<u16>> {
    let read = |protocol: &str| fs::read_to_string(format!("/proc/net/{protocol}"));
    let [tcp, udp] = [read("tcp").ok()?, read("udp").ok()?];
    // Not every system has IPv6.
    let [tcp6, udp6] = ["tcp6", "udp6"].map(|protocol| read(protocol).unwrap_or_default());
    Some([tcp, udp, tcp6, udp6].iter().flat_map(|list| list.lines().filter_map(local)).collect())
}

/// Returns the local port in a line of such a list.
fn local(line: &str) -> Option<u16> {
    let (_, port) = line.split_whitespace().nth(1)?.rsplit_once(':')?;
    u16::from_str_radix(port, 16).ok()
}

fn can_be_bound(port: u16) -> bool {
    let address = (Ipv4Addr::LOCALHOST, port);
    TcpListener::bind(address).is_ok() && UdpSocket::bind(address).is_ok()
}

/// Returns a port of the loopback interface that is free for TCP and UDP. No other process that
/// uses this function gets the port during the life of this process, and this process does not get
/// it again.
///
/// # Panics
///
/// Panics if all ports are in use.
#[expect(clippy::expect_used, reason = "a test fails by it")]
#[must_use]
pub fn free_port() -> u16 {
    RESERVED.lock().unwrap_or_else(PoisonError::into_inner).next().expect("a free port")
}

/// Returns the loopback address with a free port.
#[must_use]
pub fn free_address() -> SocketAddr {
    SocketAddr::from((Ipv4Addr::LOCALHOST, free_port()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ports_in_use_are_left_out() {
        let [of_tcp, of_udp] = [free_address(), free_address()];
        let free = |address: SocketAddr| free_of(address.port()..address.port() + 1);
        for address in [of_tcp, of_udp] {
            assert_eq!(free(address), [address.port()]);
        }
        let _tcp = TcpListener::bind(of_tcp).unwrap();
        let _udp = UdpSocket::bind(of_udp).unwrap();
        for address in [of_tcp, of_udp] {
            assert!(free(address).is_empty());
        }
    }
}
