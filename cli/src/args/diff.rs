//! `iiwasim diff`.

use std::path::PathBuf;

use clap::Args;

use super::{Answering, Timing, values::at_least_0};

/// Compare two versions of a program: times, limits and paths before and after a change.
///
/// The table has one row per motion that differs: its number and its duration in both versions, the
/// changes of its path, and the limit that is active longest. Motions are matched by their
/// targets, so that a motion that was added, removed or moved to another line does not shift the
/// others. Motions without a match, between two matched ones, are paired in order with motions of
/// the same type. A duration counts as changed from 0.5 ms on, a path from 0.05 mm or 0.05 deg on.
///
/// A path change is the largest distance of a point on the path from the path of the other version,
/// regardless of time. It is given for the flange path and for the path in joint space (Euclidean
/// norm of the seven angles), which also shows another orientation or elbow angle.
///
/// A second table has the times of groups of motions, if they differ. With --scene, the smallest
/// distances of the arm from the obstacles and from itself are given.
///
/// Each version is a motion program, a plan (an MCAP file of `iiwasim plan`, whose figures are used
/// as they are), or the folder of a Sunrise project. Two folders of programs are compared by file
/// names: a program whose new version fails is reported on standard error and does not stop the
/// others; the exit code is then 3.
#[derive(Args, Debug)]
pub(crate) struct Diff {
    /// The version before the change: a program in JSON, a plan, or a folder; - reads a program
    /// from standard input
    #[arg(value_name = "OLD")]
    pub(crate) old: PathBuf,

    /// The version after the change
    #[arg(value_name = "NEW")]
    pub(crate) new: PathBuf,

    /// Print a JSON object; for folders, one object per line
    #[arg(long, conflicts_with = "markdown")]
    pub(crate) json: bool,

    /// Print Markdown, for the summary of a CI job or a merge request
    #[arg(long)]
    pub(crate) markdown: bool,

    /// Gate: exit with code 3 if a cycle time grows by more than this, in per cent
    #[arg(long, value_name = "P", value_parser = at_least_0)]
    pub(crate) max_growth_percent: Option<f64>,

    /// Timing method of programs, as for `iiwasim plan`
    #[arg(long, value_enum, default_value_t = Timing::Sunrise)]
    pub(crate) timing: Timing,

    /// Built-in model or robot profile, instead of the programs'
    #[arg(long, value_name = "NAME|FILE")]
    pub(crate) robot: Option<String>,

    /// Scene with obstacles in JSON (`iiwasim schema scene`), to print the clearances of the arm
    /// before and after; plans in files have the clearances of their own scenes
    #[arg(long, value_name = "SCENE.json", env = "IIWASIM_SCENE", hide_env = true)]
    pub(crate) scene: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) answering: Box<Answering>,
}
