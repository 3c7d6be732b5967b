//! Observation of a robot: one thread reads its stream, a second one polls other data, and a third
//! one forwards both.

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc::{SyncSender, sync_channel},
    },
    time::{Duration, Instant},
};

use iiwa_link::{
    Client, Published, Stream,
    message::{DriveState, DriveStatus, Presence, Signal},
    threads::ThreadGroup,
};

use crate::{
    BridgeError,
    message::{
        BridgeStatus, Content, CycleSample, Kind, Message, RobotConditions, Timestamp, VERSION,
    },
    robot::BridgedRobot,
    sink::Sink,
    trouble::{Trouble, pause},
};

/// Time-out of the stream, after which the shutdown flag is checked.
const POLL: Duration = Duration::from_millis(100);

/// Messages that were read and not forwarded yet, at most: those of ten seconds at 1 ms. A drive
/// keeps those of two seconds, and a busy disk may stall the spools of sinks for longer.
const MOST_WAITING: usize = 10_000;

/// Poll interval of the drive state, and of the sensors, inputs and outputs of an idle robot.
const ASK_EVERY: Duration = Duration::from_secs(1);

/// Interval after which unchanged values are repeated.
const REPEAT_AFTER: Duration = Duration::from_secs(10);

/// Pause after a refused connection.
const REFUSED_PAUSE: Duration = Duration::from_secs(5);

/// Threads that observe a robot. Dropping the feed ends them.
pub struct Feed {
    numbered: Arc<Numbered>,
    _threads: ThreadGroup,
}

impl std::fmt::Debug for Feed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Feed").field("robot", &self.numbered.robot).finish_non_exhaustive()
    }
}

impl Feed {
    /// Observes a robot, and forwards its data to the sinks.
    ///
    /// # Errors
    ///
    /// An address is invalid or requires keys, or a thread cannot be started.
    pub fn start(
        robot: &BridgedRobot,
        session: u64,
        sinks: Arc<[Arc<dyn Sink>]>,
    ) -> Result<Self, BridgeError> {
        let numbered = Arc::new(Numbered::new(robot.name(), session, sinks));
        let (stream, client) = (robot.stream()?, robot.client()?);
        let mut threads = ThreadGroup::default();
        let (to, waiting) = sync_channel(MOST_WAITING);
        let (name, read) = (robot.name().to_owned(), Backlog(to.clone()));
        threads.spawn("bridge stream", move |shutdown| follow(stream, &name, &read, shutdown))?;
        let (name, polled) = (robot.name().to_owned(), Backlog(to));
        threads.spawn("bridge poll", move |shutdown| poll(client, &name, &polled, shutdown))?;
        let to = Arc::clone(&numbered);
        // It ends when the other threads have ended, and all is forwarded.
        threads.spawn("bridge sinks", move |_| {
            for (at, content) in waiting {
                to.send(at, content);
            }
        })?;
        Ok(Self { numbered, _threads: threads })
    }

    /// Forwards the bridge's own status to the sinks, as a message of this robot.
    pub(crate) fn send(&self, status: BridgeStatus) {
        self.numbered.send(Timestamp::now(), Content::Bridge(status));
    }
}

/// Numbers the messages of a robot.
struct Numbered {
    robot: String,
    session: u64,
    /// Number of the next message of each kind, locked while a message is forwarded to the sinks,
    /// so that messages arrive in the order of their numbers.
    next: [Mutex<u64>; Kind::ALL.len()],
    sinks: Arc<[Arc<dyn Sink>]>,
}

impl Numbered {
    fn new(robot: &str, session: u64, sinks: Arc<[Arc<dyn Sink>]>) -> Self {
        Self { robot: robot.to_owned(), session, next: Default::default(), sinks }
    }

    /// Forwards content that was received at this time to all sinks.
    fn send(&self, at: Timestamp, content: Content) {
        let mut next =
            self.next[content.kind().index()].lock().unwrap_or_else(PoisonError::into_inner);
        let seq = *next;
        *next += 1;
        let message = Message {
            version: VERSION,
            robot: self.robot.clone(),
            session: self.session,
            seq,
            at,
            content,
        };
        for sink in self.sinks.iter() {
            sink.take(&message);
        }
    }
}

/// Content that waits to be forwarded, in the order in which it was received.
struct Backlog(SyncSender<(Timestamp, Content)>);

impl Backlog {
    fn push(&self, content: Content) {
        // The thread that forwards ends after all others.
        drop(self.0.send((Timestamp::now(), content)));
    }
}

/// Reads the stream of the robot of this name.
fn follow(mut stream: Stream, robot: &str, read: &Backlog, shutdown: &AtomicBool) {
    // Torques precede the positions of the same time.
    let mut torques = None;
    let mut refused = Trouble::default();
    while !shutdown.load(Ordering::Relaxed) {
        match stream.next(POLL) {
            Ok(Some(Published::Torques { t_s, measured_nm, external_nm })) => {
                torques = Some((t_s, measured_nm, external_nm));
            }
            Ok(Some(Published::Joints { t_s, joints_rad })) => {
                let torques = torques.take().filter(|(at_s, ..)| *at_s == t_s);
                read.push(Content::Joints(CycleSample {
                    t_s,
                    joints_rad,
                    measured_nm: torques.map(|(_, measured_nm, _)| measured_nm),
                    external_nm: torques.map(|(.., external_nm)| external_nm),
                }));
            }
            Ok(Some(Published::State { t_s, state })) => read.push(Content::State { t_s, state }),
            Ok(Some(Published::Run(event))) => read.push(Content::Run((*event).into())),
            Ok(_) => {}
            Err(error) => {
                refused.warn(format_args!("{robot}: {error}"));
                pause(REFUSED_PAUSE, shutdown);
            }
        }
    }
}

/// Polls data that the stream does not contain.
fn poll(mut client: Client, robot: &str, polled: &Backlog, shutdown: &AtomicBool) {
    let mut conditions = RepeatedValue::default();
    let mut io: RepeatedValue<Vec<Signal>> = RepeatedValue::default();
    let mut trouble = Trouble::default();
    let mut is_known = false;
    while !shutdown.load(Ordering::Relaxed) {
        let status = match client.state() {
            Ok(status) => {
                trouble.clear();
                Some(status)
            }
            Err(error) => {
                trouble.warn(format_args!("{robot}: {error}"));
                None
            }
        };
        let is_idle = status.as_ref().is_some_and(|status| {
            status.state == DriveState::Idle && status.robot_program == Presence::Connected
        });
        // The stream contains changes only.
        match &status {
            Some(DriveStatus { state, t_s: Some(t_s), .. }) if !is_known => {
                is_known = true;
                polled.push(Content::State { t_s: *t_s, state: *state });
            }
            None => is_known = false,
            _ => {}
        }
        if let Some(changed) = conditions.changed(conditions_of(status)) {
            polled.push(Content::Conditions(Box::new(changed)));
        }
        // A robot program does not report these values while the robot moves.
        if is_idle {
            if let Ok(sensors) = client.read_sensors() {
                polled.push(Content::Sensors(sensors));
            }
            if let Ok(signals) = client.list_io()
                && let Some(io) = io.changed(signals)
            {
                polled.push(Content::Io { io });
            }
        }
        pause(ASK_EVERY, shutdown);
    }
}

fn conditions_of(status: Option<DriveStatus>) -> RobotConditions {
    match status {
        None => RobotConditions {
            drive: Presence::Silent,
            state: None,
            fri: None,
            robot_program: Presence::Silent,
            simulated: false,
            hello: None,
            conditions: None,
        },
        Some(status) => RobotConditions {
            drive: Presence::Connected,
            state: Some(status.state),
            fri: Some(status.fri),
            robot_program: status.robot_program,
            simulated: status.simulated,
            hello: status.hello,
            conditions: status.conditions,
        },
    }
}

/// A value that is forwarded when it has changed, or after an interval.
struct RepeatedValue<T> {
    last: Option<(T, Instant)>,
}

impl<T> Default for RepeatedValue<T> {
    fn default() -> Self {
        Self { last: None }
    }
}

impl<T: Clone + PartialEq> RepeatedValue<T> {
    fn changed(&mut self, value: T) -> Option<T> {
        let is_known = self
            .last
            .as_ref()
            .is_some_and(|(last, sent_at)| *last == value && sent_at.elapsed() < REPEAT_AFTER);
        if is_known {
            return None;
        }
        self.last = Some((value.clone(), Instant::now()));
        Some(value)
    }
}
