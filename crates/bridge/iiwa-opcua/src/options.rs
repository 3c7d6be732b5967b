//! Server settings: address and access.

use std::{collections::BTreeMap, net::SocketAddr, path::PathBuf};

use iiwa_kin::{Load, Robot};

use iiwa_bridge::Credentials;

/// Server settings.
#[derive(Clone, Debug)]
pub struct OpcUaOptions {
    /// The address to listen at; with port 0, the system chooses a port. The default OPC UA port is
    /// 4840.
    pub listen: SocketAddr,
    /// The name under which clients reach this computer; `None` for its host name, or for the
    /// address if it is a specific one.
    pub host: Option<String>,
    /// Certificate folder, which is created if it is missing.
    pub certificates: PathBuf,
    /// Files of client certificates to trust, in DER or PEM, in addition to the trusted ones in the
    /// folder.
    pub trusted: Vec<PathBuf>,
    /// Users, who may read, and stop robots if permitted.
    pub users: Vec<Credentials>,
    /// `true` if clients may read without a user name, if their certificates are trusted.
    pub anonymous: bool,
    /// `true` if clients may read without certificate and user name, by messages that are neither
    /// signed nor encrypted.
    pub unsecured: bool,
    /// Arms by robot name. The default is an LBR iiwa 7 R800 with an unknown load.
    pub arms: BTreeMap<String, BridgedArm>,
}

/// Data of an arm that are known before its first message.
#[derive(Clone, Debug, Default)]
pub struct BridgedArm {
    /// Model, which defines the limits.
    pub model: Robot,
    /// Payload, if known.
    pub load: Option<Load>,
}
