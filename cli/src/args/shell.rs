//! `iiwasim completions` and `iiwasim man`.

use std::path::PathBuf;

use clap::Args;
use clap_complete::Shell;

/// Print the script that completes commands and options in a shell.
///
/// bash: `iiwasim completions bash > ~/.local/share/bash-completion/completions/iiwasim`
///
/// zsh: `iiwasim completions zsh > _iiwasim` in a folder of $fpath
///
/// fish: `iiwasim completions fish > ~/.config/fish/completions/iiwasim.fish`
#[derive(Args, Debug)]
pub(crate) struct Completions {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    pub(crate) shell: Shell,
}

/// Write manual pages, one per command: `iiwasim man ~/.local/share/man/man1`, then `man
/// iiwasim-plan`.
#[derive(Args, Debug)]
pub(crate) struct Man {
    /// Folder for the pages, created if missing
    #[arg(value_name = "FOLDER")]
    pub(crate) folder: PathBuf,
}
