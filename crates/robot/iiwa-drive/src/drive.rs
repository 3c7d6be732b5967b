//! iiwaDrive: connects the robot to any number of clients (Larsen 2019, section 3.1.2).
//!
//! | thread | task |
//! |---|---|
//! | requests | exchanges messages with clients: receives requests, sends all replies |
//! | dispatcher | serves requests and instructs the robot program |
//! | checks | parses clients' motions and trajectories, and checks them before they run |
//! | replies | serialises long replies, those with the measurements of a run, for `requests` |
//! | state | receives and acknowledges state changes of the robot program |
//! | FRI | answers the controller every cycle, sends trajectory set-points |
//! | publish | publishes measurements and states on the stream |
//!
//! A client can query the state or stop a motion while another client waits for the end of that
//! motion. Requests, regardless of their number and length, delay neither stops nor FRI.

mod answer_latency;
mod checks;
mod clock;
mod commanded_times;
mod config;
mod dispatcher;
mod dispatcher_thread;
mod events;
mod fri;
mod governor;
mod instruction_queue;
mod link_check;
mod plausibility;
mod protocol;
mod publish;
mod responder;
mod run;
mod run_replies;
mod setpoints;
#[cfg(test)]
mod wire_tests;

use std::{
    net::{SocketAddr, UdpSocket},
    sync::{
        Arc, Barrier,
        mpsc::{self, Sender},
    },
};

pub use answer_latency::AnswerLatency;
use bytes::Bytes;
pub use config::DriveConfig;
use iiwa_link::{
    LinkError,
    message::{MAX_MESSAGE_BYTES, Request, RobotIdentity, from_json},
    socket::{Dial, Remote, SHORT_MESSAGE_BYTES, Server, random_id},
    threads::ThreadGroup,
    transport::{Dialer, Listener, ListenerConfig, SocketKind},
};
pub use link_check::{CheckStep, LinkCheck, StepResult};

use crate::drive::{
    answer_latency::LatencyRecorder,
    dispatcher::Dispatcher,
    dispatcher_thread::{DispatcherInput, DispatcherThread, ReplyRoute},
    fri::FriThread,
    protocol::acknowledge,
    publish::BACKLOG,
};

/// A running drive.
///
/// Dropping the drive shuts it down: a trajectory, whose set-points are sent over FRI, brakes to a
/// stop without leaving its path; motions that the controller executes continue; a run that has not
/// begun is withdrawn.
///
/// ```
/// use iiwa_drive::{Drive, DriveConfig};
/// use iiwa_link::{Client, Remote, Server, message::DriveState};
///
/// // On free ports, without a cabinet.
/// let mut config = DriveConfig::default();
/// config.instructions = "tcp://127.0.0.1:*".into();
/// config.stream = "tcp://127.0.0.1:*".into();
/// config.fri = "127.0.0.1:0".parse()?;
/// let drive = Drive::start(config, &Server::open(), &Remote::open())?;
/// let mut client = Client::new(&Remote::open(), drive.instructions())?;
/// assert_eq!(client.state()?.state, DriveState::Idle);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Drive {
    instructions: String,
    stream: String,
    fri: SocketAddr,
    latency: Arc<LatencyRecorder>,
    _threads: ThreadGroup,
}

/// Maximum backlog per subscriber, in messages: two seconds at 1 ms, about 1 MB. Further messages
/// to this subscriber are dropped, without effect on other subscribers.
const STREAM_BACKLOG: usize = 2000;

impl Drive {
    /// Starts a drive at the addresses of the configuration. `clients` says who may connect:
    /// anyone, or the owners of permitted keys. `cabinet` contains the keys for the connection to
    /// the cabinet, if any.
    ///
    /// # Errors
    ///
    /// An address is invalid, cannot be bound, or is open to other machines although no keys are
    /// configured; or a thread cannot be started.
    pub fn start(
        config: DriveConfig,
        clients: &Server,
        cabinet: &Remote,
    ) -> Result<Self, LinkError> {
        // With this configuration, FRI would listen on the network but accept messages only from
        // this machine.
        if !config.fri.ip().is_loopback() && config.fri_controller.is_loopback() {
            return Err(LinkError::ControllerAddress { fri: config.fri });
        }
        let (inputs, inputs_in) = mpsc::channel();
        let requests = listen(clients, &config.instructions, inputs.clone())?;
        // Subscribers send topics only.
        let socket = ListenerConfig::new("drive stream", SocketKind::Pub, SHORT_MESSAGE_BYTES)
            .with_backlog(STREAM_BACKLOG);
        let stream = clients.listen(&config.stream, socket, drop)?;
        let state = receive_states(cabinet, &config.cabinet_state, inputs.clone())?;
        let program = instruct(cabinet, &config.cabinet_instructions, inputs.clone())?;
        let udp_error = |source| LinkError::Udp { address: config.fri.to_string(), source };
        let udp = UdpSocket::bind(config.fri).map_err(udp_error)?;
        udp.set_read_timeout(Some(fri::POLL_INTERVAL)).map_err(udp_error)?;

        let (commands, commands_in) = mpsc::channel();
        let (events_out, events) = mpsc::channel();
        let (published, to_publish) = mpsc::sync_channel(BACKLOG);
        let instructions = requests.address().to_owned();
        let stream_at = stream.address().to_owned();
        let fri_at = udp.local_addr().map_err(udp_error)?;
        let latency: Arc<LatencyRecorder> = Arc::default();
        let mut threads = ThreadGroup::default();
        let ready = Arc::new(Barrier::new(2));
        let fri = FriThread {
            udp,
            cabinet: config.fri_controller,
            limits: *config.robot.limits(),
            stream: published.clone(),
            commands: commands_in,
            events: events_out,
            latency: Arc::clone(&latency),
            ready: Arc::clone(&ready),
        };
        threads.spawn("drive FRI", move |shutdown| fri.run(shutdown))?;
        // Wait until the FRI thread has recorded its priority, which `answer_latency` reports.
        ready.wait();
        // The publish thread ends when the FRI and dispatcher threads have ended, because these
        // hold the senders.
        threads.spawn("drive publish", move |_| publish::publish(&to_publish, &stream))?;
        let (jobs, jobs_in) = mpsc::channel();
        let robot = config.robot;
        let identity = RobotIdentity::from(&robot);
        threads.spawn("drive checks", move |_| {
            checks::check(&robot, &jobs_in, |done| {
                drop(inputs.send(DispatcherInput::Checked(done)));
            });
        })?;
        let requests = Arc::new(requests);
        let (replies, replies_in) = mpsc::channel();
        let socket = Arc::clone(&requests);
        threads.spawn("drive replies", move |_| {
            run_replies::write_replies(&replies_in, |route: ReplyRoute, body, permit| {
                socket.send(route.peer, route.with(body), Some(Box::new(permit)));
            });
        })?;
        let dispatcher = DispatcherThread {
            dispatcher: Dispatcher::new(random_id(), identity),
            requests,
            program,
            _state: state,
            inputs: inputs_in,
            events,
            commands,
            stream: published,
            jobs,
            replies,
        };
        threads.spawn("drive dispatcher", move |shutdown| dispatcher.run(shutdown))?;
        Ok(Self { instructions, stream: stream_at, fri: fri_at, latency, _threads: threads })
    }

    /// The bound address for client requests, such as `tcp://127.0.0.1:5560`.
    #[must_use]
    pub fn instructions(&self) -> &str {
        &self.instructions
    }

    /// The bound address of the stream.
    #[must_use]
    pub fn stream(&self) -> &str {
        &self.stream
    }

    /// The bound UDP address for FRI.
    #[must_use]
    pub fn fri(&self) -> SocketAddr {
        self.fri
    }

    /// Latency statistics of the answers to the controller so far.
    #[must_use]
    pub fn answer_latency(&self) -> AnswerLatency {
        self.latency.read()
    }
}

/// Opens the socket for client requests.
fn listen(
    clients: &Server,
    address: &str,
    inputs: Sender<DispatcherInput>,
) -> Result<Listener, LinkError> {
    let socket = ListenerConfig::new("drive requests", SocketKind::Router, MAX_MESSAGE_BYTES)
        .with_urgent(is_stop);
    clients.listen(address, socket, move |event| {
        // The receiver outlives the socket.
        let _ = inputs.send(DispatcherInput::of(event));
    })
}

/// Returns `true` for stop requests. If the listener has too many connections, it closes the oldest
/// ones first; connections with a pending stop request are closed only after all others.
fn is_stop(frames: &[Bytes]) -> bool {
    let body = frames.last().filter(|body| body.len() <= SHORT_MESSAGE_BYTES);
    body.is_some_and(
        |body| matches!(Request::head(body), (_, Ok(head)) if head.name() == Some("stop")),
    )
}

/// Opens the connection that receives states of the robot program.
fn receive_states(
    cabinet: &Remote,
    address: &str,
    inputs: Sender<DispatcherInput>,
) -> Result<Dialer, LinkError> {
    cabinet.dial("drive state", Dial::Rep, address, move |frames| {
        let (state, acknowledgement) = acknowledge(frames);
        if let Some(state) = state {
            // The receiver outlives the socket.
            let _ = inputs.send(DispatcherInput::StateChange(state));
        } else {
            tracing::warn!("a malformed state change was ignored");
        }
        Some(acknowledgement)
    })
}

/// Opens the connection for instructions to the robot program. Like a `ZeroMQ` REQ socket, it sends
/// messages with an empty delimiter frame, but it does not block after a lost reply. If the
/// connection is lost, undelivered instructions are dropped, because a motion must not begin late.
fn instruct(
    cabinet: &Remote,
    address: &str,
    inputs: Sender<DispatcherInput>,
) -> Result<Dialer, LinkError> {
    cabinet.dial("drive program", Dial::Dealer, address, move |frames| {
        if let Some(acknowledgement) = frames.last().and_then(|body| from_json(body)) {
            let _ = inputs.send(DispatcherInput::Acknowledged(acknowledgement));
        }
        None
    })
}
