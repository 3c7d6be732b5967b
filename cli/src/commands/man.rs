//! `iiwasim man`.

use std::fs;

use crate::{
    args::{Arguments, Man},
    failure::Failure,
    output,
};

/// Writes the manual pages.
pub(crate) fn run(options: &Man) -> Result<(), Failure> {
    let folder = &options.folder;
    let to_failure =
        |error: &std::io::Error| Failure::run(format!("cannot write {}", folder.display()), error);
    fs::create_dir_all(folder).map_err(|error| to_failure(&error))?;
    let command = Arguments::command_line().disable_help_subcommand(true);
    clap_mangen::generate_to(command.clone(), folder).map_err(|error| to_failure(&error))?;
    let count = command.get_subcommands().count() + 1;
    output::print(&format!("{count} pages in {}\n", folder.display()))
}
