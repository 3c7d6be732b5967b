//! OPC UA of `iiwasim bridge`.

use std::{net::SocketAddr, path::PathBuf};

use clap::Args;

/// OPC UA.
#[derive(Args, Debug)]
#[command(next_help_heading = "OPC UA")]
pub(crate) struct OpcUa {
    /// Serve OPC UA for Robotics at this address; clients need a trusted certificate and a password
    #[arg(id = "opcua_listen", long = "opcua", value_name = "IP:PORT")]
    pub(crate) listen: Option<SocketAddr>,

    /// Certificate folder: own certificate (made at the first start), trusted and rejected
    /// certificates [default: iiwasim/opcua in the user's state folder]
    #[arg(long = "opcua-certificates", value_name = "FOLDER", requires = "opcua_listen")]
    pub(crate) certificates: Option<PathBuf>,

    /// Client certificate to trust, in DER or PEM; may be given more than once
    #[arg(long = "opcua-trust", value_name = "FILE", requires = "opcua_listen")]
    pub(crate) trusted: Vec<PathBuf>,

    /// Name of this computer for clients [default: its host name]
    #[arg(long = "opcua-host", value_name = "NAME", requires = "opcua_listen")]
    pub(crate) host: Option<String>,

    /// User
    #[arg(id = "opcua_user", long = "opcua-user", value_name = "NAME",
        requires_all = ["opcua_listen", "opcua_password_file"])]
    pub(crate) user: Option<String>,

    /// File with the user's password
    #[arg(
        id = "opcua_password_file",
        long = "opcua-password-file",
        value_name = "FILE",
        requires = "opcua_user"
    )]
    pub(crate) password_file: Option<PathBuf>,

    /// Allow clients with trusted certificates to read without a user
    #[arg(long = "opcua-anonymous", requires = "opcua_listen")]
    pub(crate) anonymous: bool,

    /// Allow everyone to read, with messages that are neither signed nor encrypted
    #[arg(long = "opcua-unsecured", requires = "opcua_listen")]
    pub(crate) unsecured: bool,
}
