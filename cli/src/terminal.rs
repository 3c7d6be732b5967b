//! Width of tables on standard output.

use std::{
    env,
    io::{self, IsTerminal as _},
};

/// Returns the number of characters per line of tables: the variable COLUMNS if set, otherwise the
/// width of the terminal, or 80 if the terminal does not report it. `None` if standard output is
/// not a terminal: the lines of tables in files and pipes have any length.
pub(crate) fn width() -> Option<u16> {
    const UNKNOWN: u16 = 80;
    let variable = env::var("COLUMNS").ok().and_then(|columns| columns.trim().parse().ok());
    if let Some(columns @ 1..) = variable {
        return Some(columns);
    }
    let stdout = io::stdout();
    if !stdout.is_terminal() {
        return None;
    }
    let reported = terminal_size::terminal_size_of(stdout).map(|(width, _)| width.0);
    Some(reported.filter(|columns| *columns > 0).unwrap_or(UNKNOWN))
}
