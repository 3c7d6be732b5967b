//! Messages of a robot over successive connections to the broker.

use std::{
    collections::VecDeque,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use bytes::Bytes;
use iiwa_link::message::Refusal;
use tokio::{
    sync::mpsc::{Receiver, UnboundedReceiver, UnboundedSender, unbounded_channel},
    time::{Instant, interval, sleep},
};

use super::connection::{
    BrokerConnection, Delivery, MqttConnector, MqttFailure, MqttInput, SubscribedMessage, Will,
};
use crate::{
    commands::{CommandGate, CommandReply},
    message::{BridgeStatus, Kind, Message},
    spool::SpoolReader,
    spooling::SpoolTarget,
    trouble::{Trouble, until_shutdown},
};

/// Maximum number of unacknowledged events, within the limits of brokers.
const BATCH: usize = 20;
const BATCH_BYTES: usize = 1 << 20;

/// Interval of the shutdown check.
const TURN: Duration = Duration::from_millis(100);

/// Pause after a failure.
const PAUSE: Duration = Duration::from_secs(1);

/// Time for which the last events are sent at the end.
const LAST_EVENTS: Duration = Duration::from_secs(2);

/// Messages of a robot, on their way to the broker.
pub(super) struct Session {
    pub(super) connector: Arc<MqttConnector>,
    pub(super) robot: String,
    /// Topic prefix of the robot.
    pub(super) topic: String,
    pub(super) started: u64,
    pub(super) spool: Arc<SpoolTarget>,
    pub(super) reader: SpoolReader,
    /// Last status message of the bridge.
    pub(super) status: Arc<Mutex<Vec<u8>>>,
    pub(super) samples: Receiver<Vec<u8>>,
    pub(super) gate: Arc<CommandGate>,
}

/// A reply with its destination.
struct AddressedReply {
    reply: CommandReply,
    topic: String,
    correlation: Option<Bytes>,
}

/// Unacknowledged messages sent with `QoS` 1. Brokers acknowledge in order.
#[derive(Default)]
struct InFlight {
    /// `true` for each event of the spool.
    sent: VecDeque<bool>,
    events: usize,
    /// Events of the batch that the broker has refused.
    refused: u64,
}

impl InFlight {
    fn sent(&mut self, is_event: bool) {
        self.sent.push_back(is_event);
        self.events += usize::from(is_event);
    }

    /// Records the acknowledgement of the oldest message. At the last event of a batch, returns the
    /// number of refused events in this batch.
    fn answered(&mut self, is_refused: bool) -> Option<u64> {
        let is_event = self.sent.pop_front() == Some(true);
        self.events -= usize::from(is_event);
        self.refused += u64::from(is_event && is_refused);
        (is_event && self.events == 0).then(|| std::mem::take(&mut self.refused))
    }
}

impl Session {
    /// Sends until the shutdown, over as many connections as necessary.
    pub(super) async fn run(mut self, shutdown: &AtomicBool) {
        let mut trouble = Trouble::default();
        let (replies, mut replies_out) = unbounded_channel();
        let mut was_connected = false;
        while !shutdown.load(Ordering::Relaxed) {
            let will = Will {
                topic: format!("{}/{}", self.topic, Kind::Bridge.name()),
                payload: BridgeStatus::last_will(&self.robot, self.started).to_json().into(),
                retain: true,
            };
            let mut connection = self.connector.open(&self.robot, Some(will));
            let sent = async {
                connection.connected().await?;
                if trouble.clear() {
                    tracing::info!("MQTT at {}: messages arrive again", self.connector.address());
                }
                let is_again = std::mem::replace(&mut was_connected, true);
                let replies = (&replies, &mut replies_out);
                self.send(&mut connection, replies, (is_again, shutdown)).await
            };
            let last = async {
                until_shutdown(shutdown).await;
                sleep(2 * LAST_EVENTS).await;
            };
            let sent = tokio::select! {
                sent = sent => sent,
                () = last => break,
            };
            match sent {
                Ok(()) => connection.end().await,
                Err(failure) => {
                    self.reader.rewind();
                    trouble.warn(format_args!(
                        "MQTT at {}: {}; events are kept until it is back",
                        self.connector.address(),
                        failure.message
                    ));
                    sleep(PAUSE).await;
                }
            }
        }
        if let Err(error) = self.reader.save(self.spool.spool()) {
            tracing::warn!("cannot save the position in the spool: {error}");
        }
    }

    /// Sends over a connection until the shutdown.
    async fn send(
        &mut self,
        connection: &mut BrokerConnection,
        (replies, replies_out): (
            &UnboundedSender<AddressedReply>,
            &mut UnboundedReceiver<AddressedReply>,
        ),
        (is_again, shutdown): (bool, &AtomicBool),
    ) -> Result<(), MqttFailure> {
        connection.subscribe(&format!("{}/request", self.topic)).await?;
        let joints = format!("{}/{}", self.topic, Kind::Joints.name());
        // Samples received before the connection are late.
        while self.samples.try_recv().is_ok() {}
        let mut in_flight = InFlight::default();
        let mut refusals = Trouble::default();
        // The broker has published the last will of the previous connection.
        let status = self.status.lock().unwrap_or_else(PoisonError::into_inner).clone();
        if is_again && !status.is_empty() {
            let topic = format!("{}/{}", self.topic, Kind::Bridge.name());
            connection.publish(&topic, status, Delivery::Retained, None).await?;
            in_flight.sent(false);
        }
        let mut turn = interval(TURN);
        let mut until = None;
        loop {
            let spool = Arc::clone(&self.spool);
            tokio::select! {
                incoming = connection.next() => match incoming? {
                    MqttInput::Acknowledged => self.answered(&mut in_flight, false)?,
                    MqttInput::Refused { why, lasts: true } => {
                        refusals.warn(format_args!(
                            "MQTT at {}: the broker refuses messages: {why}; they are left out",
                            self.connector.address()
                        ));
                        self.answered(&mut in_flight, true)?;
                    }
                    MqttInput::Refused { why, lasts: false } => {
                        let message = format!("the broker accepts no messages: {why}");
                        return Err(MqttFailure { message, is_refusal: false });
                    }
                    MqttInput::Message(received) => self.command(received, replies),
                    MqttInput::Connected | MqttInput::Other => {}
                },
                Some(sample) = self.samples.recv() => {
                    connection.publish(&joints, sample, Delivery::AtMostOnce, None).await?;
                }
                Some(AddressedReply { reply, topic, correlation }) = replies_out.recv() => {
                    let payload = reply.to_json().into_bytes();
                    connection.publish(&topic, payload, Delivery::AtLeastOnce, correlation).await?;
                    in_flight.sent(false);
                }
                () = spool.appended() => {}
                _ = turn.tick() => {}
            }
            let mut is_empty = false;
            if in_flight.events == 0 {
                is_empty = !self.send_batch(connection, &mut in_flight).await?;
            }
            if shutdown.load(Ordering::Relaxed) {
                let until = *until.get_or_insert_with(|| Instant::now() + LAST_EVENTS);
                if is_empty && in_flight.sent.is_empty() || Instant::now() >= until {
                    return Ok(());
                }
            }
        }
    }

    /// Sends the next events of the spool; `false` if the spool is empty.
    async fn send_batch(
        &mut self,
        connection: &BrokerConnection,
        in_flight: &mut InFlight,
    ) -> Result<bool, MqttFailure> {
        let batch = self.reader.batch(self.spool.spool(), BATCH, BATCH_BYTES);
        let batch = batch.map_err(|error| unreadable(&error))?;
        for bytes in &batch {
            // Events of another version are skipped.
            let Some(SpooledEvent { kind, payload }) = SpooledEvent::from_bytes(bytes) else {
                continue;
            };
            let topic = format!("{}/{}", self.topic, kind.name());
            connection.publish(&topic, payload, Delivery::Retained, None).await?;
            in_flight.sent(true);
        }
        if in_flight.events == 0 && !batch.is_empty() {
            self.reader.commit(self.spool.spool()).map_err(|error| unreadable(&error))?;
        }
        Ok(!batch.is_empty())
    }

    /// Handles an acknowledgement: a completely acknowledged batch is committed, and not sent
    /// again.
    fn answered(&mut self, in_flight: &mut InFlight, is_refused: bool) -> Result<(), MqttFailure> {
        if let Some(refused) = in_flight.answered(is_refused) {
            self.spool.refused(refused);
            self.reader.commit(self.spool.spool()).map_err(|error| unreadable(&error))?;
        }
        Ok(())
    }

    fn command(&self, received: SubscribedMessage, replies: &UnboundedSender<AddressedReply>) {
        let SubscribedMessage { payload, is_retained, response_topic, correlation, .. } = received;
        if is_retained && payload.is_empty() {
            // An empty payload removes a retained command from the broker.
            return;
        }
        let (topic, addressed) = reply_topic(&self.topic, response_topic);
        let accepted = if is_retained { Err(retained()) } else { addressed };
        let replies = replies.clone();
        let answer = move |reply| drop(replies.send(AddressedReply { reply, topic, correlation }));
        match accepted {
            Ok(()) => self.gate.command(Some(&self.robot), &payload, Box::new(answer)),
            Err(refusal) => {
                self.gate.reject(Some(&self.robot), &payload, &refusal, Box::new(answer));
            }
        }
    }
}

/// Returns the reply topic of a command, and the refusal of a foreign response topic. The bridge
/// may have publish rights that the sender does not have: replies are published to the robot's
/// reply topic and its subtopics only.
fn reply_topic(robot: &str, response_topic: Option<String>) -> (String, Result<(), Refusal>) {
    let reply_topic_name = format!("{robot}/reply");
    let Some(topic) = response_topic else { return (reply_topic_name, Ok(())) };
    let below = topic.strip_prefix(&reply_topic_name).and_then(|rest| rest.strip_prefix('/'));
    // A publication with such a topic is invalid and would end the connection.
    let is_topic = |rest: &str| !rest.contains(['+', '#']) && !rest.contains(char::is_control);
    if topic == reply_topic_name || below.is_some_and(|rest| !rest.is_empty() && is_topic(rest)) {
        return (topic, Ok(()));
    }
    let reason = format!("the response topic has to be `{reply_topic_name}` or a topic below it");
    (reply_topic_name, Err(Refusal::bad(reason)))
}

fn retained() -> Refusal {
    Refusal::bad(
        "the command is retained, so that the broker would deliver it again and again: publish it \
         without the retain flag; an empty retained message removes it from the broker",
    )
}

fn unreadable(error: &std::io::Error) -> MqttFailure {
    MqttFailure { message: format!("cannot read the spool: {error}"), is_refusal: false }
}

/// An event in the spool: its kind, followed by its text.
pub(super) struct SpooledEvent {
    kind: Kind,
    payload: Vec<u8>,
}

impl SpooledEvent {
    pub(super) fn of(message: &Message) -> Self {
        Self { kind: message.kind(), payload: message.to_json().into_bytes() }
    }

    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let kind = u8::try_from(self.kind.index()).unwrap_or(u8::MAX);
        [&[kind][..], &self.payload].concat()
    }

    fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (kind, payload) = bytes.split_first()?;
        let kind = *Kind::ALL.get(usize::from(*kind))?;
        Some(Self { kind, payload: payload.to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replies_stay_below_the_topic_for_replies() {
        let reply_topic_name = "iiwasim/cell-1/reply";
        let to = |topic: &str| reply_topic("iiwasim/cell-1", Some(topic.to_owned()));
        assert_eq!(reply_topic("iiwasim/cell-1", None), (reply_topic_name.to_owned(), Ok(())));
        for accepted in
            [reply_topic_name, "iiwasim/cell-1/reply/7f3c", "iiwasim/cell-1/reply/client/7f3c"]
        {
            assert_eq!(to(accepted), (accepted.to_owned(), Ok(())));
        }
        for foreign in [
            "",
            "answers",
            "iiwasim/cell-1",
            "iiwasim/cell-1/",
            "iiwasim/cell-1/request",
            "iiwasim/cell-1/state",
            "iiwasim/cell-1/replys",
            "iiwasim/cell-1/reply/",
            "iiwasim/cell-1/reply/+",
            "iiwasim/cell-1/reply/#",
            "iiwasim/cell-1/reply/a\u{7}",
            "iiwasim/cell-2/reply/7f3c",
            "iiwasim/cell-2/request",
            "/iiwasim/cell-1/reply/7f3c",
            "$SYS/broker",
        ] {
            let (topic, accepted) = to(foreign);
            assert_eq!(topic, reply_topic_name, "{foreign}");
            let reason = accepted.unwrap_err().message;
            assert!(
                reason.contains("`iiwasim/cell-1/reply` or a topic below it"),
                "{foreign}: {reason}"
            );
        }
    }
}
