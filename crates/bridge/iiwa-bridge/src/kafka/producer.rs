//! Sends the records of a spool.

use std::{
    collections::{BTreeMap, HashMap},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use chrono::DateTime;
use rskafka::{
    client::{
        Client,
        error::{Error, ProtocolError},
        partition::{Compression as Codec, PartitionClient, UnknownTopicHandling},
    },
    record::Record,
};
use tokio::time::{Instant, sleep, timeout};

use super::{
    connection::{KafkaConnector, KafkaFailure},
    options::Compression,
    partition::partition_of,
    spooled::SpooledRecord,
    topics::topic,
};
use crate::{
    encoding::JointFormat,
    message::Kind,
    spool::SpoolReader,
    spooling::SpoolTarget,
    trouble::{Trouble, until_shutdown},
};

/// Maximum batch size, in records and in bytes: brokers accept 1 MB by default.
const BATCH_RECORDS: usize = 2000;
const BATCH_BYTES: usize = 512 << 10;

/// Time between batches: records accumulate meanwhile, and the mean latency is half of it.
const LINGER: Duration = Duration::from_millis(20);

/// Time-out of the acknowledgement of a batch.
const PRODUCE_TIMEOUT: Duration = Duration::from_secs(8);

/// Pause after a failure.
const PAUSE: Duration = Duration::from_millis(500);

/// Time for which the last records are sent at the end.
const LAST_BATCHES: Duration = Duration::from_secs(2);

/// Partitions and replicas of new topics: the broker's defaults.
const BROKERS_DEFAULT: i8 = -1;

/// Time-out of the broker to create a topic.
const CREATE_MS: i32 = 5000;

/// The task that sends the records of a spool.
pub(super) struct Producer {
    pub(super) connector: Arc<KafkaConnector>,
    pub(super) prefix: String,
    pub(super) compression: Compression,
    pub(super) spool: Arc<SpoolTarget>,
    pub(super) reader: SpoolReader,
}

impl Producer {
    /// Sends until the shutdown, and the remaining records for a short time afterwards.
    pub(super) async fn run(mut self, shutdown: &AtomicBool) {
        let mut trouble = Trouble::default();
        let mut topics = None;
        let mut until = None;
        let mut batch_bytes = BATCH_BYTES;
        loop {
            if shutdown.load(Ordering::Relaxed) {
                let until = *until.get_or_insert_with(|| Instant::now() + LAST_BATCHES);
                let is_empty = self.is_empty();
                if is_empty || Instant::now() >= until {
                    break;
                }
            }
            let began = Instant::now();
            let last = async {
                until_shutdown(shutdown).await;
                sleep(LAST_BATCHES).await;
            };
            let sent = tokio::select! {
                sent = self.send_batch(&mut topics, batch_bytes) => sent,
                () = last => break,
            };
            match sent {
                Ok(0) => {
                    // Wakes up for the first record, or to check for the shutdown.
                    let _ = timeout(Duration::from_millis(100), self.spool.appended()).await;
                }
                Ok(_) => {
                    if trouble.clear() {
                        tracing::info!(
                            "Kafka at {}: messages arrive again",
                            self.connector.address()
                        );
                    }
                    // While batches are small because a larger one was refused, the next batch is
                    // already available.
                    if batch_bytes == BATCH_BYTES {
                        sleep(LINGER.saturating_sub(began.elapsed())).await;
                    }
                    batch_bytes = (2 * batch_bytes).min(BATCH_BYTES);
                }
                Err(failure) if failure.is_too_large && batch_bytes > 1 => {
                    // A batch contains at least one record.
                    self.reader.rewind();
                    batch_bytes /= 2;
                }
                Err(failure) if failure.is_too_large => {
                    // The record would block all later ones.
                    self.leave_out(&failure);
                }
                Err(failure) => {
                    self.reader.rewind();
                    topics = None;
                    trouble.warn(format_args!(
                        "Kafka at {}: {}; messages are kept until it is back",
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

    fn is_empty(&mut self) -> bool {
        let batch = self.reader.batch(self.spool.spool(), 1, 1);
        self.reader.rewind();
        batch.is_ok_and(|batch| batch.is_empty())
    }

    /// Skips the record that was read last.
    fn leave_out(&mut self, failure: &KafkaFailure) {
        let address = self.connector.address();
        tracing::warn!("Kafka at {address}: {}; one message was left out", failure.message);
        self.spool.refused(1);
        if let Err(error) = self.reader.commit(self.spool.spool()) {
            tracing::warn!("cannot save the position in the spool: {error}");
        }
    }

    /// Sends a batch; returns its size.
    async fn send_batch(
        &mut self,
        topics: &mut Option<Topics>,
        batch_bytes: usize,
    ) -> Result<usize, KafkaFailure> {
        let spool = self.spool.spool();
        let wrong = |error: std::io::Error| {
            KafkaFailure::passing(format!("cannot read the spool: {error}"))
        };
        let batch = self.reader.batch(spool, BATCH_RECORDS, batch_bytes).map_err(wrong)?;
        if batch.is_empty() {
            return Ok(0);
        }
        let connected = match topics {
            Some(connected) => connected,
            None => topics.insert(Topics::new(self.connector.connect().await?)),
        };
        let mut by_partition: BTreeMap<(usize, Vec<u8>), Vec<Record>> = BTreeMap::new();
        for record in batch.iter().filter_map(|bytes| SpooledRecord::from_bytes(bytes)) {
            let place = (record.kind.index(), record.key.clone());
            by_partition.entry(place).or_default().push(kafka_record(record));
        }
        let codec = match self.compression {
            Compression::None => Codec::NoCompression,
            Compression::Snappy => Codec::Snappy,
            Compression::Gzip => Codec::Gzip,
        };
        for ((kind, key), records) in by_partition {
            let name = topic(&self.prefix, Kind::ALL[kind].name());
            let partition = connected.partition(&name, &key).await?;
            match timeout(PRODUCE_TIMEOUT, partition.produce(records, codec)).await {
                Ok(Ok(_)) => {}
                Ok(Err(error)) => return Err(KafkaFailure::of(&error)),
                Err(_) => return Err(KafkaFailure::timeout()),
            }
        }
        self.reader.commit(spool).map_err(wrong)?;
        Ok(batch.len())
    }
}

fn kafka_record(record: SpooledRecord) -> Record {
    let SpooledRecord { at_micros, session, seq, key, value, .. } = record;
    // Headers identify messages that are not JSON.
    let headers = if JointFormat::is_json(&value) {
        BTreeMap::new()
    } else {
        let headers = [("session", session), ("seq", seq)];
        headers.map(|(name, number)| (name.to_owned(), number.to_string().into_bytes())).into()
    };
    let micros = i64::try_from(at_micros).unwrap_or(i64::MAX);
    let timestamp = DateTime::from_timestamp_micros(micros).unwrap_or_default();
    Record { key: Some(key), value: Some(value), headers, timestamp }
}

/// A connection, and the partitions in use.
struct Topics {
    client: Client,
    partitions: HashMap<String, Vec<Arc<PartitionClient>>>,
}

impl Topics {
    fn new(client: Client) -> Self {
        Self { client, partitions: HashMap::new() }
    }

    /// Returns the partition of a key. A missing topic is created.
    async fn partition(
        &mut self,
        name: &str,
        key: &[u8],
    ) -> Result<Arc<PartitionClient>, KafkaFailure> {
        if !self.partitions.contains_key(name) {
            let partitions = timeout(PRODUCE_TIMEOUT, self.open(name));
            let partitions = partitions.await.map_err(|_| KafkaFailure::timeout())?;
            let partitions = partitions.map_err(|error| KafkaFailure::of(&error))?;
            self.partitions.insert(name.to_owned(), partitions);
        }
        let partitions = &self.partitions[name];
        Ok(Arc::clone(&partitions[partition_of(key, partitions.len())]))
    }

    async fn open(&self, name: &str) -> Result<Vec<Arc<PartitionClient>>, Error> {
        let count = partitions_of(&self.client, name).await?;
        let mut partitions = Vec::new();
        for partition in 0..count {
            let retry = UnknownTopicHandling::Retry;
            let client = self.client.partition_client(name, partition, retry).await?;
            partitions.push(Arc::new(client));
        }
        Ok(partitions)
    }
}

/// Returns the number of partitions of a topic. A missing topic is created.
pub(super) async fn partitions_of(client: &Client, name: &str) -> Result<i32, Error> {
    let mut created = false;
    loop {
        let topics = client.list_topics().await?;
        if let Some(metadata) = topics.iter().find(|topic| topic.name == name)
            && !metadata.partitions.is_empty()
        {
            return Ok(i32::try_from(metadata.partitions.len()).unwrap_or(i32::MAX));
        }
        if !created {
            let controller = client.controller_client()?;
            let default = BROKERS_DEFAULT;
            match controller.create_topic(name, default.into(), default.into(), CREATE_MS).await {
                Ok(()) => tracing::info!("created the topic {name}"),
                Err(Error::ServerError {
                    protocol_error: ProtocolError::TopicAlreadyExists,
                    ..
                }) => {}
                Err(error) => return Err(error),
            }
            created = true;
        }
        // Brokers learn of the new topic one after the other.
        sleep(Duration::from_millis(50)).await;
    }
}
