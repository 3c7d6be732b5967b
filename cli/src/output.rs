//! Files that appear whole or not at all.

use std::{
    fs::File,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::{
        OnceLock,
        atomic::{AtomicBool, Ordering},
    },
};

use tempfile::NamedTempFile;

use crate::failure::Failure;

/// A file under construction, beside the one that it will replace.
pub(crate) struct Output {
    path: PathBuf,
    file: NamedTempFile,
}

impl Output {
    /// Begins a file that will be at `path`.
    pub(crate) fn new(path: &Path) -> Result<Self, Failure> {
        let refuse =
            |error: &io::Error| Failure::run(format!("cannot write {}", path.display()), error);
        if path.is_dir() {
            return Err(refuse(&io::Error::from(io::ErrorKind::IsADirectory)));
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let mut builder = tempfile::Builder::new();
        builder.prefix(".iiwasim-").suffix(".part");
        #[cfg(unix)]
        {
            // Temporary files are private; this one will be an ordinary file.
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        let file = builder
            .tempfile_in(folder.unwrap_or(Path::new(".")))
            .map_err(|error| refuse(&error))?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Where the content goes.
    pub(crate) fn stream(&self) -> Result<BufWriter<File>, Failure> {
        let file = self.file.as_file().try_clone().map_err(|error| self.failure(&error))?;
        Ok(BufWriter::with_capacity(1 << 18, file))
    }

    /// Why it could not be written.
    pub(crate) fn failure(&self, error: &dyn std::error::Error) -> Failure {
        Failure::run(format!("cannot write {}", self.path.display()), error)
    }

    /// Puts the file in its place.
    pub(crate) fn complete(self) -> Result<(), Failure> {
        check_interrupt()?;
        let path = self.path;
        self.file
            .persist(&path)
            .map(drop)
            .map_err(|error| Failure::run(format!("cannot write {}", path.display()), &error.error))
    }
}

/// Writes a whole file.
pub(crate) fn write(path: &Path, content: &[u8]) -> Result<(), Failure> {
    let output = Output::new(path)?;
    let mut stream = output.stream()?;
    stream
        .write_all(content)
        .and_then(|()| stream.flush())
        .map_err(|error| output.failure(&error))?;
    output.complete()
}

/// Prints to standard output. A reader that has gone away, as `head` does, is no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = anstream::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::run("cannot write to standard output", &error))
        }
        _ => Ok(()),
    }
}

static INTERRUPTED: OnceLock<AtomicBool> = OnceLock::new();

/// From now on an interrupt (Ctrl-C, or a request to end) is noticed by [`check_interrupt`], so that
/// nothing half-written stays behind.
pub(crate) fn catch_interrupts() {
    let flag = INTERRUPTED.get_or_init(|| AtomicBool::new(false));
    // Without a handler an interrupt ends the process at once, which is all right too.
    let _ = ctrlc::set_handler(|| flag.store(true, Ordering::Relaxed));
}

/// Fails once an interrupt has come.
pub(crate) fn check_interrupt() -> Result<(), Failure> {
    match INTERRUPTED.get() {
        Some(flag) if flag.load(Ordering::Relaxed) => {
            Err(Failure::Run { what: "interrupted".to_owned(), cause: None })
        }
        _ => Ok(()),
    }
}
