//! The thread that answers the controller every cycle.
//!
//! Nothing in it waits: what it measures goes into a channel without bound and to subscribers over a
//! PUB socket, which drops what a subscriber does not take; what it is told comes from a channel that it
//! looks into once a cycle.

use std::{
    io::ErrorKind,
    net::{IpAddr, UdpSocket},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, Sender},
    },
    time::{Duration, Instant},
};

use iiwa_kin::Joints;
use serde::Serialize;

use super::punctuality::Account;
use crate::{
    fri::{Client, Format, Monitoring, Quality, Received, Safety, SessionState},
    message::{DriveState, Refusal},
    playback::{Motion, Playback, STOP_S},
    security::GuardedSocket,
    socket::is_timeout,
    timed_joints::TimedJoints,
};

/// What the FRI thread is told.
pub(super) enum Order {
    /// Run this trajectory as soon as the session commands.
    Run(Box<TimedJoints>),
    /// Stop it on its path.
    Stop,
    /// Forget it.
    Release,
    /// Publish a state.
    Publish(DriveState),
}

/// What the FRI thread tells.
pub(super) enum Event {
    /// A message of the controller has come.
    Heard(Heard),
    /// The trajectory has come to rest.
    Ended {
        start_s: f64,
        end_s: f64,
        /// Where along the trajectory, and of how much, in s, if it was stopped on the way.
        stopped: Option<[f64; 2]>,
        /// Not freed in the FRI thread.
        _trajectory: Box<Playback<Offset>>,
    },
    /// The session has left commanding in the middle of the trajectory.
    Broken { start_s: f64, end_s: f64, error: Refusal, _trajectory: Box<Playback<Offset>> },
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

/// A trajectory, from where the robot really is: the difference fades within the first half second.
pub(super) struct Offset {
    trajectory: Box<TimedJoints>,
    offset_rad: Joints,
}

/// How long it takes a difference at the start to fade, in s. Half a degree takes 2 % of the acceleration
/// limits then.
const FADE_S: f64 = 0.5;

/// Less than this is not waited for, in rad.
const NO_OFFSET_RAD: f64 = 1e-5;

impl Motion for Offset {
    fn at(&self, t_s: f64) -> Joints {
        let x = (t_s / FADE_S).clamp(0.0, 1.0);
        let left = 1.0 - x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
        let mut q = self.trajectory.at(t_s);
        for (q, offset) in q.iter_mut().zip(&self.offset_rad) {
            *q += left * offset;
        }
        q
    }

    fn duration_s(&self) -> f64 {
        let fades = self.offset_rad.iter().any(|offset| offset.abs() > NO_OFFSET_RAD);
        self.trajectory.duration_s().max(if fades { FADE_S } else { 0.0 })
    }
}

/// The trajectory in hand.
pub(super) enum Task {
    Nothing,
    /// Until the session commands.
    Waiting(Box<TimedJoints>),
    Running {
        playback: Box<Playback<Offset>>,
        start_s: f64,
        /// Time of the last set-point.
        at_s: f64,
    },
}

pub(super) struct FriThread {
    pub(super) udp: UdpSocket,
    /// Only the cabinet is listened to.
    pub(super) cabinet: IpAddr,
    pub(super) stream: GuardedSocket,
    pub(super) orders: Receiver<Order>,
    pub(super) events: Sender<Event>,
    pub(super) account: Arc<Account>,
}

/// How often the thread looks for orders while the controller is silent.
pub(super) const AWAKE: Duration = Duration::from_millis(20);

impl FriThread {
    /// Answers until `over`.
    pub(super) fn run(self, over: &AtomicBool) {
        let Self { udp, cabinet, stream, orders, events, account } = self;
        account.raised(crate::priority::raise());
        let mut line =
            Line { client: Client::new(Format::V1), clock: Clock::default(), stream, events };
        let mut task = Task::Nothing;
        let mut last_rad = None;
        let mut buffer = [0; 2048];
        let mut answer = Vec::with_capacity(1500);
        while !over.load(Ordering::Relaxed) {
            for order in orders.try_iter() {
                let next = match (order, &mut task) {
                    (Order::Run(trajectory), _) => Task::Waiting(trajectory),
                    (Order::Release, _) => Task::Nothing,
                    (Order::Stop, Task::Running { playback, .. }) => {
                        playback.stop(STOP_S);
                        continue;
                    }
                    (Order::Stop, _) => {
                        let _ = line.events.send(Event::Discarded);
                        Task::Nothing
                    }
                    (Order::Publish(state), _) => {
                        line.publish_state(state);
                        continue;
                    }
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
            let (next, setpoint) = step(task, &message, t_s, &line.events);
            task = next;
            if line.client.answer(setpoint.as_ref(), &mut answer) {
                // Not asked afterwards: the answer may wake others who run first then.
                let is_behind = is_next_there(&udp, cabinet);
                // The controller counts what does not arrive.
                let _ = udp.send_to(&answer, from);
                account.answered(read_at.elapsed(), is_behind);
            }
            // All else comes after the answer.
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

/// As near as this the robot has got the last set-point, in rad.
const ARRIVED_RAD: f64 = 1e-4;

/// Goes on with the trajectory as far as this message goes, and gives the set-point.
fn step(
    task: Task,
    message: &Monitoring,
    t_s: f64,
    events: &Sender<Event>,
) -> (Task, Option<Joints>) {
    let commands = message.session == SessionState::CommandingActive;
    let ahead_s =
        f64::from(message.send_period_ms.max(1) * message.receive_multiplier.max(1)) * 1e-3;
    match task {
        Task::Nothing => (Task::Nothing, None),
        Task::Waiting(trajectory) if commands => {
            let q = message.ipo_rad.or(message.commanded_rad).or(message.measured_rad);
            let start = trajectory.at(0.0);
            let offset_rad = q.map_or([0.0; 7], |q| std::array::from_fn(|j| q[j] - start[j]));
            let mut playback = Box::new(Playback::new(Offset { trajectory, offset_rad }));
            playback.advance(ahead_s);
            let setpoint = playback.position();
            (Task::Running { playback, start_s: t_s, at_s: t_s }, Some(setpoint))
        }
        Task::Waiting(trajectory) => (Task::Waiting(trajectory), None),
        Task::Running { playback, start_s, .. } if !commands => {
            let error = Refusal::robot(format!(
                "FRI does not command any more: session {}, quality {}",
                message.session.name(),
                message.quality.name()
            ));
            let _ =
                events.send(Event::Broken { start_s, end_s: t_s, error, _trajectory: playback });
            (Task::Nothing, None)
        }
        Task::Running { mut playback, start_s, at_s } => {
            let setpoint = playback.position();
            let there = |q: Joints| (0..7).all(|j| (q[j] - setpoint[j]).abs() < ARRIVED_RAD);
            if playback.is_over() && t_s > at_s && message.commanded_rad.is_none_or(there) {
                let stopped =
                    playback.is_cut_short().then(|| [playback.at_s(), playback.duration_s()]);
                let _ = events.send(Event::Ended {
                    start_s,
                    end_s: t_s,
                    stopped,
                    _trajectory: playback,
                });
                return (Task::Nothing, Some(setpoint));
            }
            // By the controller's clock: a lost message costs no time.
            playback.advance((t_s - at_s).max(0.0));
            let setpoint = playback.position();
            (Task::Running { playback, start_s, at_s: t_s }, Some(setpoint))
        }
    }
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

/// The stream's time: that of the controller since it was first heard of. It goes on when the controller
/// starts again.
#[derive(Default)]
struct Clock {
    /// What the controller's clock says more, in s.
    ahead_s: f64,
    last_s: f64,
    /// When the last message came; none before the first one of a controller.
    heard: Option<Instant>,
    restarted: bool,
}

impl Clock {
    fn restart(&mut self) {
        self.restarted = true;
    }

    fn stream_s(&mut self, message: &Monitoring) -> f64 {
        let now = Instant::now();
        let silence_s = self.heard.map_or(0.0, |heard| now.duration_since(heard).as_secs_f64());
        let cycle_s = f64::from(message.send_period_ms.max(1)) * 1e-3;
        // Without time stamps, messages come as they were sent: a cycle after the other.
        let controller_s = message.time.map_or_else(
            || self.ahead_s + self.last_s + cycle_s.max(silence_s.floor()),
            |t| t.as_secs_f64(),
        );
        if self.heard.is_none() {
            self.ahead_s = controller_s;
        } else if self.restarted || controller_s <= self.ahead_s + self.last_s {
            self.ahead_s = controller_s - self.last_s - silence_s.max(cycle_s);
        }
        self.restarted = false;
        self.heard = Some(now);
        self.last_s = controller_s - self.ahead_s;
        self.last_s
    }
}
