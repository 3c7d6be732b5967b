//! Commands that read what `iiwasim bridge` has written.

use std::{path::PathBuf, time::SystemTime};

use clap::Args;
use iiwa_link::security::Endpoint;

use super::{
    KafkaAccess, RosNaming,
    bridge::address,
    robot_values::speed,
    values::{at_least_0, whole},
};

/// What is read from Kafka.
#[derive(Args, Debug)]
pub(crate) struct Stored {
    /// Brokers of Kafka to begin with
    #[arg(long = "kafka", value_name = "HOST:PORT", value_delimiter = ',', required = true, value_parser = address)]
    pub(crate) brokers: Vec<String>,

    /// Read from this time on, as 2026-11-25T08:00:00Z
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub(crate) from: Option<SystemTime>,

    /// Read what was before this time
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub(crate) until: Option<SystemTime>,

    #[command(flatten)]
    pub(crate) access: KafkaAccess,
}

/// Play a time range back from Kafka: into a recording, or live as a read-only drive.
///
/// A recording (-o) is one as `iiwasim record` makes it: `iiwasim report` shows it, `iiwasim compare` and `identify` read it.
/// With --serve, clients such as `iiwasim twin`, `status --watch` and `record` follow the replay as they follow a drive, at the
/// pace at which it happened.
#[derive(Args, Debug)]
pub(crate) struct Replay {
    /// Name of the robot, as of `iiwasim bridge`
    #[arg(long, value_name = "NAME", default_value = "iiwa")]
    pub(crate) name: String,

    /// Write a recording
    #[arg(short, long, value_name = "FILE.mcap", required_unless_present = "serve")]
    pub(crate) output: Option<PathBuf>,

    /// Replace an existing recording
    #[arg(long, requires = "output")]
    pub(crate) overwrite: bool,

    /// Play back live, for clients of a drive: at --drive and --stream
    #[arg(long, conflicts_with = "output")]
    pub(crate) serve: bool,

    /// How many times as fast as it happened
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = speed, requires = "serve")]
    pub(crate) speed: f64,

    /// Address for requests of clients
    #[arg(long, value_name = "HOST:PORT", default_value = super::addresses::DRIVE, requires = "serve")]
    pub(crate) drive: Endpoint,

    /// Address of the stream
    #[arg(long, value_name = "HOST:PORT", default_value = super::addresses::STREAM, requires = "serve")]
    pub(crate) stream: Endpoint,

    #[command(flatten)]
    pub(crate) ros: RosNaming,

    /// Built-in model or robot profile, for the link frames in the recording
    #[arg(long, value_name = "NAME|FILE", default_value = "lbr_iiwa_7_r800")]
    pub(crate) robot: String,

    #[command(flatten)]
    pub(crate) stored: Stored,
}

/// Print the cycle times of programs over their runs, from Kafka.
///
/// Each program has a row: its runs, the planned and the measured time, and by how much the latest runs take longer than those
/// before. Where runs have a plan, it is the measured over the planned time that drifts, so that an edited program does not.
#[derive(Args, Debug)]
pub(crate) struct History {
    /// This program only
    #[arg(long, value_name = "NAME")]
    pub(crate) program: Option<String>,

    /// This robot only, by its name as of `iiwasim bridge`
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Option<String>,

    /// Number of latest runs to compare with those before
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = whole::<usize, 1, 100_000>)]
    pub(crate) recent: usize,

    /// Exit with code 3 if a program has become slower by more than so much, in per cent
    #[arg(long, value_name = "PERCENT", value_parser = at_least_0)]
    pub(crate) max_drift: Option<f64>,

    /// Print one JSON object with all runs
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) stored: Stored,
}

fn time(text: &str) -> Result<SystemTime, String> {
    humantime::parse_rfc3339_weak(text)
        .map_err(|_| "a time in UTC is needed, as 2026-11-25T08:00:00Z".to_owned())
}
