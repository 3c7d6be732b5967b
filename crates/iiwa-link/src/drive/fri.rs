//! The thread that answers the controller every cycle.
//!
//! Nothing in it waits: what it measures goes into a channel without bound and to subscribers over a
//! PUB socket, which drops what a subscriber does not take; what it is told comes from a channel that it
//! looks into once a cycle.

use std::{
    io::ErrorKind,
    net::{IpAddr, UdpSocket},
    sync::{
        Arc, Barrier,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, Sender},
    },
    time::{Duration, Instant},
};

use iiwa_kin::Joints;
use serde::Serialize;

use super::{
    clock::Clock,
    punctuality::Account,
    setpoints::{Over, Task},
};
use crate::{
    fri::{Client, Format, Monitoring, Quality, Received, Safety, SessionState},
    message::DriveState,
    robot_program::RunId,
    security::GuardedSocket,
    socket::is_timeout,
    timed_joints::TimedJoints,
};

/// What the FRI thread is told.
pub(super) enum Order {
    /// Run this trajectory as soon as the session commands.
    Run(RunId, Box<TimedJoints>),
    /// Stop it on its path.
    Stop,
    /// Forget it; if the arm moves, only after a stop on its path.
    Release,
    /// Publish a state.
    Publish(DriveState),
}

/// What the FRI thread tells.
pub(super) enum Event {
    /// A message of the controller has come.
    Heard(Heard),
    /// The trajectory is over.
    Over(Over),
    /// The trajectory was to be stopped, and has not begun.
    Discarded,
    /// What is not needed any more: it is freed where time does not count.
    Freed(#[expect(dead_code, reason = "it is freed")] Task),
}

/// A message of the controller, with what it says of the connection.
#[derive(Clone, Copy, Debug)]
pub(super) struct Heard {
    /// Time of the stream, in s.
    pub(super) t_s: f64,
    /// What the controller's clock says more than the stream's, in s.
    pub(super) clock_ahead_s: f64,
    pub(super) joints_rad: Joints,
    pub(super) session: SessionState,
    pub(super) quality: Quality,
    pub(super) safety: Safety,
    pub(super) lost: u64,
    pub(super) late: u64,
    pub(super) at: Instant,
}

pub(super) struct FriThread {
    pub(super) udp: UdpSocket,
    /// Only the cabinet is listened to.
    pub(super) cabinet: IpAddr,
    pub(super) stream: GuardedSocket,
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
        let Self { udp, cabinet, stream, orders, events, account, ready } = self;
        account.raised(crate::priority::raise());
        ready.wait();
        let mut line =
            Line { client: Client::new(Format::V1), clock: Clock::default(), stream, events };
        let mut task = Task::Nothing;
        let mut last_rad = None;
        let mut buffer = [0; 2048];
        let mut answer = Vec::with_capacity(1500);
        let mut until = None;
        loop {
            if over.load(Ordering::Relaxed) {
                task.stop();
                let until = *until.get_or_insert_with(|| Instant::now() + LAST_STOP);
                if !task.moves() || Instant::now() >= until {
                    return;
                }
            }
            for order in orders.try_iter() {
                let next = match order {
                    Order::Publish(state) => {
                        line.publish_state(state);
                        continue;
                    }
                    Order::Stop | Order::Release if task.moves() => {
                        task.stop();
                        continue;
                    }
                    Order::Stop => {
                        let _ = line.events.send(Event::Discarded);
                        Task::Nothing
                    }
                    Order::Release => Task::Nothing,
                    Order::Run(run, trajectory) => Task::Waiting { run, trajectory, armed: false },
                };
                let _ = line.events.send(Event::Freed(std::mem::replace(&mut task, next)));
            }
            let (length, from) = match udp.recv_from(&mut buffer) {
                Ok(received) => received,
                Err(error) => {
                    if !is_timeout(&error) {
                        tracing::warn!("FRI: {error}");
                        std::thread::sleep(AWAKE);
                    }
                    continue;
                }
            };
            if from.ip() != cabinet {
                continue;
            }
            let read_at = Instant::now();
            match line.client.receive(&buffer[..length]) {
                Ok(Received::New) => {}
                Ok(Received::Restarted) => line.clock.restart(),
                Ok(Received::Late | Received::Repeated) => continue,
                Err(error) => {
                    tracing::debug!("FRI: {error}");
                    continue;
                }
            }
            account.received();
            let Some(message) = line.client.latest().cloned() else { continue };
            let t_s = line.clock.stream_s(&message);
            let (setpoint, over) = task.advance(&message, t_s);
            if line.client.answer(setpoint.as_ref(), &mut answer) {
                // Not asked afterwards: the answer may wake others who run first then.
                let is_behind = is_next_there(&udp, cabinet);
                // The controller counts what does not arrive.
                let _ = udp.send_to(&answer, from);
                account.answered(read_at.elapsed(), is_behind);
            }
            // All else comes after the answer.
            if let Some(over) = over {
                let _ = line.events.send(Event::Over(over));
                let _ = line.events.send(Event::Freed(std::mem::take(&mut task)));
            }
            if let Some(joints_rad) = message.measured_rad.or(last_rad) {
                last_rad = Some(joints_rad);
                line.tell(&message, t_s, joints_rad);
            }
        }
    }
}

/// Whether the controller's next message has come in already.
fn is_next_there(udp: &UdpSocket, cabinet: IpAddr) -> bool {
    // A moment's look: nobody else uses the socket, which waits otherwise.
    if udp.set_nonblocking(true).is_err() {
        return false;
    }
    let is_there = match udp.peek_from(&mut [0; 64]) {
        Ok((_, from)) => from.ip() == cabinet,
        // Some systems say so of a message longer than the buffer.
        Err(error) => !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted),
    };
    let _ = udp.set_nonblocking(false);
    is_there
}

/// What is heard goes out on this side.
struct Line {
    client: Client,
    clock: Clock,
    stream: GuardedSocket,
    events: Sender<Event>,
}

impl Line {
    fn tell(&mut self, message: &Monitoring, t_s: f64, joints_rad: Joints) {
        #[derive(Serialize)]
        struct Published<'a> {
            t_s: f64,
            joints_rad: &'a Joints,
        }
        let counters = self.client.counters();
        let heard = Heard {
            t_s,
            clock_ahead_s: self.clock.ahead_s,
            joints_rad,
            session: message.session,
            quality: message.quality,
            safety: message.safety.unwrap_or_default(),
            lost: counters.lost,
            late: counters.late,
            at: Instant::now(),
        };
        // The other end goes away last.
        let _ = self.events.send(Event::Heard(heard));
        self.publish("joints", &Published { t_s, joints_rad: &joints_rad });
    }

    fn publish_state(&self, state: DriveState) {
        #[derive(Serialize)]
        struct Published {
            t_s: f64,
            state: DriveState,
        }
        self.publish("state", &Published { t_s: self.clock.last_s, state });
    }

    fn publish(&self, topic: &str, message: &impl Serialize) {
        let text = crate::message::to_json(message);
        // A PUB socket never waits: it drops what a subscriber has no room for.
        let _ = self.stream.send_multipart([topic.as_bytes(), text.as_bytes()], zmq::DONTWAIT);
    }
}
