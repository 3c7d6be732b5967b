//! `iiwasim experiment`.

use std::path::PathBuf;

use clap::{ArgGroup, Args, ValueEnum};
use iiwa_link::security::Endpoint;

use super::{
    addresses::{ClientKeys, STREAM},
    values::{noise, percent_above_zero, sampling_rate},
};

/// Do an experiment of the thesis again (Larsen 2019), on the robot or on a virtual one.
///
/// Makes the programs, runs them, holds what was measured against what is calculated for --robot, and
/// writes into a folder: programs/NAME.json; recordings/NAME.mcap and NAME.csv, which `identify` and
/// `compare` take; figure-NN.svg in the thesis's form; report.md with figures, tables, and what the thesis
/// reports beside them.
///
/// --simulate runs them on a virtual robot in this process: it plans under limits of velocity,
/// acceleration and jerk, and is sampled with noise. It is the model itself unless --virtual-robot names
/// a profile with other limits, blends (`blend_kappa`) and time to settle (`settle_time_s`). Files of the
/// same names are replaced.
///
/// --drive runs them on what the drive is connected with. THE ARM MOVES FAR: `limits` swings each joint
/// by itself from 20 poses, by 20 deg at full speed, and by 70 deg about zero; `blends` moves joints 2
/// and 4; `settle` and `cycle-time` move all joints in random directions. Before each program it moves in
/// a straight line of joint space to where that starts, for which --move-to-start is needed. Programs keep
/// the flange 0.1 m above the robot's foot, or as the thesis has them; they know of nothing else around the robot, and
/// of no tool: its space has to be free. How far each joint will go is told first. The folder has to be
/// new or empty. Ctrl-C stops the robot on its path; what was recorded before stays.
#[derive(Args, Debug)]
#[command(group = ArgGroup::new("on").required(true))]
pub(crate) struct Experiment {
    /// Which one
    #[arg(value_enum, value_name = "NAME")]
    pub(crate) name: ExperimentName,

    /// Run the programs on a virtual robot
    #[arg(long, group = "on")]
    pub(crate) simulate: bool,

    /// Run them on the robot of the drive that takes requests there, as 127.0.0.1:5560
    #[arg(long, group = "on", value_name = "HOST:PORT", requires = "move_to_start")]
    pub(crate) drive: Option<Endpoint>,

    /// Folder for the files, made if there is none [default: experiment-NAME]
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: Option<PathBuf>,

    /// Where the report goes, in the folder or above it [default: FOLDER/report.md]
    #[arg(long, value_name = "FILE.md")]
    pub(crate) report: Option<PathBuf>,

    /// Write the report and its figures only
    #[arg(long)]
    pub(crate) no_recordings: bool,

    /// The model: built in, or a robot profile
    #[arg(long, value_name = "NAME|FILE", default_value = "lbr_iiwa_7_r800")]
    pub(crate) robot: String,

    /// What the virtual robot is, built in or a robot profile [default: the model]
    #[arg(long, value_name = "NAME|FILE", conflicts_with = "drive")]
    pub(crate) virtual_robot: Option<String>,

    /// Standard deviation of the virtual robot's joint positions as measured, in rad
    #[arg(long, value_name = "RAD", default_value_t = 1e-5, value_parser = noise, conflicts_with = "drive")]
    pub(crate) noise: f64,

    /// Samples of the virtual robot a second, 50 to 10000 [default: 1000; 200 for cycle-time]
    #[arg(long, value_name = "HZ", value_parser = sampling_rate, conflicts_with = "drive")]
    pub(crate) rate: Option<f64>,

    /// What random programs and noise follow from
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,

    /// How many: poses of `limits` (20), points of `settle` (200), paths of `cycle-time` (5); at most
    /// these, in brackets, which are the default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=200))]
    pub(crate) count: Option<u16>,

    /// Let the arm move to the start of each program, at this share of the limits of velocity, in per
    /// cent: 10 where none is given
    #[arg(long, value_name = "PERCENT", num_args = 0..=1, require_equals = true, default_missing_value = "10", value_parser = percent_above_zero, requires = "drive")]
    pub(crate) move_to_start: Option<f64>,

    /// Where the drive publishes
    #[arg(long, value_name = "HOST:PORT", default_value = STREAM)]
    pub(crate) stream: Endpoint,

    #[command(flatten)]
    pub(crate) keys: ClientKeys,
}

/// Experiments of the thesis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ExperimentName {
    /// Limits of the joints: Appendix A, Tables 4 and 5, Fig. 28
    Limits,
    /// The curve of blends: sections 4.2 and 4.3, Fig. 15 to 18, 20 and 21
    Blends,
    /// Velocity in blends: Appendix B, Fig. 29
    ZoneVelocity,
    /// The time to settle: Appendix C, Table 6
    Settle,
    /// Errors of the cycle time: section 5.1.2, Fig. 23 to 25
    CycleTime,
    /// All of them, in one report
    All,
}

impl ExperimentName {
    /// As it is on the command line.
    pub(crate) fn name(self) -> String {
        self.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
    }
}
