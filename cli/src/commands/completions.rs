//! `iiwasim completions`.

use crate::{
    args::{Arguments, Completions},
    failure::Failure,
    output,
};

/// Prints the script for a shell.
pub(crate) fn run(options: &Completions) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut Arguments::command_line(), "iiwasim", &mut script);
    output::print(&String::from_utf8_lossy(&script))
}
