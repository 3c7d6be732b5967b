//! OPC UA of `iiwasim bridge`.

use std::{net::SocketAddr, path::PathBuf};

use clap::Args;

/// OPC UA.
#[derive(Args, Debug)]
#[command(next_help_heading = "OPC UA")]
pub(crate) struct OpcUa {
    /// Serve OPC UA for Robotics at this address; clients need a certificate that is trusted, and a user's password
    #[arg(id = "opcua_listen", long = "opcua", value_name = "IP:PORT")]
    pub(crate) listen: Option<SocketAddr>,

    /// Folder of certificates: the own one, made at the first start, those that are trusted, those that were rejected [default:
    /// iiwasim/opcua in the user's folder for states]
    #[arg(long = "opcua-certificates", value_name = "FOLDER", requires = "opcua_listen")]
    pub(crate) certificates: Option<PathBuf>,

    /// Certificate of a client to trust, in DER or PEM; may be given more than once
    #[arg(long = "opcua-trust", value_name = "FILE", requires = "opcua_listen")]
    pub(crate) trusted: Vec<PathBuf>,

    /// Name that clients call this computer by [default: its host name]
    #[arg(long = "opcua-host", value_name = "NAME", requires = "opcua_listen")]
    pub(crate) host: Option<String>,

    /// User
    #[arg(id = "opcua_user", long = "opcua-user", value_name = "NAME", requires_all = ["opcua_listen", "opcua_password_file"])]
    pub(crate) user: Option<String>,

    /// File with the user's password
    #[arg(
        id = "opcua_password_file",
        long = "opcua-password-file",
        value_name = "FILE",
        requires = "opcua_user"
    )]
    pub(crate) password_file: Option<PathBuf>,

    /// Let clients with trusted certificates read without a user
    #[arg(long = "opcua-anonymous", requires = "opcua_listen")]
    pub(crate) anonymous: bool,

    /// Let everyone read, by messages that are neither signed nor encrypted
    #[arg(long = "opcua-unsecured", requires = "opcua_listen")]
    pub(crate) unsecured: bool,
}
