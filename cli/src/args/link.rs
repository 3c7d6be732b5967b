//! Commands about the connection to a robot.

use std::{net::SocketAddr, path::PathBuf};

use clap::{Args, Subcommand};
use iiwa_link::{message::IoValue, security::Endpoint};

use super::{
    addresses::{ClientKeys, DRIVE, DriveAddress, STREAM, ServerKeys},
    values::{at_least_0, io_value, noise, percent, percent_above_zero, period, seven, speed},
};

/// Make keys for connections that leave this machine: NAME.key, which is secret, and NAME.pub.
///
/// Each side makes its own, and gives its .pub file to the other one. Existing files are never
/// overwritten. `zmq.auth.load_certificate` of pyzmq reads them, too.
#[derive(Args, Debug)]
pub(crate) struct Keygen {
    /// Whose keys they are, as `drive` or `alice`; clients are called by this in the drive's log
    #[arg(value_name = "NAME")]
    pub(crate) name: String,

    /// Folder for the two files, made if there is none [default: the current folder]
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: Option<PathBuf>,
}

/// Connect clients with the robot: iiwaDrive.
///
/// It answers the controller over FRI every cycle, publishes where the robot is, and runs motions and
/// trajectories for clients, one at a time. Clients are `iiwasim run`, `record`, `status`, `io` and
/// `sensors`, or programs in any language that speak ZeroMQ and JSON. It ends with Ctrl-C; a motion goes
/// on then, a trajectory breaks off.
///
/// Without keys it listens to this machine only.
#[derive(Args, Debug)]
pub(crate) struct Drive {
    /// Where clients send requests to
    #[arg(long, value_name = "HOST:PORT", default_value = DRIVE)]
    pub(crate) instructions: Endpoint,

    /// Where clients subscribe to what is measured
    #[arg(long, value_name = "HOST:PORT", default_value = STREAM)]
    pub(crate) stream: Endpoint,

    /// Where the controller's FRI messages come in, over UDP; KUKA's ports are 30200 to 30209
    #[arg(long, value_name = "IP:PORT", default_value = "127.0.0.1:30200")]
    pub(crate) fri: SocketAddr,

    /// The cabinet's address: the robot program's, and the only one whose FRI messages are taken
    #[arg(long, value_name = "HOST", default_value = "127.0.0.1")]
    pub(crate) cabinet: String,

    /// Port at which the robot program takes instructions
    #[arg(long, value_name = "PORT", default_value_t = iiwa_drive::CABINET_INSTRUCTIONS_PORT)]
    pub(crate) cabinet_instructions: u16,

    /// Port at which the robot program tells its state
    #[arg(long, value_name = "PORT", default_value_t = iiwa_drive::CABINET_STATE_PORT)]
    pub(crate) cabinet_state: u16,

    /// Built-in model or robot profile; trajectories are held against its limits
    #[arg(long, value_name = "NAME|FILE", default_value = "lbr_iiwa_7_r800")]
    pub(crate) robot: String,

    #[command(flatten)]
    pub(crate) keys: ServerKeys,

    /// The cabinet's public key, if it asks for keys; this drive shows its own (--key)
    #[arg(long, value_name = "FILE.pub", requires = "key")]
    pub(crate) cabinet_key: Option<PathBuf>,
}

/// Simulate the robot and its cabinet: what `iiwasim drive` connects to.
///
/// A controller with FRI in real time and a robot program that runs motions as this project plans them,
/// sensors, inputs and outputs. It ends with Ctrl-C, and says how fast it was answered.
#[derive(Args, Debug)]
pub(crate) struct Cabinet {
    /// Time from one message of FRI to the next, in ms: 1 to 10 to be commanded, up to 100 to be watched
    #[arg(long, value_name = "MS", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=100))]
    pub(crate) period: u32,

    /// Every how many messages the drive is to answer
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10))]
    pub(crate) receive_multiplier: u32,

    /// How many times as fast as real time the robot's clock goes, 0.01 to 100
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = speed)]
    pub(crate) speed: f64,

    /// Standard deviation of measured joint positions, in rad
    #[arg(long, value_name = "RAD", default_value_t = 0.0, value_parser = noise)]
    pub(crate) noise: f64,

    /// Built-in model or robot profile
    #[arg(long, value_name = "NAME|FILE", default_value = "lbr_iiwa_7_r800")]
    pub(crate) robot: String,

    /// Where the arm stands first: joints A1 to A7 in degrees [default: all 0]
    #[arg(long, value_name = "A1,...,A7", value_parser = seven, allow_hyphen_values = true)]
    pub(crate) start_deg: Option<[f64; 7]>,

    /// Where the drive listens to FRI, over UDP
    #[arg(long, value_name = "IP:PORT", default_value = "127.0.0.1:30200")]
    pub(crate) fri: SocketAddr,

    /// Where the robot program takes instructions
    #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:30001")]
    pub(crate) instructions: Endpoint,

    /// Where the robot program tells its state
    #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:30002")]
    pub(crate) state: Endpoint,

    #[command(flatten)]
    pub(crate) keys: ServerKeys,

    #[command(flatten)]
    pub(crate) faults: CabinetFaults,
}

/// What goes wrong.
#[derive(Args, Debug)]
#[command(next_help_heading = "Faults")]
pub(crate) struct CabinetFaults {
    /// Lose so many of FRI's messages, in per cent, in either direction
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0, value_parser = percent)]
    pub(crate) packet_loss: f64,

    /// Send FRI's messages so many cycles late
    #[arg(long, value_name = "CYCLES", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=100))]
    pub(crate) delay: u32,

    /// Let nothing of FRI through for a second, so many seconds after the start, and again after the
    /// same time
    #[arg(long, value_name = "S", value_parser = period)]
    pub(crate) silence_every: Option<f64>,

    /// Drop the session of FRI for a second, so many seconds after the start, and again after the same
    /// time
    #[arg(long, value_name = "S", value_parser = period)]
    pub(crate) drop_session_every: Option<f64>,

    /// Press the emergency stop once, at this part of a run of motions, in per cent; it is released after
    /// two seconds
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    pub(crate) emergency_stop: Option<f64>,
}

/// Run a motion program on the robot, and hold the time it takes against the plan.
///
/// The program is planned first and the figures are shown. Then the drive runs it, and what the robot did
/// is written as MCAP. Ctrl-C stops the robot on its path; what it did until then is written too.
#[derive(Args, Debug)]
pub(crate) struct Run {
    /// Motion program in JSON (`iiwasim schema` describes it); - reads standard input
    #[arg(value_name = "PROGRAM.json")]
    pub(crate) program: PathBuf,

    /// Where the MCAP file of what the robot did goes [default: PROGRAM.measured.mcap in the current
    /// folder]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    /// Write no file
    #[arg(long, conflicts_with = "output")]
    pub(crate) no_output: bool,

    /// Send the planned trajectory, to be followed over FRI, instead of the motions, which the controller
    /// plans by itself
    #[arg(long)]
    pub(crate) as_trajectory: bool,

    /// First move to the program's start, in a straight line of joint space, at this share of the limits
    /// of velocity, in per cent: 10 where none is given
    #[arg(long, value_name = "PERCENT", num_args = 0..=1, require_equals = true, default_missing_value = "10", value_parser = percent_above_zero)]
    pub(crate) move_to_start: Option<f64>,

    /// Print the figures as one JSON object
    #[arg(long)]
    pub(crate) json: bool,

    /// Built-in model or robot profile, instead of the program's
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    /// Where the drive publishes
    #[arg(long, value_name = "HOST:PORT", default_value = STREAM)]
    pub(crate) stream: Endpoint,

    #[command(flatten)]
    pub(crate) drive: DriveAddress,
}

/// Record what the robot does as MCAP, until Ctrl-C.
///
/// The file is whole at any time: if the recorder is killed, the last second is lost at most.
#[derive(Args, Debug)]
pub(crate) struct Record {
    /// Where the MCAP file goes; an existing one is not overwritten
    #[arg(short, long, value_name = "FILE.mcap")]
    pub(crate) output: PathBuf,

    /// End after so many seconds
    #[arg(long, value_name = "S", value_parser = at_least_0)]
    pub(crate) seconds: Option<f64>,

    /// Built-in model or robot profile that the file's link frames are those of
    #[arg(long, value_name = "NAME|FILE", default_value = "lbr_iiwa_7_r800")]
    pub(crate) robot: String,

    /// Where the drive publishes
    #[arg(long, value_name = "HOST:PORT", default_value = STREAM)]
    pub(crate) stream: Endpoint,

    #[command(flatten)]
    pub(crate) keys: ClientKeys,
}

/// Stop the robot on its path, whoever made it move, and wait until it stands.
///
/// This is no emergency stop: it needs the network, the drive and the robot program.
#[derive(Args, Debug)]
pub(crate) struct Stop {
    #[command(flatten)]
    pub(crate) drive: DriveAddress,
}

/// Print what the robot does now, where it is, and how the connection to it is.
#[derive(Args, Debug)]
pub(crate) struct Status {
    /// Print one JSON object: `state`, `joints_rad`, `t_s`, `fri`, `robot_program`
    #[arg(long)]
    pub(crate) json: bool,

    /// Follow the robot until Ctrl-C: a line five times a second; with --json, every message of the
    /// stream as it comes
    #[arg(long)]
    pub(crate) watch: bool,

    /// Where the drive publishes
    #[arg(long, value_name = "HOST:PORT", default_value = STREAM)]
    pub(crate) stream: Endpoint,

    #[command(flatten)]
    pub(crate) drive: DriveAddress,
}

/// Read the robot's sensors: temperatures of the joints, torques from outside.
#[derive(Args, Debug)]
pub(crate) struct Sensors {
    /// Print one JSON object: `joint_temperature_c`, `external_torque_nm`
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) drive: DriveAddress,
}

/// Read inputs and outputs of the robot, and set outputs.
#[derive(Args, Debug)]
pub(crate) struct Io {
    #[command(subcommand)]
    pub(crate) action: IoAction,
}

#[derive(Debug, Subcommand)]
pub(crate) enum IoAction {
    /// Print the value of an input or output
    Get {
        /// Its name, as MediaFlange.UserButton
        name: String,

        #[command(flatten)]
        drive: DriveAddress,
    },
    /// Set an output, and print what it is then
    Set {
        /// Its name, as MediaFlange.LEDBlue
        name: String,

        /// true, false or a number
        #[arg(value_parser = io_value, allow_hyphen_values = true)]
        value: IoValue,

        #[command(flatten)]
        drive: DriveAddress,
    },
}
