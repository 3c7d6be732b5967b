//! `iiwasim optimise`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use iiwa_optimise::Freedom;

use super::SearchOptions;

/// Change a program so that it is faster.
///
/// The command makes changes of the kinds that --free allows, until no single one of them saves
/// another millisecond, and writes the changed program. It prints the changes, and then the
/// differences of the two plans as `iiwasim diff` does. The changes are those of `iiwasim advise`,
/// except those of waits; elbow angles of neighbouring motions are first turned together. Changes
/// of several rounds add up: E1 may change by more than 90 deg.
///
/// With `e1` alone, and if the arm stops around each group of motions that turns, all E1 in steps
/// of 1 deg are compared together, and a lower bound of the cycle time is printed.
///
/// With `e1`, lines, circles and splines keep their TCP paths and programmed speeds. The elbow
/// moves elsewhere, and point-to-point motions take other paths. With `blends`, the TCP passes
/// targets within the radius and does not reach them. Targets, speeds of TCP paths, waits, inputs,
/// outputs, tools and the order of motions are never changed.
///
/// The changed program is planned again from its text before it is written. If no change saves a
/// millisecond, the unchanged program is written. With --robot, the written program names that
/// robot.
///
/// With --page, a page for a browser shows both plans side by side and plays them together.
///
/// Changes are checked for collisions only with --scene: each motion keeps --min-clearance from the
/// obstacles, and the arm from itself. The unchanged program must not touch an obstacle.
#[derive(Args, Debug)]
pub(crate) struct Optimise {
    #[command(flatten)]
    pub(crate) search: SearchOptions,

    /// Kinds of changes, with commas between them
    #[arg(
        long,
        value_name = "KINDS",
        value_enum,
        value_delimiter = ',',
        default_values_t = [FreeKind::E1]
    )]
    pub(crate) free: Vec<FreeKind>,

    /// Number of plans after which no further round of changes begins. Plans before the first
    /// round, which turn elbow angles of several groups of motions together, do not count
    #[arg(long, value_name = "PLANS", default_value_t = 50_000)]
    pub(crate) budget: u64,

    /// Path of the changed program: a file in JSON, or the folder of a Sunrise project to write, as
    /// by `iiwasim export`
    #[arg(short, long, value_name = "FILE.json|FOLDER")]
    pub(crate) output: PathBuf,

    /// Also write a page that plays the plans before and after the changes side by side
    #[arg(long, value_name = "FILE.html")]
    pub(crate) page: Option<PathBuf>,

    /// Replace an existing program or project, which may have been edited by hand
    #[arg(long)]
    pub(crate) overwrite: bool,

    /// Print a JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// Kind of changes that the user allows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FreeKind {
    /// Elbow angles (E1) at targets
    E1,
    /// Blend radii, blends in place of stops, `moveAsync` in place of `move`
    Blends,
    /// Speeds of point-to-point motions
    Speeds,
}

impl Optimise {
    pub(crate) fn freedom(&self) -> Freedom {
        let frees = |kind| self.free.contains(&kind);
        Freedom {
            elbows: frees(FreeKind::E1),
            blends: frees(FreeKind::Blends),
            speeds: frees(FreeKind::Speeds),
            waits: false,
        }
    }
}
