//! Commands of the connection to a robot.

use std::{
    net::{IpAddr, SocketAddr},
    path::PathBuf,
    time::Duration,
};

use clap::{Args, Subcommand};
use iiwa_kin::{Load, Mount};
use iiwa_link::{message::IoValue, security::Endpoint};

use super::{
    RosNaming,
    addresses::{DRIVE, DriveAddress, STREAM, ServerKeys},
    robot_values::{io_value, lag, noise, percent, percent_above_zero, period, signal, speed},
    values::{at_least_0, epoch, seven, whole},
};

/// Make keys for connections between machines: NAME.key (secret) and NAME.pub.
///
/// Each side makes its own keys and gives its .pub file to the other side. Existing files are never
/// overwritten. `zmq.auth.load_certificate` of pyzmq can read them.
#[derive(Args, Debug)]
pub(crate) struct Keygen {
    /// Name of the owner, such as `drive` or `alice`; the drive log names clients by it
    #[arg(value_name = "NAME")]
    pub(crate) name: String,

    /// Folder for the two files, created if missing [default: the current folder]
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: Option<PathBuf>,
}

/// Run iiwaDrive, which connects clients to the robot.
///
/// It answers the controller over FRI every cycle, publishes the joint positions, and runs motions
/// and trajectories for clients, one at a time. Clients are `iiwasim run`, `record`, `status`, `io`
/// and `sensors`, or programs in any language with ZeroMQ and JSON. Ctrl-C ends it; a motion then
/// continues, a trajectory breaks off.
///
/// Without keys it accepts connections from this machine only.
#[derive(Args, Debug)]
pub(crate) struct Drive {
    /// Address for requests of clients
    #[arg(long, value_name = "HOST:PORT", default_value = DRIVE)]
    pub(crate) instructions: Endpoint,

    /// Address of the stream of measured joint positions
    #[arg(long, value_name = "HOST:PORT", default_value = STREAM)]
    pub(crate) stream: Endpoint,

    /// UDP address for FRI messages of the controller; KUKA's ports are 30200 to 30209
    #[arg(long, value_name = "IP:PORT", default_value = "127.0.0.1:30200")]
    pub(crate) fri: SocketAddr,

    /// Address of the cabinet, on which the robot program runs
    #[arg(long, value_name = "HOST", default_value = "127.0.0.1")]
    pub(crate) cabinet: String,

    /// Source address of FRI messages, such as the KONI port; messages from other addresses are
    /// dropped [default: the address of --cabinet]
    #[arg(long, value_name = "IP")]
    pub(crate) fri_cabinet: Option<IpAddr>,

    /// Port for instructions to the robot program
    #[arg(long, value_name = "PORT", default_value_t = iiwa_link::CABINET_INSTRUCTIONS_PORT)]
    pub(crate) cabinet_instructions: u16,

    /// Port for the state of the robot program
    #[arg(long, value_name = "PORT", default_value_t = iiwa_link::CABINET_STATE_PORT)]
    pub(crate) cabinet_state: u16,

    /// Built-in model or robot profile whose limits trajectories must keep
    #[arg(long, value_name = "NAME|FILE", default_value = "lbr_iiwa_7_r800")]
    pub(crate) robot: String,

    #[command(flatten)]
    pub(crate) keys: ServerKeys,

    /// Public key of the cabinet, if it requires keys; the drive then needs --key as well
    #[arg(long, value_name = "FILE.pub", requires = "key")]
    pub(crate) cabinet_key: Option<PathBuf>,

    /// Check the connection to the cabinet step by step, print results and remedies, and exit. The
    /// robot does not move
    #[arg(long)]
    pub(crate) check: bool,

    /// Print the check as one JSON object: `ok`, `steps`
    #[arg(long, requires = "check")]
    pub(crate) json: bool,
}

/// Simulate the robot and its cabinet, for `iiwasim drive`.
///
/// The simulated controller speaks FRI in real time, and its robot program runs motions as `iiwasim
/// plan` plans them, with sensors, inputs and outputs. Ctrl-C ends the simulation and prints the
/// response latency of the drive.
#[derive(Args, Debug)]
pub(crate) struct Cabinet {
    /// Period of FRI messages, in ms: 1 to 10 to command the robot, up to 100 to monitor it
    #[arg(long, value_name = "MS", default_value_t = 5, value_parser = whole::<u32, 1, 100>)]
    pub(crate) period: u32,

    /// Number of FRI messages per response of the drive
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole::<u32, 1, 10>)]
    pub(crate) receive_multiplier: u32,

    /// Speed of the robot's clock relative to real time, 0.01 to 100
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = speed)]
    pub(crate) speed: f64,

    /// Lag of measured behind commanded joint positions, in ms; without a number 2.4, as on a real
    /// robot
    #[arg(long, value_name = "MS", default_value_t = 0.0, num_args = 0..=1, require_equals = true,
        default_missing_value = "2.4", value_parser = lag)]
    pub(crate) lag: f64,

    /// Standard deviation of measured positions while a joint moves, in rad; without a number 6e-6,
    /// as on a real robot
    #[arg(long, value_name = "RAD", default_value_t = 0.0, num_args = 0..=1, require_equals = true,
        default_missing_value = "6e-6", value_parser = noise)]
    pub(crate) vibration: f64,

    /// Standard deviation of measured joint positions, also at rest, in rad
    #[arg(long, value_name = "RAD", default_value_t = 0.0, value_parser = noise)]
    pub(crate) noise: f64,

    /// Standard deviation of measured torques, in Nm
    #[arg(long, value_name = "NM", default_value_t = 0.0, value_parser = at_least_0)]
    pub(crate) torque_noise: f64,

    /// Payload at the flange, in kg, with its centre of mass in mm, regardless of programs: a
    /// difference from the programmed payload appears as external torque
    #[arg(long, value_name = "KG[,X,Y,Z]", allow_hyphen_values = true)]
    pub(crate) load: Option<Load>,

    /// Orientation of the robot base in degrees, such as 180,0,0 on the ceiling [default: the
    /// program's]
    #[arg(long, value_name = "R,P,Y", allow_hyphen_values = true)]
    pub(crate) mount: Option<Mount>,

    /// Built-in model or robot profile
    #[arg(long, value_name = "NAME|FILE", default_value = "lbr_iiwa_7_r800")]
    pub(crate) robot: String,

    /// Initial joints A1 to A7 in degrees [default: all 0]
    #[arg(long, value_name = "A1,...,A7", value_parser = seven, allow_hyphen_values = true)]
    pub(crate) start_deg: Option<[f64; 7]>,

    /// UDP address at which the drive receives FRI messages
    #[arg(long, value_name = "IP:PORT", default_value = "127.0.0.1:30200")]
    pub(crate) fri: SocketAddr,

    /// Address for instructions to the robot program
    #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:30001")]
    pub(crate) instructions: Endpoint,

    /// Address of the state of the robot program
    #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:30002")]
    pub(crate) state: Endpoint,

    /// Omit data that the robot program of a real cabinet does not have: start and end times of
    /// runs, temperatures
    #[arg(long)]
    pub(crate) without_times: bool,

    #[command(flatten)]
    pub(crate) keys: ServerKeys,

    /// Initial value of an input or output, such as MediaFlange.UserButton=true; repeat for several
    #[arg(long = "signal", value_name = "NAME=VALUE", value_parser = signal)]
    pub(crate) signals: Vec<(String, IoValue)>,

    #[command(flatten)]
    pub(crate) faults: CabinetFaults,
}

/// Injected faults.
#[derive(Args, Debug)]
#[command(next_help_heading = "Faults")]
pub(crate) struct CabinetFaults {
    /// Share of lost FRI messages in either direction, in per cent
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0, value_parser = percent)]
    pub(crate) packet_loss: f64,

    /// Delay of FRI messages, in cycles
    #[arg(long, value_name = "CYCLES", default_value_t = 0, value_parser = whole::<u32, 0, 100>)]
    pub(crate) delay: u32,

    /// Block FRI for a second, with this period, in s
    #[arg(long, value_name = "S", value_parser = period)]
    pub(crate) silence_every: Option<f64>,

    /// Drop the FRI session for a second, with this period, in s
    #[arg(long, value_name = "S", value_parser = period)]
    pub(crate) drop_session_every: Option<f64>,

    /// Press the emergency stop once, when this percentage of the next run has passed, and release
    /// it after two seconds; only for motions that the robot program plans, not for trajectories
    /// over FRI
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    pub(crate) emergency_stop: Option<f64>,
}

/// Run a motion program on the robot, and compare its cycle time with the plan.
///
/// The command needs a running `iiwasim drive` that is connected to the controller; --drive and
/// --stream give its addresses. The program is planned first, and its cycle time, limits and
/// torques are printed. Then the drive runs the program, and the measured joint positions are
/// recorded as MCAP; torques are recorded as `effort` if the controller measures them. Ctrl-C stops
/// the robot on its path; what was recorded until then is kept.
#[derive(Args, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "options are independent")]
pub(crate) struct Run {
    /// Motion program in JSON (`iiwasim schema` describes it), or `-` for standard input
    #[arg(value_name = "PROGRAM.json")]
    pub(crate) program: PathBuf,

    /// Path of the recording [default: PROGRAM.measured.mcap in the current folder, or
    /// PROGRAM.measured-2.mcap and so on if that exists]
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,

    /// Replace an existing recording
    #[arg(long, requires = "output")]
    pub(crate) overwrite: bool,

    /// Write no recording
    #[arg(long, conflicts_with = "output")]
    pub(crate) no_output: bool,

    /// Send the planned trajectory as set-points over FRI, instead of motions that the controller
    /// plans; the plan uses --timing jerk. Use this if the Java program on the controller does not
    /// support a motion of the program
    #[arg(long)]
    pub(crate) as_trajectory: bool,

    /// Scene with obstacles in JSON (`iiwasim schema scene`): the clearance is printed, and if it
    /// is below --min-clearance, the program does not run
    #[arg(long, value_name = "SCENE.json", env = "IIWASIM_SCENE", hide_env = true)]
    pub(crate) scene: Option<PathBuf>,

    /// Smallest allowed distance of the arm to obstacles of --scene, in mm; the motion of
    /// --move-to-start is not checked
    #[arg(long, value_name = "MM", default_value_t = 10.0, value_parser = at_least_0)]
    pub(crate) min_clearance: f64,

    /// First move to the start of the program in a straight line in joint space, at this share of
    /// the velocity limits, in per cent; 10 if no value is given. Without this option, the arm must
    /// be at the start, within 0.5 deg per joint
    #[arg(long, value_name = "PERCENT", num_args = 0..=1, require_equals = true,
        default_missing_value = "10", value_parser = percent_above_zero)]
    pub(crate) move_to_start: Option<f64>,

    /// Print the figures as one JSON object
    #[arg(long)]
    pub(crate) json: bool,

    /// Time stamp of the first sample in the recording, such as 2020-01-01T00:00:00Z; years 1970 to
    /// 2037 [default: the time at which the program starts]
    #[arg(long, value_name = "TIME", value_parser = epoch, conflicts_with = "no_output")]
    pub(crate) epoch: Option<Duration>,

    #[command(flatten)]
    pub(crate) ros: RosNaming,

    /// Built-in model or robot profile, instead of the program's
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    /// Address at which the drive publishes joint positions and its state (`iiwasim drive
    /// --stream`)
    #[arg(long, value_name = "HOST:PORT", default_value = STREAM, env = "IIWASIM_STREAM",
        hide_env = true)]
    pub(crate) stream: Endpoint,

    #[command(flatten)]
    pub(crate) drive: DriveAddress,
}

/// Record the motion of the robot as MCAP, until Ctrl-C.
///
/// The file contains joint positions, joint torques as `effort` if the controller measures them,
/// and the drive state on /diagnostics. It is readable at any time: if the recorder is killed, at
/// most the last second is lost.
#[derive(Args, Debug)]
pub(crate) struct Record {
    /// Path of the MCAP file
    #[arg(short, long, value_name = "FILE.mcap")]
    pub(crate) output: PathBuf,

    /// Replace an existing file
    #[arg(long)]
    pub(crate) overwrite: bool,

    /// Duration in s
    #[arg(long, value_name = "S", value_parser = at_least_0)]
    pub(crate) seconds: Option<f64>,

    /// Also record temperatures, inputs and outputs, once a second while the robot does not move,
    /// as /diagnostics
    #[arg(long)]
    pub(crate) sensors: bool,

    /// First time stamp in the file, from 1970 to 2037, such as 2020-01-01T00:00:00Z [default: now]
    #[arg(long, value_name = "TIME", value_parser = epoch)]
    pub(crate) epoch: Option<Duration>,

    #[command(flatten)]
    pub(crate) ros: RosNaming,

    /// Built-in model or robot profile, for the link frames in the file
    #[arg(long, value_name = "NAME|FILE", default_value = "lbr_iiwa_7_r800")]
    pub(crate) robot: String,

    /// Address at which the drive sends joint positions and its state
    #[arg(long, value_name = "HOST:PORT", default_value = STREAM, env = "IIWASIM_STREAM",
        hide_env = true)]
    pub(crate) stream: Endpoint,

    #[command(flatten)]
    pub(crate) drive: DriveAddress,
}

/// Stop the robot on its path, regardless of the client that moves it, and wait for standstill.
///
/// This is not an emergency stop: it depends on the network, the drive and the robot program.
#[derive(Args, Debug)]
pub(crate) struct Stop {
    #[command(flatten)]
    pub(crate) drive: DriveAddress,
}

/// Print the state of the robot, its joint positions and the quality of the connection.
#[derive(Args, Debug)]
pub(crate) struct Status {
    /// Print one JSON object: `state`, `joints_rad`, `t_s`, `fri`, `robot_program`
    #[arg(long)]
    pub(crate) json: bool,

    /// Follow the robot until Ctrl-C: five lines per second, or with --json all stream messages
    #[arg(long)]
    pub(crate) watch: bool,

    /// Address at which the drive sends joint positions and its state
    #[arg(long, value_name = "HOST:PORT", default_value = STREAM, env = "IIWASIM_STREAM",
        hide_env = true)]
    pub(crate) stream: Endpoint,

    #[command(flatten)]
    pub(crate) drive: DriveAddress,
}

/// Read the robot's sensors: joint temperatures and external torques.
#[derive(Args, Debug)]
pub(crate) struct Sensors {
    /// Print one JSON object: `joint_temperature_c`, `external_torque_nm`
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) drive: DriveAddress,
}

/// Read inputs and outputs of the robot, or set outputs.
#[derive(Args, Debug)]
pub(crate) struct Io {
    #[command(subcommand)]
    pub(crate) action: IoAction,
}

#[derive(Debug, Subcommand)]
pub(crate) enum IoAction {
    /// Print all inputs and outputs with their values
    List {
        /// Print one JSON array of objects: `name`, `direction`, `value`
        #[arg(long)]
        json: bool,

        #[command(flatten)]
        drive: DriveAddress,
    },
    /// Print the value of an input or output
    Get {
        /// Name, such as MediaFlange.UserButton
        name: String,

        #[command(flatten)]
        drive: DriveAddress,
    },
    /// Set an output, and print its new value
    Set {
        /// Name, such as MediaFlange.LEDBlue
        name: String,

        /// true, false or a number
        #[arg(value_parser = io_value, allow_hyphen_values = true)]
        value: IoValue,

        #[command(flatten)]
        drive: DriveAddress,
    },
}
