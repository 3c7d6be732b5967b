//! Errors of writing and reading recordings.

use std::io;
use std::time::Duration;

use crate::Topic;

/// Reason why a recording could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The stream or the container failed.
    #[error("cannot write the MCAP file")]
    Mcap {
        /// Error of the container.
        #[source]
        source: mcap::McapError,
    },
    /// A message could not be encoded.
    #[error("cannot encode a message for {topic}")]
    Encode {
        /// The topic of the message.
        topic: Topic,
        /// Error of the encoder.
        #[source]
        source: cdr_encoding::Error,
    },
    /// A stamp that is not later than the one before it on the same topic.
    #[error("{topic} at {t:?} after {previous:?}: stamps must increase")]
    NotIncreasing {
        /// The topic.
        topic: Topic,
        /// Rejected time.
        t: Duration,
        /// Time of the stamp before.
        previous: Duration,
    },
    /// A stamp that does not fit into a ROS 2 time, which ends in 2038.
    #[error("{topic} at {t:?} after an epoch of {epoch:?} since 1970 is past the year 2038")]
    StampOutOfRange {
        /// The topic.
        topic: Topic,
        /// Time since the epoch.
        t: Duration,
        /// The epoch, since 1970.
        epoch: Duration,
    },
    /// An epoch that does not fit into a ROS 2 time.
    #[error("an epoch of {epoch:?} since 1970 is past the year 2038")]
    EpochOutOfRange {
        /// The epoch, since 1970.
        epoch: Duration,
    },
    /// A limiting joint that the robot does not have.
    #[error("limiting joint {joint} at {t:?}: the joints are 1 to 7")]
    NoSuchJoint {
        /// Rejected joint.
        joint: u8,
        /// The time of the motion.
        t: Duration,
    },
    /// More points than a message can count.
    #[error("a joint trajectory holds at most {} points", u32::MAX)]
    TooManyPoints,
}

impl From<mcap::McapError> for WriteError {
    fn from(source: mcap::McapError) -> Self {
        Self::Mcap { source }
    }
}

/// Reason why a recording could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The stream failed.
    #[error("reading failed after {offset} bytes")]
    Io {
        /// Bytes read so far.
        offset: u64,
        /// Error of the stream.
        #[source]
        source: io::Error,
    },
    /// The file ends early, for example because its writer was killed.
    #[error("the file is cut off: it ends after {offset} bytes and {messages} whole messages")]
    Truncated {
        /// Length of the existing part, bytes.
        offset: u64,
        /// Messages read up to there.
        messages: u64,
    },
    /// The file is not an MCAP file, or is damaged.
    #[error(
        "not a sound MCAP file: damaged in its first {offset} bytes, after {messages} messages"
    )]
    Mcap {
        /// Bytes read so far; the damage is before this offset.
        offset: u64,
        /// Messages read so far.
        messages: u64,
        /// Error of the container.
        #[source]
        source: mcap::McapError,
    },
    /// A topic of a recording has another message type.
    #[error("{topic} carries {found}, expected {expected}")]
    WrongType {
        /// The topic.
        topic: Topic,
        /// Type and encodings expected on the topic.
        expected: String,
        /// Type and encodings in the file.
        found: String,
    },
    /// Another MCAP file follows the end of the file.
    #[error("another MCAP file follows the end of this one, and is not read")]
    Concatenated,
    /// Joint states of two robots.
    #[error("joint states of two robots: {first} and {second}; a recording has one of them")]
    TwoArms {
        /// The first topic.
        first: String,
        /// The second topic.
        second: String,
    },
    /// A message that cannot be decoded.
    #[error("{topic} at {t_s} s: {message}")]
    Message {
        /// The topic.
        topic: Topic,
        /// Log time since the first message, s.
        t_s: f64,
        /// Mismatch found.
        message: String,
    },
    /// A joint name differs.
    #[error("{topic} at {t_s} s: joint {index} is `{found}`, expected `{expected}`")]
    JointName {
        /// The topic.
        topic: Topic,
        /// Log time since the first message, s.
        t_s: f64,
        /// Position in the list, from 1.
        index: usize,
        /// Expected name.
        expected: String,
        /// Name found.
        found: String,
    },
    /// A list that does not have one entry per joint.
    #[error("{topic} at {t_s} s: {found} entries in `{field}`, expected 7")]
    JointCount {
        /// The topic.
        topic: Topic,
        /// Log time since the first message, s.
        t_s: f64,
        /// The field of the message.
        field: &'static str,
        /// Number of entries.
        found: usize,
    },
    /// A second message on a topic that has exactly one.
    #[error("{topic} at {t_s} s: a second message, expected one in the file")]
    Repeated {
        /// The topic.
        topic: Topic,
        /// Time since the first message, s.
        t_s: f64,
    },
}
