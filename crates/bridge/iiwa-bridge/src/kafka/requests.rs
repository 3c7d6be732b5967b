//! Commands over Kafka.

use std::{
    collections::BTreeMap,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, SystemTime},
};

use rskafka::{
    client::{
        Client,
        error::{Error, ProtocolError},
        partition::{Compression, OffsetAt, PartitionClient, UnknownTopicHandling},
    },
    record::{Record, RecordAndOffset},
};
use tokio::{
    sync::mpsc::{UnboundedReceiver, unbounded_channel},
    time::{sleep, timeout},
};

use super::{
    connection::{KafkaConnector, KafkaFailure},
    partition::partition_of,
    producer::partitions_of,
    topics::topic,
};
use crate::{
    commands::{CommandGate, CommandReply},
    trouble::{Trouble, until_shutdown},
};

/// Time for which the broker holds a request while no records are available.
const WAIT_MS: i32 = 100;

/// Time for which replies are awaited between fetches.
const TURN: Duration = Duration::from_millis(20);

/// Pause after a failure.
const PAUSE: Duration = Duration::from_secs(1);

/// Maximum number of bytes per fetch.
const FETCH_BYTES: i32 = 8 << 20;

/// Reads the request topic from its current end, and sends replies, until the shutdown.
pub(super) async fn serve(
    connector: &KafkaConnector,
    prefix: &str,
    gate: &Arc<CommandGate>,
    shutdown: &AtomicBool,
) {
    let mut trouble = Trouble::default();
    let (replies, mut replies_out) = unbounded_channel();
    while !shutdown.load(Ordering::Relaxed) {
        let session = async {
            let client = connector.connect().await?;
            let mut requests = open(&client, &topic(prefix, "request")).await?;
            let answers = open(&client, &topic(prefix, "reply")).await?;
            let mut offsets = Vec::new();
            for partition in &requests {
                // Records sent before are too old.
                offsets.push(partition.get_offset(OffsetAt::Latest).await?);
            }
            trouble.clear();
            while !shutdown.load(Ordering::Relaxed) {
                for (partition, offset) in requests.iter_mut().zip(&mut offsets) {
                    for record in fetch(partition, offset).await? {
                        let replies = replies.clone();
                        let body = record.record.value.unwrap_or_default();
                        let answer = move |reply: CommandReply| drop(replies.send(reply));
                        gate.command(None, &body, Box::new(answer));
                    }
                }
                answer(&answers, &mut replies_out).await?;
            }
            Ok::<_, Failed>(())
        };
        let ended = tokio::select! {
            ended = session => ended,
            () = until_shutdown(shutdown) => return,
        };
        if let Err(Failed(failure)) = ended {
            let address = connector.address();
            trouble.warn(format_args!(
                "Kafka at {address}: no commands are received: {}",
                failure.message
            ));
            sleep(PAUSE).await;
        }
    }
}

/// A failure of either kind.
struct Failed(KafkaFailure);

impl From<Error> for Failed {
    fn from(error: Error) -> Self {
        Self(KafkaFailure::of(&error))
    }
}

impl From<KafkaFailure> for Failed {
    fn from(failure: KafkaFailure) -> Self {
        Self(failure)
    }
}

async fn open(client: &Client, name: &str) -> Result<Vec<PartitionClient>, Error> {
    let mut all = Vec::new();
    for partition in 0..partitions_of(client, name).await? {
        let retry = UnknownTopicHandling::Retry;
        all.push(client.partition_client(name, partition, retry).await?);
    }
    Ok(all)
}

async fn fetch(
    partition: &PartitionClient,
    offset: &mut i64,
) -> Result<Vec<RecordAndOffset>, Error> {
    match partition.fetch_records(*offset, 1..FETCH_BYTES, WAIT_MS).await {
        Ok((records, _)) => {
            if let Some(last) = records.last() {
                *offset = last.offset + 1;
            }
            Ok(records)
        }
        // The topic was emptied or replaced.
        Err(Error::ServerError { protocol_error: ProtocolError::OffsetOutOfRange, .. }) => {
            *offset = partition.get_offset(OffsetAt::Latest).await?;
            Ok(Vec::new())
        }
        Err(error) => Err(error),
    }
}

/// Sends the available replies.
async fn answer(
    answers: &[PartitionClient],
    replies: &mut UnboundedReceiver<CommandReply>,
) -> Result<(), Error> {
    while let Ok(Some(reply)) = timeout(TURN, replies.recv()).await {
        let key = reply.robot.clone().unwrap_or_default().into_bytes();
        let value = reply.to_json().into_bytes();
        let partition = &answers[partition_of(&key, answers.len())];
        let record = Record {
            key: Some(key),
            value: Some(value),
            headers: BTreeMap::new(),
            timestamp: SystemTime::now().into(),
        };
        match partition.produce(vec![record], Compression::NoCompression).await {
            Err(Error::ServerError { protocol_error: ProtocolError::MessageTooLarge, .. }) => {
                tracing::warn!(
                    "a reply was dropped: the broker does not accept messages of this length"
                );
            }
            sent => drop(sent?),
        }
    }
    Ok(())
}
