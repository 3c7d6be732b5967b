//! Replays messages as a drive, with its stream and its state. Clients, such as the twin, follow
//! the replay as a read-only robot.

use std::{
    ops::ControlFlow::{self, Break, Continue},
    sync::{Arc, Mutex, PoisonError, Weak},
    thread,
    time::{Duration, Instant},
};

use bytes::Bytes;
use iiwa_link::{
    LinkError, Published, Server,
    message::{DriveState, DriveStatus, FriStatus, Refusal, Reply, ReplyBody, Request, to_json},
    socket::SHORT_MESSAGE_BYTES,
    transport::{Event, Listener, ListenerConfig, PeerId, ReceivedMessage, SocketKind},
};

use crate::message::{Content, CycleSample, Message};

/// Maximum number of messages that wait for a subscriber, as in a drive.
const BACKLOG: usize = 2000;

/// Maximum duration of a sleep, so that a replay ends soon.
const NAP: Duration = Duration::from_millis(50);

/// A simulated drive that replays messages.
pub struct ReplayDrive {
    requests: Arc<Listener>,
    stream: Listener,
    status: Arc<Mutex<DriveStatus>>,
}

impl std::fmt::Debug for ReplayDrive {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ReplayDrive").finish_non_exhaustive()
    }
}

impl ReplayDrive {
    /// Listens at the addresses for requests and subscribers, such as `tcp://127.0.0.1:5560`.
    ///
    /// # Errors
    ///
    /// An address is invalid, requires keys or cannot be bound.
    pub fn start(clients: &Server, requests: &str, stream: &str) -> Result<Self, LinkError> {
        let fri = FriStatus::new(FriStatus::SILENT, "poor");
        let status = Arc::new(Mutex::new(DriveStatus::new(DriveState::Idle, fri)));
        let shared_status = Arc::clone(&status);
        // Replies are sent over the socket that received the request.
        let socket: Arc<Mutex<Weak<Listener>>> = Arc::default();
        let back = Arc::clone(&socket);
        let config =
            ListenerConfig::new("replay requests", SocketKind::Router, SHORT_MESSAGE_BYTES);
        let listener = clients.listen(requests, config, move |event| {
            let Event::Message(peer, received) = event else { return };
            let status = shared_status.lock().unwrap_or_else(PoisonError::into_inner).clone();
            let socket = back.lock().unwrap_or_else(PoisonError::into_inner).upgrade();
            if let Some(socket) = socket {
                answer(&socket, peer, received, status);
            }
        })?;
        let listener = Arc::new(listener);
        *socket.lock().unwrap_or_else(PoisonError::into_inner) = Arc::downgrade(&listener);
        let config = ListenerConfig::new("replay stream", SocketKind::Pub, SHORT_MESSAGE_BYTES)
            .with_backlog(BACKLOG);
        let stream = clients.listen(stream, config, drop)?;
        Ok(Self { requests: listener, stream, status })
    }

    /// Returns the bound address for requests.
    #[must_use]
    pub fn requests(&self) -> &str {
        self.requests.address()
    }

    /// Returns the bound address of the stream.
    #[must_use]
    pub fn stream(&self) -> &str {
        self.stream.address()
    }

    fn show(&self, content: Content) {
        let mut status = self.status.lock().unwrap_or_else(PoisonError::into_inner);
        match content {
            Content::Joints(CycleSample { t_s, joints_rad, measured_nm, external_nm }) => {
                status.joints_rad = Some(joints_rad);
                status.t_s = Some(t_s);
                if status.fri.session == FriStatus::SILENT {
                    status.fri = FriStatus::new("monitoring_ready", "excellent");
                }
                if let (Some(measured_nm), Some(external_nm)) = (measured_nm, external_nm) {
                    self.publish(&Published::Torques { t_s, measured_nm, external_nm });
                }
                self.publish(&Published::Joints { t_s, joints_rad });
            }
            Content::State { t_s, state } => {
                status.state = state;
                self.publish(&Published::State { t_s, state });
            }
            Content::Conditions(conditions) => {
                status.robot_program = conditions.robot_program;
                status.simulated = conditions.simulated;
                status.hello = conditions.hello;
                status.conditions = conditions.conditions;
                if let Some(fri) = conditions.fri {
                    status.fri = fri;
                }
            }
            _ => {}
        }
    }

    fn publish(&self, message: &Published) {
        let topic = Bytes::from_static(message.topic().as_bytes());
        self.stream.publish(&vec![topic, to_json(message).into()]);
    }
}

/// Replays messages of a robot with their original timing.
#[derive(Debug)]
pub struct Player<'a> {
    drive: &'a ReplayDrive,
    speed: f64,
    /// Start time of the replay, and the time of its first message in µs.
    began: Option<(Instant, u64)>,
}

impl<'a> Player<'a> {
    /// Creates a player with `speed` times the original rate.
    #[must_use]
    pub fn new(drive: &'a ReplayDrive, speed: f64) -> Self {
        Self { drive, speed, began: None }
    }

    /// Plays a message when it is due, unless `to_end` returns true before.
    pub fn play(&mut self, message: Message, to_end: impl Fn() -> bool) -> ControlFlow<()> {
        let micros = message.at.micros();
        let (since, first) = *self.began.get_or_insert((Instant::now(), micros));
        let due_s = micros.saturating_sub(first) as f64 / 1e6 / self.speed;
        let due = Duration::try_from_secs_f64(due_s).unwrap_or_default();
        while since.elapsed() < due {
            if to_end() {
                return Break(());
            }
            thread::sleep(NAP.min(due.saturating_sub(since.elapsed())));
        }
        self.drive.show(message.content);
        Continue(())
    }
}

/// Answers a request with the state, or with a refusal.
fn answer(socket: &Listener, peer: PeerId, received: ReceivedMessage, status: DriveStatus) {
    let mut frames = received.frames;
    let Some(body) = frames.pop() else { return };
    let (id, request) = Request::from_json(&body);
    let answered = match request {
        Ok(Request::State) => Ok(ReplyBody::Status(Box::new(status))),
        Ok(_) => Err(Refusal::robot(
            "this is a recording that is played back: nothing can be moved or set",
        )),
        Err(refusal) => Err(refusal),
    };
    let reply =
        Reply { id: id.as_ref(), error: answered.as_ref().err(), body: answered.as_ref().ok() };
    frames.push(reply.to_json().into());
    socket.send(peer, frames, None);
}
