//! What is odd about a program that can be planned.

use std::fmt::Write as _;

use iiwa_path::{JointPath, TurnContradiction};
use iiwa_program::Program;
use iiwa_view::printable;

/// What is odd about a program with this path: targets whose turn is not that of the joints there, and splines in which the
/// TCP stops.
pub(crate) fn warnings(program: &Program, path: &JointPath) -> Vec<String> {
    let turns = TurnContradiction::all(program, path.robot()).unwrap_or_default();
    let stops = path.stops_in_splines().into_iter().map(|(motion, count)| {
        let often = if count == 1 { "once".to_owned() } else { format!("{count} times") };
        format!(
            "motion {motion}: the TCP stops {often} within the spline, where direction, curvature, turn or E1 of two lines or \
             circles do not go on; a segment `spl` between them makes them"
        )
    });
    let end = program.blend_at_the_end().map(|motion| {
        format!("motion {motion} is the last one: its blend has nothing to blend into, and the arm stops")
    });
    turns.iter().map(ToString::to_string).chain(stops).chain(end).collect()
}

/// Warnings as they are reported on standard error; of one of many programs, with its name.
pub(crate) fn warning_lines(warnings: &[String], program: Option<&str>) -> String {
    let name = program.map_or_else(String::new, |name| format!("{}: ", printable(name)));
    warnings.iter().fold(String::new(), |mut lines, warning| {
        let _ = writeln!(lines, "Warning: {name}{warning}");
        lines
    })
}
