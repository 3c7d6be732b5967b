//! Ports that nobody else uses.

use std::{
    net::{Ipv4Addr, SocketAddr, TcpListener, UdpSocket},
    sync::atomic::{AtomicU32, Ordering},
};

/// Below the ports that systems give to outgoing connections, one of which could take a port between
/// its choice and its use.
const FIRST: u32 = 10_000;
const COUNT: u32 = 20_000;

/// A port of the loopback interface that is free for TCP and UDP; another one each time.
///
/// # Panics
///
/// If there is none.
#[expect(clippy::expect_used, reason = "a test fails by it")]
#[must_use]
pub fn free_port() -> u16 {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    // Processes that run at the same time begin far from each other.
    let from = std::process::id().wrapping_mul(7919);
    (0..COUNT)
        .filter_map(|_| {
            let place = from.wrapping_add(NEXT.fetch_add(1, Ordering::Relaxed)) % COUNT;
            u16::try_from(FIRST + place).ok()
        })
        .find(|port| {
            let address = (Ipv4Addr::LOCALHOST, *port);
            TcpListener::bind(address).is_ok() && UdpSocket::bind(address).is_ok()
        })
        .expect("a free port")
}

/// The loopback address with such a port.
#[must_use]
pub fn free_address() -> SocketAddr {
    SocketAddr::from((Ipv4Addr::LOCALHOST, free_port()))
}
