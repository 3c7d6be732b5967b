//! Reads what bridges have written to Kafka.

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

/// Most bytes per fetch.
const FETCH_BYTES: i32 = 8 << 20;

/// How long the broker may hold a fetch.
const WAIT_MS: i32 = 500;

/// Stamps of records are rounded to ms more than once.
const STAMPS_ARE_WITHIN: Duration = Duration::from_millis(10);

/// How long a fetch may take.
const FETCH_TIMEOUT: Duration = Duration::from_secs(30);

/// Which messages are read.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// Of this robot only.
    pub robot: Option<String>,
    /// From this time on, by the bridge's clock.
    pub from: Option<Timestamp>,
    /// Before this time.
    pub until: Option<Timestamp>,
}

impl Selection {
    fn has(&self, message: &Message) -> bool {
        self.robot.as_ref().is_none_or(|robot| *robot == message.robot)
            && self.from.is_none_or(|from| message.at >= from)
            && self.until.is_none_or(|until| message.at < until)
    }
}

/// What was left out on the way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LeftOut {
    /// Messages that had arrived before.
    pub repeated: u64,
    /// Records that are no messages of this version, such as joints in CDR, which have no controller's clock.
    pub unreadable: u64,
    /// Messages that are missing between those that arrived.
    pub missing: u64,
}

/// Reads topics of bridges from the beginning, or from a time on, to where they end now.
#[derive(Debug)]
pub struct KafkaReader {
    connector: KafkaConnector,
    prefix: String,
}

impl KafkaReader {
    /// A reader of the topics that begin with `prefix`.
    ///
    /// # Errors
    ///
    /// A certificate cannot be used, or the settings contradict each other.
    pub fn new(connection: &KafkaConnection, prefix: &str) -> Result<Self, BridgeError> {
        Ok(Self { connector: connection.connector()?, prefix: prefix.to_owned() })
    }

    /// Gives the selected messages of a kind to `take`, each once and those of a robot in order, until it breaks off.
    ///
    /// # Errors
    ///
    /// The broker cannot be reached or refuses the connection, or has no such topic.
    pub fn read(
        &self,
        kind: Kind,
        selection: &Selection,
        mut take: impl FnMut(Message) -> ControlFlow<()>,
    ) -> Result<LeftOut, BridgeError> {
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

    /// Gives all that a replay shows to `take`: joints, states, runs and conditions, in the order in which they came.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    pub fn replay(
        &self,
        selection: &Selection,
        mut take: impl FnMut(Message) -> ControlFlow<()>,
    ) -> Result<LeftOut, BridgeError> {
        // These are few.
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
            let taken = take(message);
            has_ended = taken.is_break();
            taken
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
        let Some(found) = topics.into_iter().find(|topic| topic.name == name) else {
            let what =
                format!("there is no topic {name}; has a bridge written to it, with this prefix?");
            return Err(KafkaFailure::passing(what));
        };
        let mut partitions = Vec::new();
        for partition in found.partitions {
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
    let offset =
        async |at| partition.get_offset(at).await.map_err(|error| KafkaFailure::of(&error));
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
            // What was there has expired meanwhile.
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

/// Lets each message pass once. Numbers of a robot, kind and session only grow, and a later session has a larger number.
#[derive(Debug, Default)]
struct Once {
    last: HashMap<String, (u64, u64)>,
    left_out: LeftOut,
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
        assert_eq!(once.left_out, LeftOut { repeated: 3, unreadable: 0, missing: 2 });
    }
}
