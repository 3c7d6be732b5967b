//! `iiwasim experiment`.

use std::{path::PathBuf, time::Duration};

use clap::{ArgGroup, Args, ValueEnum};
use iiwa_eval::LoadPlanning;
use iiwa_kin::Load;
use iiwa_link::security::Endpoint;

use super::{
    addresses::{ClientKeys, STREAM},
    robot_values::{noise, percent_above_zero, sampling_rate},
    values::{epoch, whole},
};

/// Repeat an experiment of the thesis (Larsen 2019), or a new one, on the robot or a virtual robot.
///
/// The command makes the programs, runs them, compares the measurements with calculations for
/// --robot, and writes a folder: programs/NAME.json; recordings/NAME.mcap and NAME.csv, for
/// `identify` and `compare`; figure-NN.svg, like those of the thesis; report.md with figures,
/// tables and the results of the thesis.
///
/// --simulate runs the programs on a virtual robot in this process, which plans with velocity,
/// acceleration and jerk limits and is sampled with noise. The virtual robot is the model itself
/// unless --virtual-robot names a profile with other limits, blends (`blend_kappa`,
/// `tcp_blend_kappa`) and settling time (`settle_time_s`). Existing files are replaced.
///
/// --drive runs the programs on the robot behind a drive. THE ARM MOVES FAR: `limits` swings each
/// joint alone from 20 poses, by 20 deg at full speed, and by 70 deg about zero; `blends` moves
/// joints 2 and 4; `settle` and `cycle-time` move all joints in random directions. Before each
/// program the arm moves to the start in a straight line in joint space, which needs
/// --move-to-start. Programs keep the flange 0.1 m above the robot base, or are those of the
/// thesis; they do not consider other obstacles or a tool: the workspace must be free. The range of
/// each joint is printed first. The folder must be new or empty. Ctrl-C stops the robot on its
/// path; earlier recordings are kept.
///
/// `load` shows if the controller plans with the payload: A2 and A4 swing about poses with little
/// and much gravity torque, without a payload and with --load. With --drive, the command asks for
/// the payload to be mounted, and waits for Enter.
///
/// `tcp-blends` shows the controller's blends of TCP paths, and needs a controller that plans TCP
/// paths: the simulated cabinet plans them as iiwasim assumes. If the robot program accepts PTP
/// motions only, program the motions of programs/tcp-blends.json on the controller, record them
/// with `iiwasim record`, and run `iiwasim identify RECORDING --program programs/tcp-blends.json`.
#[derive(Args, Debug)]
#[command(group = ArgGroup::new("on").required(true))]
pub(crate) struct Experiment {
    /// The experiment
    #[arg(value_enum, value_name = "NAME")]
    pub(crate) name: ExperimentName,

    /// Run the programs on a virtual robot
    #[arg(long, group = "on")]
    pub(crate) simulate: bool,

    /// Run the programs on the robot of the drive at this address, such as 127.0.0.1:5560
    #[arg(long, group = "on", value_name = "HOST:PORT", requires = "move_to_start")]
    pub(crate) drive: Option<Endpoint>,

    /// Folder for the files, created if missing [default: experiment-NAME]
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: Option<PathBuf>,

    /// Path of the report, in the folder or above it [default: FOLDER/report.md]
    #[arg(long, value_name = "FILE.md")]
    pub(crate) report: Option<PathBuf>,

    /// Write the report and its figures only, no recordings and programs
    #[arg(long)]
    pub(crate) no_recordings: bool,

    /// First time stamp of recordings, from 1970 to 2037 [default: time of the run on a robot;
    /// 2020-01-01T00:00:00Z on a virtual robot]
    #[arg(long, value_name = "TIME", value_parser = epoch, conflicts_with = "no_recordings")]
    pub(crate) epoch: Option<Duration>,

    /// The model: built in, or a robot profile
    #[arg(long, value_name = "NAME|FILE", default_value = "lbr_iiwa_7_r800")]
    pub(crate) robot: String,

    /// The virtual robot: built in, or a robot profile [default: the model]
    #[arg(long, value_name = "NAME|FILE", conflicts_with = "drive")]
    pub(crate) virtual_robot: Option<String>,

    /// Standard deviation of the virtual robot's measured joint positions, in rad
    #[arg(long, value_name = "RAD", default_value_t = 1e-5, value_parser = noise,
        conflicts_with = "drive")]
    pub(crate) noise: f64,

    /// Sampling rate of the virtual robot, 50 to 10000 [default: 1000; 200 for cycle-time]
    #[arg(long, value_name = "HZ", value_parser = sampling_rate, conflicts_with = "drive")]
    pub(crate) rate: Option<f64>,

    /// Seed of random programs and noise
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,

    /// Number of poses of `limits` (20), points of `settle` (200) or paths of `cycle-time` (5); the
    /// numbers in brackets are the default and the maximum
    #[arg(long, value_name = "N", value_parser = whole::<u16, 1, 200>)]
    pub(crate) count: Option<u16>,

    /// Payload of `load`, in kg, with its centre of mass in mm; to be mounted on the robot when
    /// asked for
    #[arg(long, value_name = "KG,X,Y,Z", default_value = "7,0,0,60", allow_hyphen_values = true)]
    pub(crate) load: Load,

    /// Effect of a payload on the virtual robot: none, factor (2 % slower per kg) or torque (within
    /// the joint torque limits)
    #[arg(long, value_name = "NAME", default_value = "none", conflicts_with = "drive")]
    pub(crate) load_planner: LoadPlanning,

    /// Move the arm to the start of each program, at this share of the velocity limits, in per
    /// cent; 10 without a value
    #[arg(long, value_name = "PERCENT", num_args = 0..=1, require_equals = true,
        default_missing_value = "10", value_parser = percent_above_zero, requires = "drive")]
    pub(crate) move_to_start: Option<f64>,

    /// Address at which the drive sends joint positions and its state
    #[arg(long, value_name = "HOST:PORT", default_value = STREAM, env = "IIWASIM_STREAM",
        hide_env = true)]
    pub(crate) stream: Endpoint,

    #[command(flatten)]
    pub(crate) keys: ClientKeys,
}

/// Experiments of the thesis, and ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ExperimentName {
    /// Joint limits: Appendix A, Tables 4 and 5, Fig. 28
    Limits,
    /// Blend curves: sections 4.2 and 4.3, Fig. 15 to 18, 20 and 21
    Blends,
    /// Velocity in blends: Appendix B, Fig. 29
    ZoneVelocity,
    /// Settling time: Appendix C, Table 6
    Settle,
    /// Cycle time errors: section 5.1.2, Fig. 23 to 25
    CycleTime,
    /// Blends of TCP paths, orientation and E1 along them: not in the thesis; with --drive, for
    /// controllers that plan TCP paths
    TcpBlends,
    /// Planning with the payload: swings of A2 and A4 without and with a payload; not in the thesis
    Load,
    /// All but `load`, in one report
    All,
}

impl ExperimentName {
    /// As it is on the command line.
    pub(crate) fn name(self) -> String {
        self.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
    }
}
