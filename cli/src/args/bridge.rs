//! `iiwasim bridge`.

use std::{path::PathBuf, str::FromStr};

use clap::Args;
use iiwa_link::security::Endpoint;

use super::{
    addresses::{DriveAddress, STREAM},
    broker_access::{KafkaAccess, MqttAccess},
    values::{at_least_0, whole},
};

/// Publish robot data to Kafka, MQTT and Sparkplug, and optionally accept commands from them.
///
/// The bridge is a client of the drive. Joints, states, runs with planned and measured times,
/// inputs and outputs, sensors and conditions become messages, with the same JSON for all brokers
/// (`iiwasim schema bridge`). Messages that a broker does not accept are spooled on disk and
/// delivered in order, at least once. The bridge does not listen on any port.
///
/// Commands are accepted from broker topics only with --allow-commands, and pass the same checks of
/// the drive as requests of any client. Ctrl-C ends the bridge; spooled messages are sent the next
/// time.
#[derive(Args, Debug)]
pub(crate) struct Bridge {
    /// Name of the robot, in topics and as message key
    #[arg(long, value_name = "NAME", default_value = "iiwa")]
    pub(crate) name: String,

    /// Another robot: name, drive address and stream address; may be given more than once
    #[arg(long = "add", value_name = "NAME=HOST:PORT,HOST:PORT")]
    pub(crate) others: Vec<OtherRobot>,

    /// Accept commands: run, stop, set outputs. Anyone who can publish to the request topics can
    /// then move the robot
    #[arg(long)]
    pub(crate) allow_commands: bool,

    /// Folder for undelivered messages [default: iiwasim/spool in the user's state folder]
    #[arg(long, value_name = "FOLDER")]
    pub(crate) spool: Option<PathBuf>,

    /// Spool size per broker in MB: one hour of joints at 1 kHz needs 1200. If the spool is full,
    /// the oldest messages are dropped
    #[arg(long, value_name = "MB", default_value_t = 1024,
        value_parser = whole::<u64, 64, 1_000_000>)]
    pub(crate) spool_mb: u64,

    /// Format of joint messages; all other messages are JSON. `cdr` is ROS 2
    /// `sensor_msgs/JointState`
    #[arg(long, value_name = "FORMAT", default_value = "json",
        value_parser = ["json", "cdr", "protobuf"])]
    pub(crate) joints: String,

    #[command(flatten)]
    pub(crate) kafka: Kafka,

    #[command(flatten)]
    pub(crate) mqtt: Mqtt,

    #[cfg(feature = "ros2")]
    #[command(flatten)]
    pub(crate) ros2: super::Ros2,

    #[cfg(feature = "opcua")]
    #[command(flatten)]
    pub(crate) opcua: super::OpcUa,

    /// Built-in model or robot profile of the robots, for their description and limits
    #[cfg(any(feature = "ros2", feature = "opcua"))]
    #[arg(long, value_name = "NAME|FILE", default_value = "lbr_iiwa_7_r800")]
    pub(crate) robot: String,

    /// Address at which the drive sends joint positions and its state
    #[arg(long, value_name = "HOST:PORT", default_value = STREAM, env = "IIWASIM_STREAM",
        hide_env = true)]
    pub(crate) stream: Endpoint,

    #[command(flatten)]
    pub(crate) drive: DriveAddress,
}

/// Kafka.
#[derive(Args, Debug)]
#[command(next_help_heading = "Kafka")]
pub(crate) struct Kafka {
    /// Send to Kafka: one or more brokers to begin with
    #[arg(long = "kafka", value_name = "HOST:PORT", value_delimiter = ',', value_parser = address)]
    pub(crate) brokers: Vec<String>,

    #[command(flatten)]
    pub(crate) access: KafkaAccess,

    /// Compression of batches
    #[arg(
        long = "kafka-compression",
        value_name = "NAME",
        default_value = "snappy", value_parser = ["none", "snappy", "gzip"],
        requires = "brokers"
    )]
    pub(crate) compression: String,
}

/// MQTT.
#[derive(Args, Debug)]
#[command(next_help_heading = "MQTT")]
pub(crate) struct Mqtt {
    /// Send to an MQTT broker
    #[arg(long = "mqtt", value_name = "HOST:PORT", value_parser = address)]
    pub(crate) broker: Option<String>,

    /// Version of the protocol: 3 (3.1.1) or 5
    #[arg(long = "mqtt-version", value_name = "N", default_value_t = 5,
        value_parser = whole::<u8, 3, 5>)]
    pub(crate) version: u8,

    /// Maximum number of joint messages per second and robot; 0 for all
    #[arg(long = "mqtt-rate", value_name = "HZ", default_value_t = 10.0, value_parser = at_least_0)]
    pub(crate) rate: f64,

    /// Prefix of the connection names: two bridges at one broker need different prefixes
    #[arg(long = "mqtt-client", value_name = "TEXT", default_value = "iiwasim")]
    pub(crate) client: String,

    #[command(flatten)]
    pub(crate) access: MqttAccess,

    /// Also be an edge node of Sparkplug B, with the robots as devices, in this group
    #[arg(long, value_name = "GROUP", num_args = 0..=1, require_equals = true,
        default_missing_value = "iiwasim", requires = "broker")]
    pub(crate) sparkplug: Option<String>,
}

/// A robot in addition to that of `--drive`.
#[derive(Clone, Debug)]
pub(crate) struct OtherRobot {
    pub(crate) name: String,
    pub(crate) drive: Endpoint,
    pub(crate) stream: Endpoint,
}

impl FromStr for OtherRobot {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let form = "the form is NAME=HOST:PORT,HOST:PORT, with the addresses of drive and stream";
        let (name, addresses) = text.split_once('=').ok_or(form)?;
        let (drive, stream) = addresses.split_once(',').ok_or(form)?;
        let address = |text: &str| text.parse().map_err(|error| format!("`{text}`: {error}"));
        Ok(Self { name: name.to_owned(), drive: address(drive)?, stream: address(stream)? })
    }
}

/// A host and a port.
pub(super) fn address(text: &str) -> Result<String, String> {
    let form = || "the form is HOST:PORT, without a scheme; IPv6 as [ADDRESS]:PORT".to_owned();
    let (host, port) = text.rsplit_once(':').ok_or_else(form)?;
    let is_address = host.starts_with('[') && host.ends_with(']');
    let is_host = is_address || !host.is_empty() && !host.contains([':', '/']);
    match port.parse::<u16>() {
        Ok(port) if port > 0 && is_host => Ok(text.to_owned()),
        _ => Err(form()),
    }
}
