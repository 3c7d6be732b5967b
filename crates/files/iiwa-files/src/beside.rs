//! Files that other files name.

use std::{
    ffi::OsStr,
    path::{Component, Path, PathBuf},
};

/// Reason for rejecting a file that another file names.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotBeside {
    /// The file is outside that folder, or has another file type.
    #[error("it has to be beside the file that names it, or in a folder below that")]
    Elsewhere,
    /// The file does not exist.
    #[error("no such file: {}", .0.display())]
    Missing(PathBuf),
    /// A symbolic link leads outside the folder.
    #[error("{} leads out of the folder of the file that names it", .0.display())]
    LeadsOut(PathBuf),
}

/// Returns the folder of a file.
#[must_use]
pub fn folder_of(file: &Path) -> &Path {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

/// Returns the path of the file `name`, which the file `from` names: in the folder of `from` or
/// below, with one of these endings. A name from an untrusted file must not make this process read
/// any other file, or show its content in errors.
///
/// # Errors
///
/// [`NotBeside`] if the file is anywhere else, or does not exist.
pub fn beside(from: &Path, name: &str, endings: &[&str]) -> Result<PathBuf, NotBeside> {
    let folder = folder_of(from);
    let path = folder.join(name);
    let below = |part: Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
    let name = Path::new(name);
    let ending = |ending: &OsStr| endings.iter().any(|known| ending.eq_ignore_ascii_case(known));
    if !name.components().all(below) || !name.extension().is_some_and(ending) {
        return Err(NotBeside::Elsewhere);
    }
    if !path.is_file() {
        return Err(NotBeside::Missing(path));
    }
    match (path.canonicalize(), folder.canonicalize()) {
        (Ok(file), Ok(folder)) if file.starts_with(&folder) => Ok(path),
        _ => Err(NotBeside::LeadsOut(path)),
    }
}
