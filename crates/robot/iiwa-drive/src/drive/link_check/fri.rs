//! Reception of FRI messages. They are answered without set-points, so that the session opens.

use std::{
    net::{IpAddr, UdpSocket},
    time::{Duration, Instant},
};

use iiwa_fri::{Format, FriClient, Monitoring, Quality, SessionState};
use iiwa_link::socket::is_timeout;

use super::{
    super::{DriveConfig, setpoints::SendParameters},
    step::LinkFault,
};

/// Time-out of the first message.
const FIRST_TIMEOUT: Duration = Duration::from_secs(5);

/// Time-out of the session to be ready, after the first message.
const SESSION_TIMEOUT: Duration = Duration::from_secs(6);

const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Messages received over FRI.
#[derive(Debug, Default)]
pub(super) struct FriFindings {
    /// The latest message from the expected address.
    latest: Option<Monitoring>,
    /// The reason why a datagram from this address could not be decoded.
    unreadable: Option<String>,
    /// Another source address of messages.
    other: Option<IpAddr>,
}

/// Receives and answers messages of `controller` until the session is ready or a time-out expires.
pub(super) fn listen(udp: &UdpSocket, controller: IpAddr) -> FriFindings {
    let mut findings = FriFindings::default();
    let mut client = FriClient::new(Format::V1);
    let (mut buffer, mut answer) = ([0; 2048], Vec::new());
    let mut deadline = Instant::now() + FIRST_TIMEOUT;
    if udp.set_read_timeout(Some(POLL_INTERVAL)).is_err() {
        return findings;
    }
    while Instant::now() < deadline && !findings.is_ready() {
        let (length, from) = match udp.recv_from(&mut buffer) {
            Ok(received) => received,
            Err(error) if is_timeout(&error) => continue,
            Err(_) => {
                std::thread::sleep(POLL_INTERVAL);
                continue;
            }
        };
        let message = client.decode(&buffer[..length]);
        if from.ip() != controller {
            // Other datagrams do not show the address of a controller.
            findings.other = message.ok().map(|_| from.ip()).or(findings.other);
            continue;
        }
        match message {
            Err(error) => findings.unreadable = Some(error.to_string()),
            Ok(message) => {
                if findings.latest.is_none() {
                    deadline = Instant::now() + SESSION_TIMEOUT;
                }
                client.accept(message);
                findings.latest = client.latest().cloned();
                if client.answer(None, &mut answer) {
                    // The controller counts missing answers.
                    let _ = udp.send_to(&answer, from);
                }
            }
        }
    }
    findings
}

impl FriFindings {
    fn is_ready(&self) -> bool {
        self.latest.as_ref().is_some_and(|it| {
            it.session >= SessionState::MonitoringReady && it.quality >= Quality::Good
        })
    }

    /// Returns true if any datagram has arrived from the expected address.
    pub(super) fn has_arrived(&self) -> bool {
        self.latest.is_some() || self.unreadable.is_some()
    }

    /// Returns the send period, if messages can be decoded.
    pub(super) fn period_ms(&self) -> Option<u32> {
        self.latest.as_ref().map(|it| it.send_period_ms)
    }

    /// Checks that messages arrive.
    pub(super) fn messages(&self, config: &DriveConfig) -> Result<String, LinkFault> {
        let (fri, expected) = (config.fri, config.fri_controller);
        match self.other {
            _ if self.has_arrived() => Ok(format!("they come from {expected}")),
            Some(other) => Err(LinkFault::new(
                format!("they come from {other}, expected {expected}: is {other} the controller?"),
                &["fri-cabinet"],
            )),
            None => Err(LinkFault::new(
                format!(
                    "none arrives at UDP {fri} within {} s: in the settings of the robot program, \
                     the address of FRI's client has to be this machine's, and the port {}; a \
                     firewall here has to let UDP {} in; the cable of FRI may be another one \
                     (KONI)",
                    FIRST_TIMEOUT.as_secs(),
                    fri.port(),
                    fri.port()
                ),
                &["fri"],
            )),
        }
    }

    /// Checks that messages can be decoded.
    pub(super) fn version(&self) -> Result<String, LinkFault> {
        match (&self.latest, &self.unreadable) {
            (Some(_), _) => Ok("as FRI 1.14 to 1.16".to_owned()),
            (None, reason) => Err(LinkFault::new(
                format!(
                    "the messages cannot be read ({}): FRI 1.14 to 1.16 are supported; which one \
                     has the cabinet?",
                    reason.as_deref().unwrap_or_default()
                ),
                &[],
            )),
        }
    }

    /// Checks that the send period permits commanding.
    pub(super) fn period(&self) -> Result<String, LinkFault> {
        let Some(latest) = &self.latest else { return Ok(String::new()) };
        let (period_ms, multiplier) = (latest.send_period_ms, latest.receive_multiplier);
        match SendParameters::of(latest).check() {
            Ok(()) if multiplier > 1 => {
                Ok(format!("{period_ms} ms, with an answer every {multiplier} messages"))
            }
            Ok(()) => Ok(format!("{period_ms} ms")),
            Err(refusal) => {
                let text = format!("{refusal}; motions can run, trajectories cannot");
                Err(LinkFault::new(text, &[]))
            }
        }
    }

    /// Checks that the session is ready for commanding.
    pub(super) fn session(&self) -> Result<String, LinkFault> {
        let Some(latest) = &self.latest else { return Ok(String::new()) };
        let session = format!("{}, quality {}", latest.session.name(), latest.quality.name());
        if self.is_ready() {
            return Ok(session);
        }
        let text = format!(
            "{session}, {} s after the first message; monitoring_ready and good are needed: \
             answers do not reach the controller, or too late. Does a firewall let UDP out? Is the \
             machine busy? Try a longer send period",
            SESSION_TIMEOUT.as_secs()
        );
        Err(LinkFault::new(text, &[]))
    }
}
