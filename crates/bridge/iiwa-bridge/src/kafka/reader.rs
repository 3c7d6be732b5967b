//! Reads messages that bridges have written to Kafka.

use std::{
    collections::HashMap,
    ops::ControlFlow::{self, Break, Continue},
    sync::Arc,
    time::{Duration, SystemTime},
};

use rskafka::{
    client::{
        Client,
        error::{Error, ProtocolError},
        partition::{OffsetAt, PartitionClient, UnknownTopicHandling},
    },
    record::Record,
};
use tokio::time::timeout;

use super::{
    connection::{KafkaConnection, KafkaConnector, KafkaFailure},
    topics::topic,
};
use crate::{
    BridgeError,
    encoding::JointFormat,
    message::{Kind, Message, Timestamp},
};

/// Maximum number of bytes per fetch.
const FETCH_BYTES: i32 = 8 << 20;

/// Maximum time for which the broker holds a fetch.
const WAIT_MS: i32 = 500;

/// Tolerance of record time stamps, which are rounded to ms more than once.
const STAMPS_ARE_WITHIN: Duration = Duration::from_millis(10);

/// Time-out of a fetch.
const FETCH_TIMEOUT: Duration = Duration::from_secs(30);

/// Selection of the messages to read.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// Messages of this robot only.
    pub robot: Option<String>,
    /// Messages from this time on, by the bridge clock.
    pub from: Option<Timestamp>,
    /// Messages before this time.
    pub until: Option<Timestamp>,
}

impl Selection {
    fn has(&self, message: &Message) -> bool {
        self.robot.as_ref().is_none_or(|robot| *robot == message.robot)
            && self.from.is_none_or(|from| message.at >= from)
            && self.until.is_none_or(|until| message.at < until)
    }
}

/// Counts of omitted messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OmittedMessages {
    /// Messages that had arrived before.
    pub repeated: u64,
    /// Records that are not messages of this version, such as joints in CDR, which lack the
    /// controller time.
    pub unreadable: u64,
    /// Gaps in the numbers of the messages that arrived.
    pub missing: u64,
}

/// Reads bridge topics from the beginning, or from a given time, to their current end.
#[derive(Debug)]
pub struct KafkaReader {
    connector: KafkaConnector,
    prefix: String,
}

impl KafkaReader {
    /// Creates a reader of the topics with this `prefix`.
    ///
    /// # Errors
    ///
    /// A certificate cannot be used, or the settings contradict each other.
    pub fn new(connection: &KafkaConnection, prefix: &str) -> Result<Self, BridgeError> {
        Ok(Self { connector: connection.connector()?, prefix: prefix.to_owned() })
    }

    /// Passes the selected messages of a kind to `take`, each once and in order per robot, until
    /// `take` breaks.
    ///
    /// # Errors
    ///
    /// The broker is unreachable or refuses the connection, or has no such topic.
    pub fn read(
        &self,
        kind: Kind,
        selection: &Selection,
        mut take: impl FnMut(Message) -> ControlFlow<()>,
    ) -> Result<OmittedMessages, BridgeError> {
        let mut once = Once::default();
        let read = async {
            let client = self.connector.connect().await?;
            let name = topic(&self.prefix, kind.name());
            for partition in self.partitions(&client, &name).await? {
                let read = read_partition(&partition, selection, &mut once, &mut take).await?;
                if read.is_break() {
                    break;
                }
            }
            Ok(())
        };
        let runtime = crate::runtime()?;
        runtime.block_on(read).map_err(|failure| self.connector.broken(failure))?;
        Ok(once.left_out)
    }

    /// Passes the messages of a replay to `take`: joints, states, runs and conditions, in the order
    /// of their arrival.
    ///
    /// # Errors
    ///
    /// Same as [`read`](Self::read).
    pub fn replay(
        &self,
        selection: &Selection,
        mut take: impl FnMut(Message) -> ControlFlow<()>,
    ) -> Result<OmittedMessages, BridgeError> {
        // Events are rare.
        let mut events = Vec::new();
        for kind in [Kind::State, Kind::Run, Kind::Conditions] {
            self.read(kind, selection, |message| {
                events.push(message);
                Continue(())
            })?;
        }
        events.sort_by_key(|message| message.at);
        let mut events = events.into_iter().peekable();
        let mut has_ended = false;
        let left_out = self.read(Kind::Joints, selection, |message| {
            while let Some(event) = events.next_if(|event| event.at <= message.at) {
                if take(event).is_break() {
                    has_ended = true;
                    return Break(());
                }
            }
            let result = take(message);
            has_ended = result.is_break();
            result
        })?;
        if !has_ended {
            let _ = events.try_for_each(take);
        }
        Ok(left_out)
    }

    async fn partitions(
        &self,
        client: &Client,
        name: &str,
    ) -> Result<Vec<Arc<PartitionClient>>, KafkaFailure> {
        let topics = client.list_topics().await.map_err(|error| KafkaFailure::of(&error))?;
        let Some(topic) = topics.into_iter().find(|entry| entry.name == name) else {
            let message =
                format!("unknown topic {name}; has a bridge written to it, with this prefix?");
            return Err(KafkaFailure::passing(message));
        };
        let mut partitions = Vec::new();
        for partition in topic.partitions {
            let retry = UnknownTopicHandling::Retry;
            let opened = client.partition_client(name, partition, retry).await;
            partitions.push(Arc::new(opened.map_err(|error| KafkaFailure::of(&error))?));
        }
        Ok(partitions)
    }
}

async fn read_partition(
    partition: &PartitionClient,
    selection: &Selection,
    once: &mut Once,
    take: &mut impl FnMut(Message) -> ControlFlow<()>,
) -> Result<ControlFlow<()>, KafkaFailure> {
    let offset = async |offset_at| {
        partition.get_offset(offset_at).await.map_err(|error| KafkaFailure::of(&error))
    };
    let end = offset(OffsetAt::Latest).await?;
    let mut next = match selection.from {
        None => offset(OffsetAt::Earliest).await?,
        Some(from) => {
            let from = SystemTime::from(from) - STAMPS_ARE_WITHIN;
            match offset(OffsetAt::Timestamp(from.into())).await? {
                // All records are older.
                ..0 => return Ok(Continue(())),
                first => first,
            }
        }
    };
    while next < end {
        let fetch = partition.fetch_records(next, 1..FETCH_BYTES, WAIT_MS);
        let records = match timeout(FETCH_TIMEOUT, fetch).await {
            Err(_) => return Err(KafkaFailure::timeout()),
            Ok(Ok((records, _))) => records,
            // The records at this offset have expired meanwhile.
            Ok(Err(Error::ServerError {
                protocol_error: ProtocolError::OffsetOutOfRange, ..
            })) => {
                next = offset(OffsetAt::Earliest).await?.max(next + 1);
                continue;
            }
            Ok(Err(error)) => return Err(KafkaFailure::of(&error)),
        };
        let Some(last) = records.last() else { break };
        next = last.offset + 1;
        for record in records {
            let Some(message) = message_of(&record.record) else {
                once.left_out.unreadable += 1;
                continue;
            };
            if selection.until.is_some_and(|until| message.at >= until)
                && selection.robot.as_ref().is_some_and(|robot| *robot == message.robot)
            {
                return Ok(Continue(()));
            }
            if selection.has(&message) && once.admit(&message) && take(message).is_break() {
                return Ok(Break(()));
            }
        }
    }
    Ok(Continue(()))
}

fn message_of(record: &Record) -> Option<Message> {
    let value = record.value.as_ref()?;
    if JointFormat::is_json(value) {
        Message::from_json(value).ok()
    } else {
        JointFormat::decode_protobuf(value)
    }
}

/// Filter that passes each message once. The numbers of a robot, kind and session increase
/// monotonically, and a later session has a larger number.
#[derive(Debug, Default)]
struct Once {
    last: HashMap<String, (u64, u64)>,
    left_out: OmittedMessages,
}

impl Once {
    fn admit(&mut self, message: &Message) -> bool {
        let number = (message.session, message.seq);
        match self.last.get_mut(&message.robot) {
            Some(last) if number <= *last => {
                self.left_out.repeated += 1;
                false
            }
            Some(last) => {
                if last.0 == number.0 {
                    self.left_out.missing += number.1 - last.1 - 1;
                }
                *last = number;
                true
            }
            None => {
                self.last.insert(message.robot.clone(), number);
                true
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use iiwa_link::message::DriveState;

    use super::*;
    use crate::{Content, message::VERSION};

    #[test]
    fn repetitions_are_left_out_and_gaps_are_counted() {
        let message = |session, seq| Message {
            version: VERSION,
            robot: "cell".to_owned(),
            session,
            seq,
            at: Timestamp::from_micros(0),
            content: Content::State { t_s: 0.0, state: DriveState::Idle },
        };
        let mut once = Once::default();
        let numbers = [(1, 0), (1, 1), (1, 0), (1, 1), (1, 2), (1, 5), (2, 0), (1, 6), (2, 1)];
        let admitted = numbers.map(|(session, seq)| once.admit(&message(session, seq)));
        assert_eq!(admitted, [true, true, false, false, true, true, true, false, true]);
        assert_eq!(once.left_out, OmittedMessages { repeated: 3, unreadable: 0, missing: 2 });
    }
}
