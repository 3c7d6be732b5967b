//! iiwaDrive: the layer between the robot and any number of clients (Larsen 2019, section 3.1.2).
//!
//! | thread | what it does |
//! |---|---|
//! | instructions | takes requests of clients, and tells the robot program what to do |
//! | state | hears the robot program's state changes, and acknowledges them |
//! | FRI | answers the controller every cycle, publishes what it measures, feeds trajectories |
//!
//! Clients speak to it through a ROUTER socket, so that one can ask for the state, or stop a motion,
//! while another waits for its end.

mod clock;
mod desk;
mod fri;
mod punctuality;
mod run;
mod setpoints;

use std::{
    net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket},
    sync::{
        Arc, Barrier,
        atomic::{AtomicBool, Ordering},
        mpsc::{self, Receiver, Sender},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use iiwa_kin::Robot;

use crate::{
    drive::{
        desk::{Desk, Output},
        fri::{Event, FriThread, Order},
        punctuality::Account,
    },
    error::LinkError,
    message::{MAX_MESSAGE_BYTES, from_json},
    robot_program::{RECEIVED, StateChange},
    security::GuardedSocket,
    socket::{Remote, SHORT_MESSAGE_BYTES, Server, limit_messages, random},
};

pub use punctuality::Punctuality;

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
            instructions: format!("tcp://127.0.0.1:{}", crate::INSTRUCTIONS_PORT),
            stream: format!("tcp://127.0.0.1:{}", crate::STREAM_PORT),
            fri: SocketAddr::from(([127, 0, 0, 1], crate::FRI_PORT)),
            fri_controller: IpAddr::V4(Ipv4Addr::LOCALHOST),
            cabinet_instructions: format!("tcp://127.0.0.1:{}", crate::CABINET_INSTRUCTIONS_PORT),
            cabinet_state: format!("tcp://127.0.0.1:{}", crate::CABINET_STATE_PORT),
        }
    }
}

/// A running drive. It ends when it is dropped; a running motion goes on then, a trajectory breaks off.
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
/// subscriber loses what is published, and nobody else does. One that takes nothing for longer than a
/// heartbeat's timeout is disconnected, and what waits for it goes.
const STREAM_BACKLOG: i32 = 2000;

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
        let (requests, instructions) =
            clients.bind(zmq::ROUTER, &config.instructions, |socket| {
                // Requests of a client wait for each other, and long ones take memory meanwhile.
                socket.set_rcvhwm(10)?;
                limit_messages(socket, MAX_MESSAGE_BYTES)
            })?;
        let (stream, stream_at) = clients.bind(zmq::PUB, &config.stream, |socket| {
            // Subscribers send a topic.
            limit_messages(socket, SHORT_MESSAGE_BYTES)?;
            socket.set_sndhwm(STREAM_BACKLOG)
        })?;
        let state = cabinet.connect(zmq::REP, &config.cabinet_state, |_| Ok(()))?;
        let udp_error = |source| LinkError::Udp { address: config.fri.to_string(), source };
        let udp = UdpSocket::bind(config.fri).map_err(udp_error)?;
        udp.set_read_timeout(Some(fri::AWAKE)).map_err(udp_error)?;

        let (orders, orders_in) = mpsc::channel();
        let (events_out, events) = mpsc::channel();
        let (changes_out, changes) = mpsc::channel();
        let mut drive = Self {
            over: Arc::new(AtomicBool::new(false)),
            instructions,
            stream: stream_at,
            fri: udp.local_addr().map_err(udp_error)?,
            account: Arc::default(),
            threads: Vec::new(),
        };
        let ready = Arc::new(Barrier::new(2));
        let fri = FriThread {
            udp,
            cabinet: config.fri_controller,
            stream,
            orders: orders_in,
            events: events_out,
            account: Arc::clone(&drive.account),
            ready: Arc::clone(&ready),
        };
        drive.spawn("drive FRI", move |over| fri.run(over))?;
        ready.wait();
        drive.spawn("drive state", move |over| hear_state(over, &state, &changes_out))?;
        let handler = InstructionThread {
            desk: Desk::new(config.robot, random()),
            requests,
            program: cabinet.clone(),
            program_at: config.cabinet_instructions,
            changes,
            events,
            orders,
        };
        // The first connection is made here, where its failure is told.
        let program = handler.connect()?;
        drive.spawn("drive instructions", move |over| handler.run(over, program))?;
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

/// How often waiting threads look whether the drive is over, in ms.
const AWAKE_MS: i64 = 50;

/// The robot program's state changes come as requests, and are acknowledged.
fn hear_state(over: &AtomicBool, socket: &zmq::Socket, changes: &Sender<StateChange>) {
    while !over.load(Ordering::Relaxed) {
        if !matches!(socket.poll(zmq::POLLIN, AWAKE_MS), Ok(1..)) {
            continue;
        }
        let Ok(frames) = socket.recv_multipart(0) else { continue };
        if let [body] = frames.as_slice()
            && let Some(change) = from_json(body)
        {
            let _ = changes.send(change);
        } else {
            tracing::warn!("a state change could not be read");
        }
        if let Err(error) = socket.send(RECEIVED, 0) {
            tracing::warn!("cannot acknowledge a state change: {error}");
        }
    }
}

/// The frames before a request's body, which lead back to its client.
type Route = Vec<Vec<u8>>;

struct InstructionThread {
    desk: Desk<Route>,
    requests: GuardedSocket,
    program: Remote,
    program_at: String,
    changes: Receiver<StateChange>,
    events: Receiver<Event>,
    orders: Sender<Order>,
}

/// How long the thread sleeps at most, in ms: samples and state changes wait for so long.
const NAP_MS: i64 = 5;

impl InstructionThread {
    /// A new connection to the robot program. The socket speaks as REQ does, but it does not get stuck,
    /// and what is not delivered goes away with it: a motion must not begin when nobody counts on it.
    fn connect(&self) -> Result<zmq::Socket, LinkError> {
        self.program.connect(zmq::DEALER, &self.program_at, |_| Ok(()))
    }

    fn run(mut self, over: &AtomicBool, mut program: zmq::Socket) {
        while !over.load(Ordering::Relaxed) {
            let mut items =
                [self.requests.as_poll_item(zmq::POLLIN), program.as_poll_item(zmq::POLLIN)];
            if let Err(error) = zmq::poll(&mut items, NAP_MS) {
                tracing::warn!("cannot wait for requests: {error}");
                thread::sleep(Duration::from_millis(NAP_MS.unsigned_abs()));
            }
            let now = Instant::now();
            // First what has happened, then what is asked.
            for event in self.events.try_iter() {
                self.desk.heard(event, now);
            }
            for change in self.changes.try_iter() {
                self.desk.changed(change, now);
            }
            while let Ok(frames) = program.recv_multipart(zmq::DONTWAIT) {
                if let [.., body] = frames.as_slice()
                    && let Some(answer) = from_json(body)
                {
                    self.desk.acknowledged(answer, now);
                }
            }
            if let Ok(frames) = self.requests.recv_multipart(zmq::DONTWAIT) {
                self.take_request(frames, now);
            }
            self.desk.tick(now);
            self.carry_out(&mut program);
        }
    }

    /// Envelope, empty frame, body: as REQ sends it. DEALER may leave out the empty frame.
    fn take_request(&mut self, mut frames: Vec<Vec<u8>>, now: Instant) {
        let route = match frames.iter().skip(1).position(Vec::is_empty) {
            Some(empty) => empty + 2,
            None => 1,
        };
        let body = frames.split_off(route.min(frames.len()));
        match body.as_slice() {
            [body] => self.desk.request(frames, body, now),
            // No request, but an answer is due all the same.
            _ => self.desk.request(frames, b"", now),
        }
    }

    fn carry_out(&mut self, program: &mut zmq::Socket) {
        for output in self.desk.take_outputs() {
            match output {
                Output::Reply(route, reply) => {
                    let frames = route.iter().map(Vec::as_slice).chain([reply.as_bytes()]);
                    // A client that has gone away gets nothing.
                    if let Err(error) = self.requests.send_multipart(frames, zmq::DONTWAIT) {
                        tracing::debug!("a reply finds no client: {error}");
                    }
                }
                Output::Instruct(instruction) => {
                    let frames = [b"".as_slice(), instruction.as_bytes()];
                    if let Err(error) = program.send_multipart(frames, zmq::DONTWAIT) {
                        tracing::debug!("the robot program is not connected: {error}");
                    }
                }
                Output::Reconnect => match self.connect() {
                    Ok(new) => *program = new,
                    Err(error) => tracing::warn!("{error}"),
                },
                Output::Order(order) => {
                    let _ = self.orders.send(order);
                }
            }
        }
    }
}
