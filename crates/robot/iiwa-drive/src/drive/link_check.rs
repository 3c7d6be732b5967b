//! Step-by-step check of the connection to a cabinet. Each step reports its result, faults and
//! remedies. No motion is commanded.

mod fri;
mod step;

use std::{net::UdpSocket, sync::mpsc, thread, time::Duration};

use iiwa_link::{
    message::{Conditions, RobotIdentity, shortened},
    robot_program::{PROTOCOL, StateChange},
    security::ConnectionRefusal,
    socket::{Dial, Remote},
    threads::raise_priority,
    transport::ProbeError,
};
use serde::Serialize;

use super::{
    DriveConfig,
    protocol::{acknowledge, check_protocol},
};
use fri::{FriFindings, listen};
use step::LinkFault;
pub use step::{CheckStep, StepResult};

/// Time-out of a connection, and of its handshake.
const PROBE_TIMEOUT: Duration = Duration::from_secs(2);

/// Time-out of the robot program's state, which is sent twice per second.
const STATE_TIMEOUT: Duration = Duration::from_secs(3);

/// Result of a step-by-step check of the connection to a cabinet.
///
/// ```no_run
/// use iiwa_drive::{DriveConfig, LinkCheck};
/// use iiwa_link::Remote;
///
/// let check = LinkCheck::run(&DriveConfig::default(), &Remote::open(), |step| {
///     println!("{}", step.line(""));
/// });
/// println!("{}", if check.ok { "ready" } else { "not ready" });
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct LinkCheck {
    /// `true` if no step fails.
    pub ok: bool,
    /// The steps, in order.
    pub steps: Vec<CheckStep>,
}

impl LinkCheck {
    /// Checks the connection that a drive with this configuration makes to a cabinet. Calls
    /// `on_step` after each step. The check takes at most a quarter of a minute.
    pub fn run(config: &DriveConfig, cabinet: &Remote, on_step: impl FnMut(&CheckStep)) -> Self {
        let mut steps = Steps { done: Vec::new(), on_step };
        match bind_fri_port(config) {
            Ok(udp) => {
                steps.ok(UDP_PORT, format!("UDP {} is free", config.fri));
                thread::scope(|scope| {
                    // In parallel, because the checks would take too long in sequence.
                    let listening =
                        scope.spawn(|| (raise_priority(), listen(&udp, config.fri_controller)));
                    check_program(config, cabinet, &mut steps);
                    // The thread does not panic.
                    let (real_time, findings) = listening.join().unwrap_or_default();
                    check_fri(config, &findings, &mut steps);
                    check_priority(real_time, findings.period_ms(), &mut steps);
                });
            }
            Err(fault) => {
                steps.fails(UDP_PORT, fault);
                // Another drive may be running, and would miss the messages received here.
                for step in AFTER_UDP {
                    steps.skipped(step, "the UDP port is not free");
                }
            }
        }
        let steps = steps.done;
        Self { ok: steps.iter().all(|step| step.result != StepResult::Fails), steps }
    }
}

const UDP_PORT: &str = "UDP port";
const INSTRUCTIONS: &str = "instruction port";
const STATES: &str = "state port";
const KEYS: &str = "keys";
const PROGRAM: &str = "robot program";
const CONDITIONS: &str = "conditions";
const MESSAGES: &str = "FRI messages";
const VERSION: &str = "FRI version";
const PERIOD: &str = "send period";
const SESSION: &str = "FRI session";
const PRIORITY: &str = "real-time priority";

/// The steps after the UDP port step.
const AFTER_UDP: [&str; 10] =
    [INSTRUCTIONS, STATES, KEYS, PROGRAM, CONDITIONS, MESSAGES, VERSION, PERIOD, SESSION, PRIORITY];

/// Completed steps.
struct Steps<F> {
    done: Vec<CheckStep>,
    on_step: F,
}

impl<F: FnMut(&CheckStep)> Steps<F> {
    fn add(&mut self, step: &'static str, result: StepResult, fault: LinkFault) {
        let LinkFault { text, settings } = fault;
        let step = CheckStep { step, result, text, settings };
        (self.on_step)(&step);
        self.done.push(step);
    }

    fn ok(&mut self, step: &'static str, text: impl Into<String>) {
        self.add(step, StepResult::Ok, LinkFault::new(text, &[]));
    }

    fn fails(&mut self, step: &'static str, fault: LinkFault) {
        self.add(step, StepResult::Fails, fault);
    }

    fn skipped(&mut self, step: &'static str, text: impl Into<String>) {
        self.add(step, StepResult::Skipped, LinkFault::new(text, &[]));
    }

    fn of(&mut self, step: &'static str, result: Result<String, LinkFault>) {
        match result {
            Ok(text) => self.ok(step, text),
            Err(fault) => self.fails(step, fault),
        }
    }
}

/// Binds the drive's UDP port, if it is free and reachable from the controller.
fn bind_fri_port(config: &DriveConfig) -> Result<UdpSocket, LinkFault> {
    use std::io::ErrorKind::{AddrInUse, AddrNotAvailable};
    let (fri, controller) = (config.fri, config.fri_controller);
    if fri.ip().is_loopback() && !controller.is_loopback() {
        let text = format!(
            "UDP {fri} is reached from this machine only, and FRI comes from {controller}: give \
             the address of the network card towards the cabinet, with port {}",
            fri.port()
        );
        return Err(LinkFault::new(text, &["fri"]));
    }
    if !fri.ip().is_loopback() && controller.is_loopback() {
        let text = format!(
            "FRI would be accepted from this machine only ({controller}): give the controller's \
             address"
        );
        return Err(LinkFault::new(text, &["cabinet", "fri-cabinet"]));
    }
    UdpSocket::bind(fri).map_err(|error| {
        let text = match error.kind() {
            AddrInUse => format!(
                "UDP {fri} is in use: another program, as another drive, listens there; end it, or \
                 choose another port"
            ),
            AddrNotAvailable => format!(
                "no network card of this machine has the address {}: plug in the cable to the \
                 cabinet, set the card's address, or give another one",
                fri.ip()
            ),
            _ => format!("UDP {fri} cannot be used: {error}"),
        };
        LinkFault::new(text, &["fri"])
    })
}

/// Checks the ports of the robot program, the keys, and the reported state.
fn check_program<F: FnMut(&CheckStep)>(
    config: &DriveConfig,
    cabinet: &Remote,
    steps: &mut Steps<F>,
) {
    let ports = [
        (INSTRUCTIONS, Dial::Dealer, &config.cabinet_instructions),
        (STATES, Dial::Rep, &config.cabinet_state),
    ];
    let mut reached = Vec::new();
    let mut refused = None;
    for (step, kind, address) in ports {
        let result = cabinet.probe(kind, address, PROBE_TIMEOUT);
        if let Err(ProbeError::Refused(reason)) = result {
            refused = Some(reason);
        }
        match result {
            // A later step checks the keys.
            Ok(()) | Err(ProbeError::Refused(_)) => {
                steps.ok(step, format!("{address} accepts connections"));
                reached.push(result.is_ok());
            }
            Err(error) => steps.fails(step, unreachable(address, &error)),
        }
    }
    let connected = reached == [true, true];
    match refused {
        Some(reason) => steps.fails(KEYS, refusal(reason, cabinet.has_keys())),
        None if connected && cabinet.has_keys() => {
            steps.ok(KEYS, "both sides accept each other's key");
        }
        None if connected => steps.ok(KEYS, "none, on both sides"),
        None => steps.skipped(KEYS, "not connected"),
    }
    if !connected {
        steps.skipped(PROGRAM, "not connected");
        return steps.skipped(CONDITIONS, "not connected");
    }
    if let Some(state) = receive_state(cabinet, &config.cabinet_state) {
        steps.of(PROGRAM, program(&state, &RobotIdentity::from(&config.robot)));
        return check_conditions(state.conditions.as_ref(), steps);
    }
    let text = format!(
        "it accepts connections, but sends no state within {} s: restart it on the smartPAD, and \
         make sure that no other drive is connected to it",
        STATE_TIMEOUT.as_secs()
    );
    steps.fails(PROGRAM, LinkFault::new(text, &[]));
    steps.skipped(CONDITIONS, "the robot program does not answer");
}

/// Returns the reason why a port is unreachable, with the remedy.
fn unreachable(address: &str, error: &ProbeError) -> LinkFault {
    const PORTS: &[&str] = &["cabinet-instructions", "cabinet-state"];
    match error {
        ProbeError::NothingListens => {
            let text = format!(
                "{address}: the host answers, and nothing listens at the port: start the robot \
                 program on the smartPAD, and compare the ports in its settings"
            );
            LinkFault::new(text, PORTS)
        }
        ProbeError::NoAnswer => {
            let text = format!(
                "{address}: no answer: is the cabinet on, the cable in its KLI port (X66), is this \
                 its address, are both in one network (address and mask), does a firewall block \
                 the port?"
            );
            LinkFault::new(text, &["cabinet"])
        }
        ProbeError::NoHandshake | ProbeError::Protocol { .. } => {
            let text = format!(
                "{address}: something listens there that does not speak as a robot program does \
                 ({error}): compare the ports, and the keys on both sides"
            );
            LinkFault::new(text, PORTS)
        }
        ProbeError::UnknownHost => {
            let text = format!("{address}: the name of the host is not known: give its IP address");
            LinkFault::new(text, &["cabinet"])
        }
        _ => LinkFault::new(format!("{address}: {error}"), &["key", "cabinet-key"]),
    }
}

/// Returns the fault for wrong keys.
fn refusal(reason: ConnectionRefusal, has_keys: bool) -> LinkFault {
    let text = match reason {
        ConnectionRefusal::KeysOnOneSide if has_keys => {
            "this side has keys, the robot program has none: give it keys in its settings, or \
             leave them out here if both are on one machine"
        }
        ConnectionRefusal::KeysOnOneSide => {
            "the robot program has keys, this side has none: give them"
        }
        ConnectionRefusal::NotAllowed => {
            "the robot program does not know this side's key: give it the .pub file that belongs \
             to that"
        }
        _ => {
            "the robot program closes the connection: does this side have its .pub file, and it \
             the .pub file that belongs to this side's key?"
        }
    };
    LinkFault::new(text, &["key", "cabinet-key"])
}

/// Receives and acknowledges the state of the robot program.
fn receive_state(cabinet: &Remote, address: &str) -> Option<StateChange> {
    let (states, received) = mpsc::channel();
    let connection = cabinet.dial("check state", Dial::Rep, address, move |frames| {
        let (state, acknowledgement) = acknowledge(frames);
        if let Some(state) = state {
            // Later states are not needed: the send error is ignored.
            let _ = states.send(state);
        }
        Some(acknowledgement)
    });
    let state = received.recv_timeout(STATE_TIMEOUT).ok();
    drop(connection);
    state
}

/// Reports the robot program, its version and its robot.
fn program(state: &StateChange, robot: &RobotIdentity) -> Result<String, LinkFault> {
    let simulated = if state.simulated { ", of a simulated robot" } else { "" };
    let Some(hello) = &state.hello else {
        return Ok(format!("it answers{simulated}, but does not report its version"));
    };
    check_protocol(hello).map_err(|refusal| LinkFault::new(refusal.message, &[]))?;
    let sunrise = hello.sunrise.as_ref().map(|version| format!(", Sunrise {}", shortened(version)));
    let robot = match &hello.robot {
        Some(at_cabinet) => {
            let same = robot.check_cabinet(at_cabinet);
            same.map_err(|refusal| LinkFault::new(refusal.message, &["robot"]))?;
            format!(", {at_cabinet}")
        }
        None => ", robot not stated".to_owned(),
    };
    Ok(format!(
        "{}{}{robot}, protocol {PROTOCOL}{simulated}; {}",
        shortened(&hello.program),
        sunrise.unwrap_or_default(),
        state.state
    ))
}

fn check_conditions<F: FnMut(&CheckStep)>(reported: Option<&Conditions>, steps: &mut Steps<F>) {
    let text = reported.map(Conditions::text).filter(|text| !text.is_empty());
    let (Some(conditions), Some(text)) = (reported, text) else {
        return steps.skipped(CONDITIONS, "the robot program does not tell them");
    };
    if conditions.safety_stop == Some(true) {
        return steps.fails(
            CONDITIONS,
            LinkFault::new(
                format!(
                    "{text}: no motion begins; release the emergency stop, and acknowledge it on \
                     the smartPAD"
                ),
                &[],
            ),
        );
    }
    let caution = conditions.caution().map(|caution| format!("; {caution}"));
    steps.ok(CONDITIONS, text + &caution.unwrap_or_default());
}

/// Checks the messages received over FRI.
fn check_fri<F: FnMut(&CheckStep)>(
    config: &DriveConfig,
    findings: &FriFindings,
    steps: &mut Steps<F>,
) {
    steps.of(MESSAGES, findings.messages(config));
    let skipped = "no FRI messages arrive";
    if !findings.has_arrived() {
        return [VERSION, PERIOD, SESSION]
            .into_iter()
            .for_each(|step| steps.skipped(step, skipped));
    }
    steps.of(VERSION, findings.version());
    if findings.period_ms().is_none() {
        let skipped = "the FRI messages cannot be read";
        return [PERIOD, SESSION].into_iter().for_each(|step| steps.skipped(step, skipped));
    }
    steps.of(PERIOD, findings.period());
    steps.of(SESSION, findings.session());
}

/// Maximum send period that requires real-time priority, in ms.
const URGENT_MS: u32 = 2;

fn check_priority<F: FnMut(&CheckStep)>(
    real_time: bool,
    period_ms: Option<u32>,
    steps: &mut Steps<F>,
) {
    let remedy = "setcap cap_sys_nice=ep for the program, or rtprio for the user in \
               /etc/security/limits.conf";
    match period_ms {
        _ if real_time => steps.ok(PRIORITY, "permitted"),
        Some(period_ms) if period_ms <= URGENT_MS => {
            let text = format!(
                "not permitted, and FRI sends every {period_ms} ms: {remedy}; or a send period of \
                 5 ms"
            );
            steps.fails(PRIORITY, LinkFault::new(text, &[]));
        }
        _ => steps.ok(
            PRIORITY,
            format!("not permitted; at 5 ms, a quiet machine does without ({remedy})"),
        ),
    }
}
