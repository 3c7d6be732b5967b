//! Check for benches without arguments.

use iiwasim_benches::Result;

pub(crate) fn no_arguments(arguments: &[&str]) -> Result<()> {
    if arguments.is_empty() { Ok(()) } else { Err("it takes no arguments".into()) }
}
