//! iiwaDrive: the layer between the robot and any number of clients (Larsen 2019, section 3.1.2).
//!
//! | thread | what it does |
//! |---|---|
//! | requests | takes requests of clients and sends replies |
//! | instructions | serves requests, and tells the robot program what to do |
//! | checks | reads and checks what is to be run |
//! | answers | writes what runs have measured |
//! | state | hears the robot program's state changes, and acknowledges them |
//! | FRI | answers the controller every cycle, feeds trajectories |
//! | stream | publishes what FRI measures, and the state |
//!
//! One client can ask for the state, or stop a motion, while another waits for its end; and whatever
//! clients send, they hold up neither a stop nor FRI.

mod answerer;
mod answers;
mod checks;
mod clock;
mod desk;
mod fri;
mod governor;
mod instructions;
mod plausibility;
mod publish;
mod punctuality;
mod run;
mod setpoints;
#[cfg(test)]
mod wire_tests;

use std::{
    net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket},
    sync::{
        Arc, Barrier,
        atomic::{AtomicBool, Ordering},
        mpsc::{self, Receiver, RecvTimeoutError, Sender},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use bytes::Bytes;
use iiwa_kin::Robot;
use iiwa_link::{
    LinkError,
    message::{MAX_MESSAGE_BYTES, from_json},
    socket::{Dial, Remote, SHORT_MESSAGE_BYTES, Server, random},
    transport,
    transport::{Dialer, Frames, Kind, Listener, ListenerConfig, PeerId, Received},
};
pub use punctuality::Punctuality;

use crate::{
    drive::{
        answers::Answer,
        checks::{Done, Job},
        desk::{Asking, Desk, Output},
        fri::{Event, FriThread, Order},
        publish::BACKLOG,
        punctuality::Account,
    },
    robot_program::{Acknowledgement, RECEIVED, StateChange},
};

/// Where a drive listens, and to what it connects.
#[derive(Clone, Debug)]
pub struct DriveConfig {
    /// The robot: its limits are those that trajectories are held against.
    pub robot: Robot,
    /// Where clients send requests to.
    pub instructions: String,
    /// Where clients subscribe.
    pub stream: String,
    /// Where FRI's messages come in, over UDP.
    pub fri: SocketAddr,
    /// The controller's address: FRI's messages from elsewhere are not listened to.
    pub fri_controller: IpAddr,
    /// Where the robot program takes instructions.
    pub cabinet_instructions: String,
    /// Where the robot program's state changes come from.
    pub cabinet_state: String,
}

impl Default for DriveConfig {
    fn default() -> Self {
        Self {
            robot: Robot::default(),
            instructions: format!("tcp://127.0.0.1:{}", iiwa_link::INSTRUCTIONS_PORT),
            stream: format!("tcp://127.0.0.1:{}", iiwa_link::STREAM_PORT),
            fri: SocketAddr::from(([127, 0, 0, 1], crate::FRI_PORT)),
            fri_controller: IpAddr::V4(Ipv4Addr::LOCALHOST),
            cabinet_instructions: format!("tcp://127.0.0.1:{}", crate::CABINET_INSTRUCTIONS_PORT),
            cabinet_state: format!("tcp://127.0.0.1:{}", crate::CABINET_STATE_PORT),
        }
    }
}

/// A running drive. It ends when it is dropped; a running motion goes on then, a trajectory is stopped on
/// its path. What has not begun never begins.
#[derive(Debug)]
pub struct Drive {
    over: Arc<AtomicBool>,
    instructions: String,
    stream: String,
    fri: SocketAddr,
    account: Arc<Account>,
    threads: Vec<JoinHandle<()>>,
}

/// Most messages that wait for a subscriber: at 1 ms, two seconds, which take about 1 MB. Beyond that the
/// subscriber loses what is published, and nobody else does.
const STREAM_BACKLOG: usize = 2000;

impl Drive {
    /// Starts a drive: `clients` are let in, and `cabinet` is connected to.
    ///
    /// # Errors
    ///
    /// If an address cannot be bound or is not safe.
    pub fn start(
        config: DriveConfig,
        clients: &Server,
        cabinet: &Remote,
    ) -> Result<Self, LinkError> {
        if !config.fri.ip().is_loopback() && config.fri_controller.is_loopback() {
            return Err(LinkError::Config {
                what: format!(
                    "FRI at {} would listen to nobody: name the controller's address (--cabinet)",
                    config.fri
                ),
            });
        }
        let (inputs, inputs_in) = mpsc::channel();
        let requests = listen(clients, &config.instructions, inputs.clone())?;
        let socket = ListenerConfig {
            name: "drive stream",
            kind: Kind::Pub,
            // Subscribers send a topic.
            most_bytes: SHORT_MESSAGE_BYTES,
            backlog: STREAM_BACKLOG,
        };
        let stream = clients.listen(&config.stream, socket, drop)?;
        let state = hear_state(cabinet, &config.cabinet_state, inputs.clone())?;
        let program = instruct(cabinet, &config.cabinet_instructions, inputs.clone())?;
        let udp_error = |source| LinkError::Udp { address: config.fri.to_string(), source };
        let udp = UdpSocket::bind(config.fri).map_err(udp_error)?;
        udp.set_read_timeout(Some(fri::AWAKE)).map_err(udp_error)?;

        let (orders, orders_in) = mpsc::channel();
        let (events_out, events) = mpsc::channel();
        let (published, to_publish) = mpsc::sync_channel(BACKLOG);
        let mut drive = Self {
            over: Arc::new(AtomicBool::new(false)),
            instructions: requests.at().to_owned(),
            stream: stream.at().to_owned(),
            fri: udp.local_addr().map_err(udp_error)?,
            account: Arc::default(),
            threads: Vec::new(),
        };
        let ready = Arc::new(Barrier::new(2));
        let fri = FriThread {
            udp,
            cabinet: config.fri_controller,
            limits: *config.robot.limits(),
            stream: published,
            orders: orders_in,
            events: events_out,
            account: Arc::clone(&drive.account),
            ready: Arc::clone(&ready),
        };
        drive.spawn("drive FRI", move |over| fri.run(over))?;
        ready.wait();
        // It ends with the FRI thread.
        drive.spawn("drive publish", move |_| publish::publish(&to_publish, &stream))?;
        let (jobs, jobs_in) = mpsc::channel();
        let robot = config.robot;
        drive.spawn("drive checks", move |_| {
            checks::check(&robot, &jobs_in, |done| drop(inputs.send(Input::Checked(done))));
        })?;
        let requests = Arc::new(requests);
        let (answers, answers_in) = mpsc::channel();
        let replies = Arc::clone(&requests);
        drive.spawn("drive answers", move |_| {
            answers::answer(&answers_in, |route: Route, body, permit| {
                replies.send(route.peer, route.with(body), Some(Box::new(permit)));
            });
        })?;
        let handler = InstructionThread {
            desk: Desk::new(random()),
            requests,
            program,
            _state: state,
            inputs: inputs_in,
            events,
            orders,
            jobs,
            answers,
        };
        drive.spawn("drive instructions", move |over| handler.run(over))?;
        Ok(drive)
    }

    fn spawn(
        &mut self,
        name: &str,
        work: impl FnOnce(&AtomicBool) + Send + 'static,
    ) -> Result<(), LinkError> {
        let over = Arc::clone(&self.over);
        let thread = thread::Builder::new().name(name.to_owned()).spawn(move || work(&over));
        self.threads.push(thread.map_err(|source| LinkError::Thread { source })?);
        Ok(())
    }

    /// Where clients send requests to.
    #[must_use]
    pub fn instructions(&self) -> &str {
        &self.instructions
    }

    /// Where clients subscribe.
    #[must_use]
    pub fn stream(&self) -> &str {
        &self.stream
    }

    /// Where FRI's messages come in.
    #[must_use]
    pub fn fri(&self) -> SocketAddr {
        self.fri
    }

    /// Whether the controller's messages were answered in time so far.
    #[must_use]
    pub fn punctuality(&self) -> Punctuality {
        self.account.read()
    }
}

impl Drop for Drive {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// Where clients send requests to.
fn listen(clients: &Server, at: &str, inputs: Sender<Input>) -> Result<Listener, LinkError> {
    let socket = ListenerConfig {
        name: "drive requests",
        kind: Kind::Router,
        most_bytes: MAX_MESSAGE_BYTES,
        backlog: 0,
    };
    clients.listen(at, socket, move |event| {
        // The other end goes away last.
        let _ = inputs.send(Input::of(event));
    })
}

/// The connection over which the robot program says its state.
fn hear_state(cabinet: &Remote, at: &str, inputs: Sender<Input>) -> Result<Dialer, LinkError> {
    cabinet.dial("drive state", Dial::Rep, at, move |frames| Some(acknowledge(frames, &inputs)))
}

/// The connection over which the robot program is instructed. It speaks as REQ does, but it does not get
/// stuck, and what is not delivered goes away with it: a motion must not begin when nobody counts on it.
fn instruct(cabinet: &Remote, at: &str, inputs: Sender<Input>) -> Result<Dialer, LinkError> {
    cabinet.dial("drive program", Dial::Dealer, at, move |frames| {
        if let Some(answer) = frames.last().and_then(|body| from_json(body)) {
            let _ = inputs.send(Input::Acknowledged(answer));
        }
        None
    })
}

/// The robot program's state changes come as requests, and are acknowledged.
fn acknowledge(mut frames: Frames, inputs: &Sender<Input>) -> Frames {
    let body = frames.pop().unwrap_or_default();
    if let Some(change) = from_json(&body) {
        // The other end goes away last.
        let _ = inputs.send(Input::Change(change));
    } else {
        tracing::warn!("a state change could not be read");
    }
    frames.push(Bytes::from_static(RECEIVED.as_bytes()));
    frames
}

/// The way back to a client.
struct Route {
    peer: PeerId,
    /// The frames before a request's body.
    envelope: Frames,
}

impl Route {
    /// A message that goes this way.
    fn with(self, body: impl Into<Bytes>) -> Frames {
        let mut frames = self.envelope;
        frames.push(body.into());
        frames
    }
}

/// What the instruction handler hears of, but for FRI.
enum Input {
    Asked(Route, Asking),
    Gone(PeerId),
    Change(StateChange),
    Acknowledged(Acknowledgement),
    Checked(Done<Route>),
}

impl Input {
    fn of(event: transport::Event) -> Self {
        let (peer, Received { mut frames, permit, began }) = match event {
            transport::Event::Gone(peer) => return Self::Gone(peer),
            transport::Event::Message(peer, received) => (peer, received),
        };
        // Envelope, empty frame, body: as REQ sends it. DEALER may leave out the empty frame.
        let envelope = frames.iter().position(Bytes::is_empty).map_or(0, |empty| empty + 1);
        let bodies = frames.split_off(envelope.min(frames.len()));
        let body = match <[Bytes; 1]>::try_from(bodies) {
            Ok([body]) => body,
            // No request, but an answer is due all the same.
            Err(_) => Bytes::new(),
        };
        Self::Asked(Route { peer, envelope: frames }, Asking { body, permit, began })
    }
}

struct InstructionThread {
    desk: Desk<Route>,
    requests: Arc<Listener>,
    program: Dialer,
    /// Its word comes in by the inputs.
    _state: Dialer,
    inputs: Receiver<Input>,
    events: Receiver<Event>,
    orders: Sender<Order>,
    jobs: Sender<Job<Route>>,
    answers: Sender<Answer<Route>>,
}

/// How long the thread sleeps at most: samples wait for so long.
const NAP: Duration = Duration::from_millis(5);

impl InstructionThread {
    fn run(mut self, over: &AtomicBool) {
        while !over.load(Ordering::Relaxed) {
            let first = match self.inputs.recv_timeout(NAP) {
                Ok(input) => Some(input),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return,
            };
            let now = Instant::now();
            // First what has happened, then what is asked.
            for event in self.events.try_iter() {
                self.desk.heard(event, now);
            }
            for input in first.into_iter().chain(self.inputs.try_iter()) {
                match input {
                    Input::Asked(route, asking) => self.desk.request(route, asking, now),
                    Input::Gone(peer) => self.desk.gone(|route| route.peer == peer, now),
                    Input::Change(change) => self.desk.changed(change, now),
                    Input::Acknowledged(answer) => self.desk.acknowledged(answer, now),
                    Input::Checked(Done::Checked(checked)) => self.desk.checked(checked, now),
                    Input::Checked(Done::Refused(route, reply)) => self.reply(route, reply),
                }
            }
            self.desk.tick(now);
            self.carry_out();
        }
    }

    fn reply(&self, route: Route, reply: String) {
        self.requests.send(route.peer, route.with(reply), None);
    }

    fn carry_out(&mut self) {
        for output in self.desk.take_outputs() {
            match output {
                Output::Reply(route, reply) => self.reply(route, reply),
                Output::Instruct(instruction) => {
                    self.program.send(vec![Bytes::new(), instruction.into()]);
                }
                Output::Reconnect => self.program.reconnect(),
                // These threads end later.
                Output::Answer(answer) => drop(self.answers.send(answer)),
                Output::Check(job) => drop(self.jobs.send(job)),
                Output::Order(order) => drop(self.orders.send(order)),
            }
        }
    }
}
