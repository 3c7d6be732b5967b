//! Output folders: a new folder is written atomically, an existing one file by file.

use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};

use tempfile::TempDir;

use crate::{Output, OutputError, interrupt, leftovers::TemporaryName};

/// Naming of folders under construction.
const PART: TemporaryName =
    TemporaryName { prefix: ".iiwasim-", suffix: ".folder", is_folder: true };

/// Writes all these files into a folder, by their paths relative to the folder.
///
/// A new folder appears with all files. In an existing folder, each file is replaced atomically,
/// once all files have been written; other files are kept.
///
/// # Errors
///
/// [`OutputError`] if a file cannot be written, or after an interrupt: then a new folder does not
/// appear, and the files of an existing folder are unchanged, unless one of them cannot be renamed.
pub fn write_folder(folder: &Path, files: &[(&Path, &[u8])]) -> Result<(), OutputError> {
    if is_new(folder) { make(folder, files) } else { replace(folder, files) }
}

/// Returns true if a folder is empty or does not exist.
fn is_new(folder: &Path) -> bool {
    match fs::read_dir(folder) {
        Ok(mut entries) => entries.next().is_none(),
        Err(_) => folder.symlink_metadata().is_err(),
    }
}

fn make(folder: &Path, files: &[(&Path, &[u8])]) -> Result<(), OutputError> {
    let to_error = |error: io::Error| OutputError::new(folder, error);
    let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty());
    let parent = parent.unwrap_or(Path::new("."));
    if !parent.exists() {
        let message = format!("no such folder: {}", parent.display());
        return Err(to_error(io::Error::other(message)));
    }
    let make = |name: &mut tempfile::Builder<'_, '_>| {
        #[cfg(unix)]
        {
            // Temporary folders are private; the output is an ordinary folder.
            use std::os::unix::fs::PermissionsExt;
            name.permissions(fs::Permissions::from_mode(0o777));
        }
        name.tempdir_in(parent)
    };
    let (part, _lock): (TempDir, Option<File>) = PART
        .make(parent, make, TempDir::path)
        // Omits the name of the temporary folder.
        .map_err(|error| to_error(io::Error::from(error.kind())))?;
    for (path, content) in files {
        let target = folder.join(path);
        let temporary = part.path().join(path);
        let write = |temporary: &PathBuf| {
            if let Some(parent) = temporary.parent() {
                fs::create_dir_all(parent)?;
            }
            fs::write(temporary, content)
        };
        write(&temporary).map_err(|error| OutputError::new(&target, error))?;
    }
    if interrupt::has_come() {
        return Err(OutputError::Interrupted);
    }
    fs::rename(part.path(), folder).map_err(to_error)?;
    // The folder has been renamed: nothing is left to remove.
    let _ = part.keep();
    Ok(())
}

fn replace(folder: &Path, files: &[(&Path, &[u8])]) -> Result<(), OutputError> {
    let mut outputs = Vec::with_capacity(files.len());
    for (path, content) in files {
        let target = folder.join(path);
        if let Some(parent) = target.parent() {
            fs::create_dir_all(parent).map_err(|error| OutputError::new(&target, error))?;
        }
        let output = Output::new(&target)?;
        output.write(content)?;
        outputs.push(output);
    }
    if interrupt::has_come() {
        return Err(OutputError::Interrupted);
    }
    outputs.into_iter().try_for_each(Output::complete_always)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILES: [(&str, &[u8]); 2] = [("src/application/A.java", b"class"), ("data.xml", b"<a/>")];

    fn files() -> [(&'static Path, &'static [u8]); 2] {
        FILES.map(|(path, content)| (Path::new(path), content))
    }

    #[test]
    fn a_folder_appears_with_all_files() {
        let above = tempfile::tempdir().unwrap();
        let folder = above.path().join("project");
        write_folder(&folder, &files()).unwrap();
        for (path, content) in files() {
            assert_eq!(fs::read(folder.join(path)).unwrap(), content);
        }
        assert_eq!(fs::read_dir(above.path()).unwrap().count(), 1);
        // An empty folder counts as new.
        let empty = above.path().join("empty");
        fs::create_dir(&empty).unwrap();
        write_folder(&empty, &files()).unwrap();
        assert!(empty.join("data.xml").exists());
    }

    #[test]
    fn other_files_of_a_folder_stay() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("data.xml"), "before").unwrap();
        fs::write(at("notes.txt"), "mine").unwrap();
        write_folder(folder.path(), &files()).unwrap();
        assert_eq!(fs::read(at("data.xml")).unwrap(), b"<a/>");
        assert_eq!(fs::read(at("notes.txt")).unwrap(), b"mine");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
    }

    #[test]
    fn nothing_appears_where_a_file_cannot_be_written() {
        let above = tempfile::tempdir().unwrap();
        let folder = above.path().join("project");
        let wrong = [(Path::new("a"), &b"1"[..]), (Path::new("a/b"), &b"2"[..])];
        let error = write_folder(&folder, &wrong).unwrap_err().to_string();
        assert_eq!(error, format!("cannot write {}", folder.join("a/b").display()));
        assert_eq!(fs::read_dir(above.path()).unwrap().count(), 0);
        let missing = above.path().join("none/project");
        write_folder(&missing, &files()).unwrap_err();
    }
}
