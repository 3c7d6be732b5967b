//! What is odd about a program that can be planned.

use iiwa_kin::Robot;
use iiwa_path::Program;

/// Targets whose turn is not that of the joints there. What cannot be planned is reported by planning.
pub(crate) fn turn_warnings(program: &Program, robot: &Robot) -> Vec<String> {
    let found = program.turn_contradictions(robot).unwrap_or_default();
    found.iter().map(ToString::to_string).collect()
}
