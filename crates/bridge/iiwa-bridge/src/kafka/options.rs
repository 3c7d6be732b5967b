//! How records reach Kafka.

use std::{path::PathBuf, str::FromStr};

use super::connection::KafkaConnection;
use crate::encoding::JointFormat;

/// How records reach Kafka.
#[derive(Clone, Debug)]
pub struct KafkaOptions {
    /// The brokers.
    pub connection: KafkaConnection,
    /// What names of topics begin with, before `.joints` and so on.
    pub prefix: String,
    /// How batches are compressed.
    pub compression: Compression,
    /// The format of joints.
    pub joints: JointFormat,
    /// Folder of the spools.
    pub spool: PathBuf,
    /// The most that they may hold together, in bytes.
    pub spool_bytes: u64,
}

/// How batches are compressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compression {
    /// Not at all.
    None,
    /// Quickly.
    #[default]
    Snappy,
    /// Small.
    Gzip,
}

impl FromStr for Compression {
    type Err = ();

    /// By its name: `none`, `snappy` or `gzip`.
    fn from_str(name: &str) -> Result<Self, ()> {
        match name {
            "none" => Ok(Self::None),
            "snappy" => Ok(Self::Snappy),
            "gzip" => Ok(Self::Gzip),
            _ => Err(()),
        }
    }
}
