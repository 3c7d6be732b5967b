//! `iiwasim advise`.

use std::path::PathBuf;

use clap::Args;

use super::SearchOptions;

/// List changes that make a program faster, each with the time that it saves.
///
/// The table has one row per change, the largest saving first: the motion, the change, the time
/// that the change saves alone, and the time that it saves after all changes above it. Each saving
/// is the difference of two exact plans. The last column names what the times rest on: recordings
/// of a robot, or assumptions, which are listed below the table. Changes that save less than a
/// millisecond have no row, nor has a change that saves nothing after those above it. The changes
/// that are tried:
///
/// - another elbow angle (E1) at the target of a motion to a frame, by the same angle also at the
///   targets after it, up to the next point-to-point motion; by up to 90 deg, in steps of 15 deg
///   and then, about the best of them, down to 1 deg
/// - another blend radius, or a blend in place of a stop, of 5 mm to --max-blend-mm, where the next
///   entry of the program is a motion with the same payload; of radii that save nearly the same,
///   the smallest
/// - point-to-point motions at full speed
/// - motions that the program need not wait for (`moveAsync` in place of `move`)
/// - waits whose time could run during the motion before them
///
/// Targets, speeds of TCP paths, inputs, outputs and the order of motions are not changed;
/// with a blend, the TCP passes its target within the radius and does not reach it. The command
/// changes no file; --apply with --output writes a changed program.
///
/// Changes are checked for collisions only with --scene: a change has no row if the clearance of a
/// motion from the obstacles, or of the arm from itself, falls below --min-clearance. The unchanged
/// program must not touch an obstacle.
#[derive(Args, Debug)]
pub(crate) struct Advise {
    #[command(flatten)]
    pub(crate) search: SearchOptions,

    /// Print a JSON object
    #[arg(long)]
    pub(crate) json: bool,

    /// Rows of the table whose changes are written to --output: numbers with commas between them,
    /// or `all`
    #[arg(long, value_name = "ROWS", requires = "output")]
    pub(crate) apply: Option<ChosenRows>,

    /// Path of the changed program in JSON, with the changes of --apply
    #[arg(short, long, value_name = "FILE.json", requires = "apply")]
    pub(crate) output: Option<PathBuf>,

    /// Replace an existing program, which may have been edited by hand
    #[arg(long, requires = "output")]
    pub(crate) overwrite: bool,
}

/// Rows of the table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum ChosenRows {
    All,
    Numbers(Vec<usize>),
}

impl std::str::FromStr for ChosenRows {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "all" {
            return Ok(Self::All);
        }
        let number = |part: &str| match part.trim().parse() {
            Ok(number) if number > 0 => Ok(number),
            _ => Err(format!("`{part}` is not the number of a row; give 1,3 or all")),
        };
        let numbers: Vec<_> = text.split(',').map(number).collect::<Result<_, _>>()?;
        let mut distinct = numbers.clone();
        distinct.sort_unstable();
        distinct.dedup();
        if distinct.len() < numbers.len() {
            return Err(format!("`{text}` has a row twice"));
        }
        Ok(Self::Numbers(distinct))
    }
}
