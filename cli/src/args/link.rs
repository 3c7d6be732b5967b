//! Commands about the connection to a robot.

use std::path::PathBuf;

use clap::Args;

use super::EXIT_CODES;

/// Make keys for connections that leave this machine: NAME.key, which is secret, and NAME.pub.
///
/// Each side makes its own, and gives its .pub file to the other one. Existing files are never
/// overwritten. `zmq.auth.load_certificate` of pyzmq reads them, too.
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct Keygen {
    /// Whose keys they are, as `drive` or `alice`; clients are called by this in the drive's log
    #[arg(value_name = "NAME")]
    pub(crate) name: String,

    /// Folder for the two files, made if there is none [default: the current folder]
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: Option<PathBuf>,
}
