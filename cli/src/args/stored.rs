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

/// Kafka source and time range.
#[derive(Args, Debug)]
pub(crate) struct Stored {
    /// Kafka bootstrap brokers
    #[arg(long = "kafka", value_name = "HOST:PORT", value_delimiter = ',', required = true,
        value_parser = address)]
    pub(crate) brokers: Vec<String>,

    /// Start of the time range, such as 2026-11-25T08:00:00Z
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub(crate) from: Option<SystemTime>,

    /// End of the time range
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub(crate) until: Option<SystemTime>,

    #[command(flatten)]
    pub(crate) access: KafkaAccess,
}

/// Replay a time range from Kafka: into a recording, or live as a read-only drive.
///
/// A recording (-o) is in the format of `iiwasim record`, for `iiwasim report`, `compare` and
/// `identify`. With --serve, clients such as `iiwasim twin`, `status --watch` and `record` follow
/// the replay at its original pace, as they follow a drive.
#[derive(Args, Debug)]
pub(crate) struct Replay {
    /// Name of the robot, as in `iiwasim bridge --name`
    #[arg(long, value_name = "NAME", default_value = "iiwa")]
    pub(crate) name: String,

    /// Write a recording
    #[arg(short, long, value_name = "FILE.mcap", required_unless_present = "serve")]
    pub(crate) output: Option<PathBuf>,

    /// Replace an existing recording
    #[arg(long, requires = "output")]
    pub(crate) overwrite: bool,

    /// Replay live for drive clients, at --drive and --stream
    #[arg(long, conflicts_with = "output")]
    pub(crate) serve: bool,

    /// Replay speed relative to the original pace
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = speed, requires = "serve")]
    pub(crate) speed: f64,

    /// Address for requests of clients
    #[arg(long, value_name = "HOST:PORT", default_value = super::addresses::DRIVE,
        requires = "serve")]
    pub(crate) drive: Endpoint,

    /// Address of the stream
    #[arg(long, value_name = "HOST:PORT", default_value = super::addresses::STREAM,
        requires = "serve")]
    pub(crate) stream: Endpoint,

    #[command(flatten)]
    pub(crate) ros: RosNaming,

    /// Built-in model or robot profile, for the link frames in the recording
    #[arg(long, value_name = "NAME|FILE", default_value = "lbr_iiwa_7_r800")]
    pub(crate) robot: String,

    #[command(flatten)]
    pub(crate) stored: Stored,
}

/// Print the history of program cycle times from Kafka.
///
/// The table has one row per program: number of runs, planned and measured time, and the change of
/// the latest runs against earlier runs. If runs have a plan, the ratio of measured to planned time
/// is compared, so that an edited program does not count as a change.
#[derive(Args, Debug)]
pub(crate) struct History {
    /// Only this program
    #[arg(long, value_name = "NAME")]
    pub(crate) program: Option<String>,

    /// Only this robot, by its name in `iiwasim bridge`
    #[arg(long, value_name = "NAME")]
    pub(crate) name: Option<String>,

    /// Number of latest runs to compare with earlier runs
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = whole::<usize, 1, 100_000>)]
    pub(crate) recent: usize,

    /// Gate: exit with code 3 if a program has become slower by more than this, in per cent
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
