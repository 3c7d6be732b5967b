//! What is odd about a program that can be planned.

use std::fmt::Write as _;

use iiwa_kin::Robot;
use iiwa_path::TurnContradiction;
use iiwa_program::Program;
use iiwa_view::printable;

/// Targets whose turn is not that of the joints there. What cannot be planned is reported by planning.
pub(crate) fn turn_warnings(program: &Program, robot: &Robot) -> Vec<String> {
    let found = TurnContradiction::all(program, robot).unwrap_or_default();
    found.iter().map(ToString::to_string).collect()
}

/// Warnings as they are reported on standard error; of one of many programs, with its name.
pub(crate) fn warning_lines(warnings: &[String], program: Option<&str>) -> String {
    let name = program.map_or_else(String::new, |name| format!("{}: ", printable(name)));
    warnings.iter().fold(String::new(), |mut lines, warning| {
        let _ = writeln!(lines, "Warning: {name}{warning}");
        lines
    })
}
