//! Apache Kafka: one topic per message kind, with the robot as key.
//!
//! Records are spooled first, and sent in batches by one task, in order and at least once: after a
//! lost acknowledgement the batch is sent again. Consumers detect duplicates by `session` and
//! `seq`, which increase monotonically. Samples have a separate spool, so that they do not displace
//! events while the broker is unavailable for long.

mod connection;
mod options;
mod partition;
mod producer;
pub mod reader;
mod requests;
mod spooled;
mod topics;

use std::sync::Arc;

pub use connection::{KafkaConnection, Sasl};
use iiwa_link::threads::ThreadGroup;
pub use options::{Compression, KafkaOptions};
use producer::Producer;
use spooled::SpooledRecord;

use crate::{
    BridgeError,
    commands::CommandGate,
    encoding::JointFormat,
    message::{Kind, Message},
    sink::Sink,
    spool::Level,
    spooling::SpoolTarget,
};

/// Share of the spools for samples; events are rare.
const SAMPLES_SHARE: u64 = 15;
const SHARES: u64 = 16;

/// Sends messages to Kafka, and receives commands.
#[derive(Debug)]
pub struct Kafka {
    samples: Arc<SpoolTarget>,
    events: Arc<SpoolTarget>,
    joints: JointFormat,
    _threads: ThreadGroup,
}

impl Kafka {
    /// Starts sending, once the brokers are found; `gate` receives the commands of the request
    /// topic.
    ///
    /// # Errors
    ///
    /// A file cannot be used, the settings contradict each other, or the broker refuses the user.
    /// An unreachable broker is retried.
    pub fn start(options: &KafkaOptions, gate: Arc<CommandGate>) -> Result<Self, BridgeError> {
        let connector = Arc::new(options.connection.connector()?);
        let runtime = crate::runtime()?;
        runtime.block_on(connector.probe())?;
        drop(runtime);
        let open = |name: &str, share: u64| {
            SpoolTarget::open(&options.spool.join(name), options.spool_bytes * share / SHARES)
        };
        let (samples, samples_out) = open("samples", SAMPLES_SHARE)?;
        let (events, events_out) = open("events", SHARES - SAMPLES_SHARE)?;
        let mut threads = ThreadGroup::default();
        for (target, reader) in [(&samples, samples_out), (&events, events_out)] {
            let producer = Producer {
                connector: Arc::clone(&connector),
                prefix: options.prefix.clone(),
                compression: options.compression,
                spool: Arc::clone(target),
                reader,
            };
            let runtime = crate::runtime()?;
            threads.spawn("bridge kafka", move |shutdown| {
                runtime.block_on(producer.run(shutdown));
            })?;
        }
        let runtime = crate::runtime()?;
        let prefix = options.prefix.clone();
        threads.spawn("bridge kafka requests", move |shutdown| {
            runtime.block_on(requests::serve(&connector, &prefix, &gate, shutdown));
        })?;
        Ok(Self { samples, events, joints: options.joints, _threads: threads })
    }

    /// Returns the total level of the spools.
    #[must_use]
    pub fn level(&self) -> Level {
        let [samples, events] = [self.samples.level(), self.events.level()];
        Level { bytes: samples.bytes + events.bytes, dropped: samples.dropped + events.dropped }
    }
}

impl Sink for Kafka {
    fn take(&self, message: &Message) {
        let record = SpooledRecord::of(message, self.joints).to_bytes();
        match message.kind() {
            Kind::Joints => self.samples.append(&record),
            _ => self.events.append_now(&record),
        }
    }
}
