//! FRI threads: the controller clock, and the reception of answers.

use std::{
    net::{Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket},
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use iiwa_link::{
    LinkError,
    socket::{Server, is_timeout},
    threads::raise_priority,
};

use crate::shared::{CabinetState, POLL_INTERVAL, lock};

/// Binds the UDP socket; returns a handle for each of the two threads.
pub(crate) fn sockets(client: SocketAddr, security: &Server) -> Result<[UdpSocket; 2], LinkError> {
    let local = match client {
        client if client.ip().is_loopback() => SocketAddr::new(client.ip(), 0),
        // FRI is not authenticated, so at least the other sockets have to be.
        _ if !security.has_keys() => {
            return Err(LinkError::FriNeedsKeys { client });
        }
        SocketAddr::V4(_) => SocketAddr::from((Ipv4Addr::UNSPECIFIED, 0)),
        SocketAddr::V6(_) => SocketAddr::from((Ipv6Addr::UNSPECIFIED, 0)),
    };
    let bind = || {
        let udp = UdpSocket::bind(local)?;
        udp.set_read_timeout(Some(POLL_INTERVAL))?;
        let answers = udp.try_clone()?;
        Ok([udp, answers])
    };
    bind().map_err(|source| LinkError::Udp { address: local.to_string(), source })
}

/// Runs the controller clock: one cycle per `period`. If the machine delays the clock by more than
/// half a period, robot time is shifted without gaps: a controller leaves its client a whole cycle
/// for each answer.
pub(crate) fn run_clock(
    shared: &CabinetState,
    udp: &UdpSocket,
    client: SocketAddr,
    period: Duration,
    shutdown: &AtomicBool,
) {
    let real_time = raise_priority();
    lock(&shared.link).real_time = real_time;
    let mut next = Instant::now() + period;
    let mut message = Vec::with_capacity(1500);
    while !shutdown.load(Ordering::Relaxed) {
        thread::sleep(next.saturating_duration_since(Instant::now()));
        // Read after sleeping, because the process may have been suspended meanwhile.
        let now = Instant::now();
        if now.saturating_duration_since(next) > period / 2 {
            next = now;
            lock(&shared.link).delayed_cycles += 1;
        }
        next += period;
        let due = lock(&shared.simulation).tick(&mut message);
        let datagram = lock(&shared.link).send(due.then_some(message.as_slice()));
        if let Some(datagram) = datagram {
            // A send error is ignored: the client may not listen yet.
            let _ = udp.send_to(&datagram, client);
        }
    }
}

/// Receives the client answers.
pub(crate) fn receive_answers(
    shared: &CabinetState,
    udp: &UdpSocket,
    client: SocketAddr,
    shutdown: &AtomicBool,
) {
    // The thread also works at ordinary priority.
    let _ = raise_priority();
    let mut buffer = [0; 2048];
    while !shutdown.load(Ordering::Relaxed) {
        let (length, from) = match udp.recv_from(&mut buffer) {
            Ok(received) => received,
            Err(error) if is_timeout(&error) => continue,
            Err(error) => {
                tracing::warn!("FRI: {error}");
                thread::sleep(POLL_INTERVAL);
                continue;
            }
        };
        let now = Instant::now();
        let datagram = &buffer[..length];
        if from.ip() != client.ip() || !lock(&shared.link).receive(datagram, now) {
            continue;
        }
        if let Err(error) = lock(&shared.simulation).fri().receive(datagram) {
            tracing::debug!("FRI: {error}");
        }
    }
}
