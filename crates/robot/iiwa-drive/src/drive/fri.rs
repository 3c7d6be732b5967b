//! The thread that answers the controller every cycle.
//!
//! This thread never blocks on other threads: events are sent to an unbounded channel, publications
//! to a bounded channel that drops the excess, and commands are polled once per cycle.

use std::{
    io::ErrorKind,
    net::{IpAddr, UdpSocket},
    sync::{
        Arc, Barrier,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, Sender, SyncSender},
    },
    time::{Duration, Instant},
};

use iiwa_kin::Limits;
use iiwa_link::{Published, socket::is_timeout, threads::raise_priority};

use super::{
    answer_latency::LatencyRecorder,
    events::{FriCommand, FriEvent, Observation},
    responder::{Reception, Responder},
};

pub(super) struct FriThread {
    pub(super) udp: UdpSocket,
    /// The address that messages are accepted from.
    pub(super) cabinet: IpAddr,
    /// The robot's limits.
    pub(super) limits: Limits,
    pub(super) stream: SyncSender<Published>,
    pub(super) commands: Receiver<FriCommand>,
    pub(super) events: Sender<FriEvent>,
    pub(super) latency: Arc<LatencyRecorder>,
    /// Passed once the priority of the thread is set.
    pub(super) ready: Arc<Barrier>,
}

/// Poll interval for commands while the controller is silent.
pub(super) const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Time-out of stopping a trajectory when the drive shuts down.
const FINAL_STOP_TIMEOUT: Duration = Duration::from_secs(1);

impl FriThread {
    /// Answers messages until `shutdown`, then stops a trajectory on its path.
    pub(super) fn run(self, shutdown: &AtomicBool) {
        self.latency.raised(raise_priority());
        self.ready.wait();
        let mut responder = Responder::new(self.cabinet, &self.limits);
        let mut buffer = [0; 2048];
        // Room for a whole datagram, so that the loop does not allocate.
        let mut answer = Vec::with_capacity(1500);
        let mut deadline = None;
        loop {
            if shutdown.load(Ordering::Relaxed) {
                // In each cycle, because a queued command may still start a trajectory.
                responder.stop(false);
                let deadline = *deadline.get_or_insert_with(|| Instant::now() + FINAL_STOP_TIMEOUT);
                if !responder.moves() || Instant::now() >= deadline {
                    return;
                }
            }
            for command in self.commands.try_iter() {
                self.carry_out(command, &mut responder);
            }
            responder.check_timeouts(Instant::now());
            self.forward_events(&mut responder);
            let (length, from) = match self.udp.recv_from(&mut buffer) {
                Ok(received) => received,
                Err(error) => {
                    if !is_timeout(&error) {
                        tracing::warn!("FRI: {error}");
                        // A persistent error must not occupy a processor with real-time priority.
                        std::thread::sleep(POLL_INTERVAL);
                    }
                    continue;
                }
            };
            let read_at = Instant::now();
            let reception = responder.receive(&buffer[..length], from, read_at, &mut answer);
            self.latency.ignored(responder.ignored());
            if reception == Reception::Ignored {
                continue;
            }
            self.latency.received();
            if reception == Reception::Answered {
                // Checked before sending: the answer may wake other threads, which may run first.
                let is_behind = self.has_next_message();
                // A send error is ignored: the controller counts missing answers.
                let _ = self.udp.send_to(&answer, from);
                self.latency.answered(read_at.elapsed(), is_behind);
            }
            // All other work follows the answer.
            self.forward_events(&mut responder);
        }
    }

    fn carry_out(&self, command: FriCommand, responder: &mut Responder) {
        match command {
            FriCommand::Run(run, trajectory) => responder.run(run, trajectory, Instant::now()),
            FriCommand::Stop => responder.stop(true),
            FriCommand::Release => responder.stop(false),
            FriCommand::Publish(state) => {
                self.publish(Published::State { t_s: responder.time_s(), state });
            }
        }
    }

    fn forward_events(&self, responder: &mut Responder) {
        for event in responder.take_events() {
            if let FriEvent::Observed(Observation { t_s, joints_rad, torques_nm, .. }) = event {
                if let Some([measured_nm, external_nm]) = torques_nm {
                    self.publish(Published::Torques { t_s, measured_nm, external_nm });
                }
                self.publish(Published::Joints { t_s, joints_rad });
            }
            // The receiver outlives this thread.
            let _ = self.events.send(event);
        }
    }

    fn publish(&self, published: Published) {
        let _ = self.stream.try_send(published);
    }

    /// Returns true if the next controller message has already arrived.
    fn has_next_message(&self) -> bool {
        // Non-blocking for this call only: no other thread uses the socket.
        if self.udp.set_nonblocking(true).is_err() {
            return false;
        }
        let has_next = match self.udp.peek_from(&mut [0; 64]) {
            Ok((_, from)) => from.ip() == self.cabinet,
            // Some systems report an error for a message longer than the buffer.
            Err(error) => !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted),
        };
        let _ = self.udp.set_nonblocking(false);
        has_next
    }
}
