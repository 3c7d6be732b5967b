//! The thread that answers the controller every cycle.
//!
//! Nothing in it waits for anybody else: what it measures goes into a channel without bound, what is to be
//! published into one that drops what there is no room for; what it is told comes from a channel that it
//! looks into once a cycle.

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
use iiwa_link::{Published, socket::is_timeout};

pub(super) use super::answerer::{Event, Heard, Order};
use super::{
    answerer::{Answerer, Outcome},
    punctuality::Account,
};

pub(super) struct FriThread {
    pub(super) udp: UdpSocket,
    /// Only the cabinet is listened to.
    pub(super) cabinet: IpAddr,
    /// The robot's limits, which no set-point exceeds.
    pub(super) limits: Limits,
    pub(super) stream: SyncSender<Published>,
    pub(super) orders: Receiver<Order>,
    pub(super) events: Sender<Event>,
    pub(super) account: Arc<Account>,
    /// Passed once the thread has the priority that it gets.
    pub(super) ready: Arc<Barrier>,
}

/// How often the thread looks for orders while the controller is silent.
pub(super) const AWAKE: Duration = Duration::from_millis(20);

/// How long an arm that moves may take to stop when the drive ends.
const LAST_STOP: Duration = Duration::from_secs(1);

impl FriThread {
    /// Answers until `over`; a trajectory is stopped on its path then.
    pub(super) fn run(self, over: &AtomicBool) {
        self.account.raised(crate::priority::raise());
        self.ready.wait();
        let mut answerer = Answerer::new(self.cabinet, &self.limits);
        let mut buffer = [0; 2048];
        let mut answer = Vec::with_capacity(1500);
        let mut until = None;
        loop {
            if over.load(Ordering::Relaxed) {
                answerer.stop(false);
                let until = *until.get_or_insert_with(|| Instant::now() + LAST_STOP);
                if !answerer.moves() || Instant::now() >= until {
                    return;
                }
            }
            for order in self.orders.try_iter() {
                self.take(order, &mut answerer);
            }
            answerer.wait(Instant::now());
            self.tell(&mut answerer);
            let (length, from) = match self.udp.recv_from(&mut buffer) {
                Ok(received) => received,
                Err(error) => {
                    if !is_timeout(&error) {
                        tracing::warn!("FRI: {error}");
                        std::thread::sleep(AWAKE);
                    }
                    continue;
                }
            };
            let read_at = Instant::now();
            let outcome = answerer.receive(&buffer[..length], from, read_at, &mut answer);
            self.account.ignored(answerer.ignored());
            if outcome == Outcome::Nothing {
                continue;
            }
            self.account.received();
            if outcome == Outcome::Answered {
                // Not asked afterwards: the answer may wake others who run first then.
                let is_behind = self.is_next_there();
                // The controller counts what does not arrive.
                let _ = self.udp.send_to(&answer, from);
                self.account.answered(read_at.elapsed(), is_behind);
            }
            // All else comes after the answer.
            self.tell(&mut answerer);
        }
    }

    fn take(&self, order: Order, answerer: &mut Answerer) {
        match order {
            Order::Run(run, trajectory) => answerer.run(run, trajectory, Instant::now()),
            Order::Stop => answerer.stop(true),
            Order::Release => answerer.stop(false),
            Order::Publish(state) => {
                self.publish(Published::State { t_s: answerer.time_s(), state });
            }
        }
    }

    fn tell(&self, answerer: &mut Answerer) {
        for event in answerer.take_events() {
            if let Event::Heard(Heard { t_s, joints_rad, .. }) = event {
                self.publish(Published::Joints { t_s, joints_rad });
            }
            // The other end goes away last.
            let _ = self.events.send(event);
        }
    }

    fn publish(&self, published: Published) {
        let _ = self.stream.try_send(published);
    }

    /// Whether the controller's next message has come in already.
    fn is_next_there(&self) -> bool {
        // A moment's look: nobody else uses the socket, which waits otherwise.
        if self.udp.set_nonblocking(true).is_err() {
            return false;
        }
        let is_there = match self.udp.peek_from(&mut [0; 64]) {
            Ok((_, from)) => from.ip() == self.cabinet,
            // Some systems say so of a message longer than the buffer.
            Err(error) => !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted),
        };
        let _ = self.udp.set_nonblocking(false);
        is_there
    }
}
