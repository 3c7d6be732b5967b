//! `iiwasim keygen`.

use std::{fs, path::Path};

use iiwa_link::security::{KeyPair, SecurityError};

use iiwa_json::printable;

use crate::{args::Keygen, failure::Failure, output};

/// Creates a pair of keys, and explains their use.
pub(crate) fn run(options: &Keygen) -> Result<(), Failure> {
    // Prevents partial files.
    output::catch_interrupts();
    let folder = options.output.as_deref().unwrap_or(Path::new(""));
    let pair = KeyPair::generate().map_err(to_failure)?;
    if !folder.as_os_str().is_empty() {
        fs::create_dir_all(folder).map_err(|error| {
            Failure::run(format!("cannot make the folder {}", folder.display()), &error)
        })?;
    }
    let (key, public) = pair.write(folder, &options.name).map_err(to_failure)?;
    let [key, public] = [key, public].map(|path| printable(&path.display().to_string()));
    output::print(&format!(
        "\
{key}: secret; it stays here, and only you can read it
{public}: public; it goes to the other side

If it is the drive's: {public} goes to each client, and the clients' .pub files into a folder:
  iiwasim drive --key {key} --allow clients/
If it is a client's: {public} goes into that folder, and the drive's .pub file comes here:
  --key {key} --server-key drive.pub
"
    ))
}

fn to_failure(error: SecurityError) -> Failure {
    match error {
        SecurityError::Exists { .. } | SecurityError::Name { .. } => {
            Failure::input(error.to_string())
        }
        error => Failure::run("cannot make keys", &error),
    }
}
