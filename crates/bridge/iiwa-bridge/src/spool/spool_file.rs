//! Files of a queue, opened without following links and without truncating existing content.
//!
//! Other users may be able to write to the folder of the queue. A link that they create under the
//! name of a queue file must not lead the bridge to another file, neither for writing nor for
//! reading.

use std::{
    fs::{self, File, OpenOptions},
    io,
    path::Path,
};

/// Opens a file for reading.
pub(super) fn open(path: &Path) -> io::Result<File> {
    open_with(path, OpenOptions::new().read(true))
}

/// Opens a file for locking, and creates it if it is missing. Its content is not changed.
pub(super) fn open_to_lock(path: &Path) -> io::Result<File> {
    open_with(path, OpenOptions::new().read(true).write(true).create(true).truncate(false))
}

/// Creates a file, replacing a regular file with this name. The existing file is removed rather
/// than truncated, because it may have another hard link.
pub(super) fn create(path: &Path) -> io::Result<File> {
    if is_there(path)? {
        fs::remove_file(path)?;
    }
    let created = OpenOptions::new().write(true).create_new(true).open(path);
    created.map_err(|error| is_there(path).err().unwrap_or(error))
}

fn open_with(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    is_there(path)?;
    let opened = open_itself(path, options);
    let file = opened.map_err(|error| is_there(path).err().unwrap_or(error))?;
    if !file.metadata()?.is_file() {
        return Err(foreign(path, "not a regular file"));
    }
    Ok(file)
}

/// Opens the file with this name itself: a link or a pipe that has appeared since the check is not
/// followed or waited for.
fn open_itself(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(options, libc::O_NOFOLLOW | libc::O_NONBLOCK);
    options.open(path)
}

/// Returns `true` for an existing regular file and `false` for a missing file; links, folders and
/// devices are errors.
fn is_there(path: &Path) -> io::Result<bool> {
    match path.symlink_metadata() {
        Ok(metadata) if metadata.is_file() => Ok(true),
        Ok(metadata) if metadata.is_symlink() => Err(foreign(path, "a symbolic link")),
        Ok(metadata) if metadata.is_dir() => Err(foreign(path, "a folder")),
        Ok(_) => Err(foreign(path, "not a regular file")),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

fn foreign(path: &Path, kind: &str) -> io::Error {
    let path = path.display();
    io::Error::other(format!(
        "{path} is {kind}, which the bridge has not created: remove it, and let only the user of \
         the bridge write to its folder"
    ))
}

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use std::os::unix::{fs::symlink, net::UnixListener};

    use super::*;

    /// Creates a folder with a file `victim`, and a link `link` to it.
    fn linked() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("victim"), "precious").unwrap();
        symlink(folder.path().join("victim"), folder.path().join("link")).unwrap();
        folder
    }

    #[test]
    fn links_are_neither_followed_nor_removed() {
        let folder = linked();
        let (link, victim) = (folder.path().join("link"), folder.path().join("victim"));
        for opened in [open(&link), open_to_lock(&link), create(&link)] {
            let error = opened.unwrap_err().to_string();
            let expected = format!("{} is a symbolic link, which the bridge", link.display());
            assert!(error.starts_with(&expected) && error.contains(": remove it"), "{error}");
        }
        assert!(link.is_symlink());
        assert_eq!(fs::read_to_string(victim).unwrap(), "precious");
    }

    #[test]
    fn links_to_nothing_create_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let (link, target) = (folder.path().join("link"), folder.path().join("target"));
        symlink(&target, &link).unwrap();
        for opened in [open(&link), open_to_lock(&link), create(&link)] {
            opened.unwrap_err();
        }
        assert!(!target.exists());
    }

    #[test]
    fn other_names_of_a_file_keep_its_content() {
        let folder = linked();
        let (other, victim) = (folder.path().join("other"), folder.path().join("victim"));
        fs::hard_link(&victim, &other).unwrap();
        open_to_lock(&other).unwrap();
        create(&other).unwrap();
        assert_eq!(fs::read_to_string(&other).unwrap(), "");
        assert_eq!(fs::read_to_string(victim).unwrap(), "precious");
    }

    #[test]
    fn entries_that_are_not_files_are_named_and_kept() {
        let folder = tempfile::tempdir().unwrap();
        let socket = folder.path().join("socket");
        let _listener = UnixListener::bind(&socket).unwrap();
        for (path, kind) in [(folder.path(), "a folder"), (&socket, "not a regular file")] {
            for opened in [open(path), open_to_lock(path), create(path)] {
                let error = opened.unwrap_err().to_string();
                let expected = format!("{} is {kind}, which the bridge", path.display());
                assert!(error.starts_with(&expected), "{error}");
            }
            assert!(path.exists());
        }
    }

    #[test]
    fn a_link_that_appears_after_the_check_is_not_followed() {
        let folder = linked();
        let link = folder.path().join("link");
        for options in [OpenOptions::new().read(true), OpenOptions::new().write(true).create(true)]
        {
            let error = open_itself(&link, options).unwrap_err();
            assert_eq!(error.raw_os_error(), Some(libc::ELOOP));
        }
    }
}
