//! Where the server listens, and who may come.

use std::{collections::BTreeMap, net::SocketAddr, path::PathBuf};

use iiwa_kin::{Load, Robot};

use iiwa_bridge::Credentials;

/// How clients reach the server.
#[derive(Clone, Debug)]
pub struct OpcUaOptions {
    /// The address to listen at; with port 0, the system chooses one. OPC UA's own is 4840.
    pub listen: SocketAddr,
    /// The name that clients call this computer by; `None` for its host name, or the address if that is a particular one.
    pub host: Option<String>,
    /// The folder of certificates; it is made if it does not exist.
    pub certificates: PathBuf,
    /// Files of clients' certificates to trust, in DER or PEM, beside those that the folder has.
    pub trusted: Vec<PathBuf>,
    /// Who may read, and stop robots if that is allowed.
    pub users: Vec<Credentials>,
    /// Whether clients may read without a user's name, if their certificates are trusted.
    pub anonymous: bool,
    /// Whether clients may read without a certificate and without a name, by messages that are neither signed nor
    /// encrypted.
    pub unsecured: bool,
    /// The arms of robots, by the robots' names. Those that are not named are LBR iiwa 7 R800, with a load that is not known.
    pub arms: BTreeMap<String, BridgedArm>,
}

/// What is known of an arm before it is heard of.
#[derive(Clone, Debug, Default)]
pub struct BridgedArm {
    /// Its model: limits are taken from it.
    pub model: Robot,
    /// What hangs on its flange, if it is known.
    pub load: Option<Load>,
}
