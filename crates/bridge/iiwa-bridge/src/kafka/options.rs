//! Kafka settings.

use std::{path::PathBuf, str::FromStr};

use super::connection::KafkaConnection;
use crate::encoding::JointFormat;

/// Kafka settings.
#[derive(Clone, Debug)]
pub struct KafkaOptions {
    /// The brokers.
    pub connection: KafkaConnection,
    /// Prefix of topic names, before `.joints` and so on.
    pub prefix: String,
    /// Compression of batches.
    pub compression: Compression,
    /// Format of `joints` messages.
    pub joints: JointFormat,
    /// Folder of the spools.
    pub spool: PathBuf,
    /// Maximum total size of the spools, in bytes.
    pub spool_bytes: u64,
}

/// Compression of batches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compression {
    /// No compression.
    None,
    /// Snappy: fast.
    #[default]
    Snappy,
    /// Gzip: small.
    Gzip,
}

impl FromStr for Compression {
    type Err = ();

    /// Parses the name: `none`, `snappy` or `gzip`.
    fn from_str(name: &str) -> Result<Self, ()> {
        match name {
            "none" => Ok(Self::None),
            "snappy" => Ok(Self::Snappy),
            "gzip" => Ok(Self::Gzip),
            _ => Err(()),
        }
    }
}
