//! Datagrams with the kernel's arrival times: a delayed wake-up of the process does not change
//! them.

use std::{
    io,
    net::{SocketAddr, UdpSocket},
    time::Duration,
};

/// Socket that reports the arrival times of datagrams.
pub(super) struct TimedSocket(UdpSocket);

#[cfg(target_os = "linux")]
mod linux {
    use std::{io::IoSliceMut, net::SocketAddrV4, os::fd::AsRawFd};

    use nix::{
        cmsg_space,
        sys::{
            socket::{
                ControlMessageOwned, MsgFlags, SockaddrIn, recvmsg, setsockopt,
                sockopt::ReceiveTimestampns,
            },
            time::TimeSpec,
        },
    };

    use super::{Duration, SocketAddr, TimedSocket, UdpSocket, io};

    impl TimedSocket {
        /// Wraps an IPv4 socket.
        pub(in super::super) fn new(socket: UdpSocket) -> Self {
            // Without this option, no datagram has a time, which `receive` reports.
            let _ = setsockopt(&socket, ReceiveTimestampns, &true);
            Self(socket)
        }

        /// Waits for a datagram. Returns its length, its sender and its time of arrival since 1970.
        pub(in super::super) fn receive(
            &self,
            buffer: &mut [u8],
        ) -> io::Result<(usize, SocketAddr, Duration)> {
            let mut parts = [IoSliceMut::new(buffer)];
            let mut space = cmsg_space!(TimeSpec);
            let message = recvmsg::<SockaddrIn>(
                self.0.as_raw_fd(),
                &mut parts,
                Some(&mut space),
                MsgFlags::empty(),
            )?;
            let arrival = message.cmsgs()?.find_map(|part| match part {
                ControlMessageOwned::ScmTimestampns(timestamp) => Some(Duration::from(timestamp)),
                _ => None,
            });
            let sender = message.address.map(|from| SocketAddrV4::from(from).into());
            match (sender, arrival) {
                (Some(sender), Some(arrival)) => Ok((message.bytes, sender, arrival)),
                _ => Err(io::Error::other("a datagram without its sender or its time")),
            }
        }
    }
}

#[cfg(not(target_os = "linux"))]
impl TimedSocket {
    /// Wraps a socket.
    pub(super) fn new(socket: UdpSocket) -> Self {
        Self(socket)
    }

    /// Waits for a datagram. Returns its length, its sender and the time at which it was read,
    /// since 1970.
    pub(super) fn receive(&self, buffer: &mut [u8]) -> io::Result<(usize, SocketAddr, Duration)> {
        let (length, sender) = self.0.recv_from(buffer)?;
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        Ok((length, sender, now.unwrap_or_default()))
    }
}

#[cfg(target_os = "linux")]
#[cfg(test)]
mod tests {
    use std::{
        net::Ipv4Addr,
        thread,
        time::{SystemTime, UNIX_EPOCH},
    };

    use super::*;

    #[test]
    fn a_datagram_has_the_time_at_which_it_came_and_not_that_at_which_it_is_read() {
        let bind = || UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let (from, to) = (bind(), bind());
        let address = to.local_addr().unwrap();
        let to = TimedSocket::new(to);
        let now = || SystemTime::now().duration_since(UNIX_EPOCH).unwrap();
        // A coarse kernel clock has steps of some milliseconds.
        let step = Duration::from_millis(10);
        // The kernel starts recording arrival times with a delay; until then, the time of reading
        // is returned.
        let is_noted = (0..100).any(|_| {
            let before = now();
            from.send_to(b"abc", address).unwrap();
            let after = now();
            thread::sleep(Duration::from_millis(30));
            let mut buffer = [0; 10];
            let (length, sender, arrival) = to.receive(&mut buffer).unwrap();
            assert_eq!((&buffer[..length], sender), (&b"abc"[..], from.local_addr().unwrap()));
            assert!(arrival + step > before, "{before:?} {arrival:?}");
            arrival < after + step
        });
        assert!(is_noted);
    }
}
