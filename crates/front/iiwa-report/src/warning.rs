//! Warnings on standard error.

use std::fmt::Write as _;

use iiwa_json::printable;

/// Formats warnings for standard error, with the name of the program if there are many.
#[must_use]
pub fn warning_lines(warnings: &[String], program: Option<&str>) -> String {
    let name = program.map_or_else(String::new, |name| format!("{}: ", printable(name)));
    warnings.iter().fold(String::new(), |mut lines, warning| {
        let _ = writeln!(lines, "Warning: {name}{warning}");
        lines
    })
}
