//! Atomic output files.

use std::{
    error::Error,
    fs::File,
    io::{self, BufWriter, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
};

use tempfile::NamedTempFile;

use crate::{folder_of, interrupt, leftovers::TemporaryName};

/// Reason why a file could not be written.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The file could not be created, written or renamed.
    #[error("cannot write {}", path.display())]
    Write {
        /// Path of the output.
        path: PathBuf,
        /// Cause.
        source: Box<dyn Error + Send + Sync>,
    },
    /// The process was interrupted.
    #[error("interrupted")]
    Interrupted,
}

impl OutputError {
    pub(crate) fn new(path: &Path, source: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self::Write { path: path.to_owned(), source: source.into() }
    }
}

/// File under construction, in the same folder as the file that it will replace.
#[derive(Debug)]
pub struct Output {
    path: PathBuf,
    file: NamedTempFile,
    /// While the lock is open, no other process removes the file as a leftover.
    _lock: Option<File>,
}

/// Maximum number of symbolic links that are followed, as in Linux.
const MAX_LINKS: usize = 40;

/// Naming of files under construction.
const PART: TemporaryName =
    TemporaryName { prefix: ".iiwasim-", suffix: ".part", is_folder: false };

impl Output {
    /// Starts a file that will be at `path`.
    ///
    /// # Errors
    ///
    /// [`OutputError::Write`] if the folder does not exist, if a folder or a device is at `path`,
    /// or if the temporary file cannot be created.
    pub fn new(path: &Path) -> Result<Self, OutputError> {
        let to_error = |error: io::Error| OutputError::new(path, error);
        let real = destination(path).map_err(to_error)?;
        let folder = folder_of(&real);
        if !folder.exists() {
            let message = format!("no such folder: {}", folder.display());
            return Err(to_error(io::Error::other(message)));
        }
        let existing = real.metadata();
        match &existing {
            Ok(kind) if kind.is_dir() => {
                return Err(to_error(io::Error::from(io::ErrorKind::IsADirectory)));
            }
            Ok(kind) if !kind.is_file() => {
                return Err(to_error(io::Error::other("it is a device or a pipe, not a file")));
            }
            _ => {}
        }
        let make = |name: &mut tempfile::Builder<'_, '_>| {
            #[cfg(unix)]
            {
                // Temporary files are private; the output is an ordinary file.
                use std::os::unix::fs::PermissionsExt;
                name.permissions(std::fs::Permissions::from_mode(0o666));
            }
            name.tempfile_in(folder)
        };
        let (file, lock) = PART
            .make(folder, make, NamedTempFile::path)
            // Omits the name of the temporary file.
            .map_err(|error| to_error(io::Error::from(error.kind())))?;
        if let Ok(existing) = existing {
            // A private file stays private.
            file.as_file().set_permissions(existing.permissions()).map_err(to_error)?;
        }
        Ok(Self { path: real, file, _lock: lock })
    }

    /// Returns a stream for the content.
    ///
    /// # Errors
    ///
    /// [`OutputError`] if the process cannot open another file.
    pub fn stream(&self) -> Result<BufWriter<OutputStream>, OutputError> {
        let file = self.file.as_file().try_clone().map_err(|error| self.failure(error))?;
        Ok(BufWriter::new(OutputStream(file)))
    }

    /// Writes the whole content.
    ///
    /// # Errors
    ///
    /// [`OutputError`], for example if the disk is full.
    pub fn write(&self, content: &[u8]) -> Result<(), OutputError> {
        self.file.as_file().write_all(content).map_err(|error| self.failure(error))
    }

    /// Returns the error for a failed write.
    pub fn failure(&self, error: impl Into<Box<dyn Error + Send + Sync>>) -> OutputError {
        // An interrupt makes writes fail.
        if interrupt::has_come() {
            return OutputError::Interrupted;
        }
        OutputError::new(&self.path, error)
    }

    /// Renames the file to its final path, unless the process was interrupted.
    ///
    /// # Errors
    ///
    /// [`OutputError`] after an interrupt, or if the file cannot be renamed.
    pub fn complete(self) -> Result<(), OutputError> {
        if interrupt::has_come() {
            return Err(OutputError::Interrupted);
        }
        self.complete_always()
    }

    /// Renames the file to its final path, even after an interrupt.
    ///
    /// # Errors
    ///
    /// [`OutputError::Write`] if the file cannot be renamed.
    pub fn complete_always(self) -> Result<(), OutputError> {
        let path = self.path;
        self.file.persist(&path).map(drop).map_err(|error| OutputError::new(&path, error.error))
    }
}

/// Returns the path that an output at `path` is written to, which need not exist: the target of a
/// symbolic link is replaced, not the link. Equal files have equal paths.
///
/// # Errors
///
/// Links that lead in a circle.
pub fn destination(path: &Path) -> io::Result<PathBuf> {
    let mut real = path.to_owned();
    for _ in 0..MAX_LINKS {
        let Ok(target) = real.read_link() else {
            let in_folder = |folder: PathBuf| folder.join(real.file_name().unwrap_or_default());
            let existing = real.canonicalize();
            let there = existing.or_else(|_| folder_of(&real).canonicalize().map(in_folder));
            return Ok(there.unwrap_or(real));
        };
        real = folder_of(&real).join(target);
    }
    Err(io::Error::other("its symbolic links lead in a circle"))
}

/// Stream into the file that fails after an interrupt.
#[derive(Debug)]
pub struct OutputStream(File);

impl Write for OutputStream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if interrupt::has_come() {
            return Err(io::Error::other("interrupted"));
        }
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl Seek for OutputStream {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_appears_when_it_is_complete() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("plan.csv");
        std::fs::write(&path, "before").unwrap();
        let file = Output::new(&path).unwrap();
        file.write(b"after").unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "before");
        file.complete().unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "after");
        drop(Output::new(&path).unwrap());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_and_permissions_are_kept() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let [file, link] = ["file.csv", "link.csv"].map(|name| folder.path().join(name));
        // The target does not exist at first.
        symlink("file.csv", &link).unwrap();
        for content in ["first", "second"] {
            let output = Output::new(&link).unwrap();
            output.write(content.as_bytes()).unwrap();
            output.complete().unwrap();
            assert!(link.is_symlink());
            assert_eq!(destination(&link).unwrap(), destination(&file).unwrap());
            assert_eq!(std::fs::read_to_string(&file).unwrap(), content);
            std::fs::set_permissions(&file, std::fs::Permissions::from_mode(0o600)).unwrap();
        }
        let output = Output::new(&file).unwrap();
        output.complete().unwrap();
        assert_eq!(file.metadata().unwrap().permissions().mode() & 0o777, 0o600);
        let circle = folder.path().join("circle");
        symlink("circle", &circle).unwrap();
        assert!(Output::new(&circle).is_err() && circle.is_symlink());
    }

    #[test]
    fn errors_name_the_requested_path() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("none/plan.csv");
        for path in [folder.path(), &missing] {
            let error = Output::new(path).unwrap_err();
            assert_eq!(error.to_string(), format!("cannot write {}", path.display()));
            assert!(error.source().is_some());
        }
    }
}
