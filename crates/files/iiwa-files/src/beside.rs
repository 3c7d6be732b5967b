//! Files that other files name.

use std::{
    ffi::OsStr,
    path::{Component, Path, PathBuf},
};

/// Why a file that another one names is not read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotBeside {
    /// It is elsewhere, or of another kind.
    #[error("it has to be beside the file that names it, or in a folder below that")]
    Elsewhere,
    /// There is none.
    #[error("there is no file {}", .0.display())]
    Missing(PathBuf),
    /// A link leads elsewhere.
    #[error("{} leads out of the folder of the file that names it", .0.display())]
    LeadsOut(PathBuf),
}

/// The folder of a file.
#[must_use]
pub fn folder_of(file: &Path) -> &Path {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

/// The path of the file `name`, which the file `from` names: in its folder or below, with one of these endings. What comes
/// from elsewhere must not make this process read, and show in errors, any other file.
///
/// # Errors
///
/// [`NotBeside`] if it is anywhere else, or not there.
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
