//! Addresses and keys of connections, which several commands take.

use std::path::PathBuf;

use clap::Args;
use iiwa_link::security::Endpoint;

/// Default address for requests to a drive ([`iiwa_link::INSTRUCTIONS_PORT`]).
pub(super) const DRIVE: &str = "127.0.0.1:5560";

/// Default address of the stream of a drive ([`iiwa_link::STREAM_PORT`]).
pub(super) const STREAM: &str = "127.0.0.1:5561";

/// The drive that a command connects to.
#[derive(Args, Debug)]
pub(crate) struct DriveAddress {
    /// Address for requests to the drive
    #[arg(long, value_name = "HOST:PORT", default_value = DRIVE, env = "IIWASIM_DRIVE",
        hide_env = true)]
    pub(crate) drive: Endpoint,

    #[command(flatten)]
    pub(crate) keys: ClientKeys,
}

/// Keys of a client.
#[derive(Args, Clone, Debug)]
pub(crate) struct ClientKeys {
    /// Own key, made by `iiwasim keygen`, for a drive that requires keys
    #[arg(
        long,
        value_name = "FILE.key",
        requires = "server_key",
        env = "IIWASIM_KEY",
        hide_env = true
    )]
    pub(crate) key: Option<PathBuf>,

    /// The drive's public key
    #[arg(
        long,
        value_name = "FILE.pub",
        requires = "key",
        env = "IIWASIM_SERVER_KEY",
        hide_env = true
    )]
    pub(crate) server_key: Option<PathBuf>,
}

/// Keys of a server, for clients on other machines.
#[derive(Args, Debug)]
pub(crate) struct ServerKeys {
    /// Own key, made by `iiwasim keygen`; without a key, only this machine can connect
    #[arg(long, value_name = "FILE.key", requires = "allow")]
    pub(crate) key: Option<PathBuf>,

    /// Public keys of the accepted clients: a file, or a folder of *.pub files
    #[arg(long, value_name = "FOLDER", requires = "key")]
    pub(crate) allow: Option<PathBuf>,
}
