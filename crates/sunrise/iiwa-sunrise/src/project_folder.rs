//! Files in a project folder.

use std::{
    collections::BTreeSet,
    fs, io,
    path::{Path, PathBuf},
};

/// Maximum number of Java files; robot programs have a few hundred.
pub(crate) const MAX_FILES: usize = 10_000;
/// Maximum number of folders; more indicate a whole disk.
pub(crate) const MAX_FOLDERS: usize = 100_000;

/// File with the frames and tools of a project.
pub(crate) const DATA_FILE: &str = "RoboticsAPI.data.xml";

/// File with the configuration of a project's station.
pub(crate) const STATION_FILE: &str = "StationSetup.cat";

/// Error of searching a folder.
#[derive(Debug)]
pub(crate) enum FolderFault {
    Files,
    Folders,
    Unreadable(PathBuf, io::Error),
}

/// Finds the Java files in a folder and its subfolders, sorted by their paths relative to the
/// folder. Build output, hidden entries, and subfolders that cannot be opened are skipped.
pub(crate) fn sources(root: &Path) -> Result<Vec<(String, PathBuf)>, FolderFault> {
    let mut files = Vec::new();
    let mut visited = BTreeSet::new();
    let mut open = vec![(String::new(), root.to_owned())];
    while let Some((name, folder)) = open.pop() {
        // A link may point to a parent folder.
        let is_new = folder.canonicalize().is_ok_and(|folder| visited.insert(folder));
        if !is_new && !name.is_empty() {
            continue;
        }
        if visited.len() > MAX_FOLDERS {
            return Err(FolderFault::Folders);
        }
        let entries = match entries(&folder) {
            Ok(entries) => entries,
            Err(error) if name.is_empty() => return Err(FolderFault::Unreadable(folder, error)),
            Err(_) => continue,
        };
        for (entry, path) in entries {
            let below = if name.is_empty() { entry.clone() } else { format!("{name}/{entry}") };
            if path.is_dir() {
                if !is_left_out(&entry) {
                    open.push((below, path));
                }
            } else if Path::new(&entry).extension().is_some_and(|end| end == "java") {
                files.push((below, path));
                if files.len() > MAX_FILES {
                    return Err(FolderFault::Files);
                }
            }
        }
    }
    files.sort();
    Ok(files)
}

/// Finds the files of a project with this name, with their paths relative to its folder: the file
/// in the folder, otherwise the files one level below, otherwise the file one level above.
pub(crate) fn nearest(root: &Path, file: &str) -> Vec<(String, PathBuf)> {
    let path = root.join(file);
    if path.is_file() {
        return vec![(file.to_owned(), path)];
    }
    let mut below = Vec::new();
    for (name, folder) in entries(root).unwrap_or_default() {
        let path = folder.join(file);
        if !is_left_out(&name) && path.is_file() {
            below.push((format!("{name}/{file}"), path));
        }
    }
    if below.is_empty()
        && let Ok(root) = root.canonicalize()
        && let Some(above) = root.parent().map(|above| above.join(file))
        && above.is_file()
    {
        return vec![(format!("../{file}"), above)];
    }
    below
}

/// Returns the entries of a folder, sorted by name.
fn entries(folder: &Path) -> io::Result<Vec<(String, PathBuf)>> {
    let mut entries = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        entries.push((entry.file_name().to_string_lossy().into_owned(), entry.path()));
    }
    entries.sort();
    Ok(entries)
}

fn is_left_out(folder: &str) -> bool {
    folder.starts_with('.') || matches!(folder, "bin" | "target")
}
