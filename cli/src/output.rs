//! Output files, which appear whole or not at all; standard output; interrupts.

use std::{
    fs::File,
    io::{self, BufWriter, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
    sync::{
        Arc, OnceLock,
        atomic::{AtomicBool, Ordering},
    },
};

use tempfile::NamedTempFile;

use crate::{failure::Failure, leftovers::Name, replaceable::Replaceable};

/// A file under construction, beside the one that it will replace.
pub(crate) struct Output {
    path: PathBuf,
    file: NamedTempFile,
    /// While it is open, no other process removes the file as a leftover.
    _lock: Option<File>,
}

/// Files under construction.
const PART: Name = Name { prefix: ".iiwasim-", suffix: ".part", is_folder: false };

impl Output {
    /// Starts a file that will be at `path`, and may replace one of its own kind.
    pub(crate) fn replacing(path: &Path, kind: Replaceable) -> Result<Self, Failure> {
        kind.check(path)?;
        Self::new(path)
    }

    /// Starts a file that will be at `path`.
    pub(crate) fn new(path: &Path) -> Result<Self, Failure> {
        let refuse =
            |error: &io::Error| Failure::run(format!("cannot write {}", path.display()), error);
        let folder = path.parent().unwrap_or(Path::new(""));
        if !folder.as_os_str().is_empty() && !folder.exists() {
            let what = format!("there is no folder {}", folder.display());
            return Err(refuse(&io::Error::other(what)));
        }
        // Of a symbolic link, the target is replaced.
        let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        match path.metadata() {
            Ok(kind) if kind.is_dir() => {
                return Err(refuse(&io::Error::from(io::ErrorKind::IsADirectory)));
            }
            Ok(kind) if !kind.is_file() => {
                return Err(refuse(&io::Error::other("it is a device or a pipe, not a file")));
            }
            _ => {}
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        let make = |name: &mut tempfile::Builder<'_, '_>| {
            #[cfg(unix)]
            {
                // Temporary files are private; this one will be an ordinary file.
                use std::os::unix::fs::PermissionsExt;
                name.permissions(std::fs::Permissions::from_mode(0o666));
            }
            name.tempfile_in(folder)
        };
        let (file, lock) = PART
            .make(folder, make, NamedTempFile::path)
            // Without the name of the temporary file.
            .map_err(|error| refuse(&io::Error::from(error.kind())))?;
        Ok(Self { path, file, _lock: lock })
    }

    /// A stream for the content.
    pub(crate) fn stream(&self) -> Result<BufWriter<Stream>, Failure> {
        let file = self.file.as_file().try_clone().map_err(|error| self.failure(&error))?;
        Ok(BufWriter::new(Stream(file)))
    }

    /// Writes all of it.
    pub(crate) fn write(&self, content: &[u8]) -> Result<(), Failure> {
        self.file.as_file().write_all(content).map_err(|error| self.failure(&error))
    }

    /// The failure to write it.
    pub(crate) fn failure(&self, error: &dyn std::error::Error) -> Failure {
        // An interrupt makes writes fail.
        if interrupted() {
            return Failure::interrupted();
        }
        Failure::run(format!("cannot write {}", self.path.display()), error)
    }

    /// Puts the file in its place, unless an interrupt has come.
    pub(crate) fn complete(self) -> Result<(), Failure> {
        check_interrupt()?;
        self.complete_always()
    }

    /// Puts the file in its place.
    pub(crate) fn complete_always(self) -> Result<(), Failure> {
        let path = self.path;
        self.file
            .persist(&path)
            .map(drop)
            .map_err(|error| Failure::run(format!("cannot write {}", path.display()), &error.error))
    }
}

/// Writes a whole file, unless an interrupt has come.
pub(crate) fn write(path: &Path, content: &[u8]) -> Result<(), Failure> {
    let file = Output::new(path)?;
    file.write(content)?;
    file.complete()
}

/// A file that can no longer be written after an interrupt.
pub(crate) struct Stream(File);

impl Write for Stream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if interrupted() {
            return Err(io::Error::other("interrupted"));
        }
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl Seek for Stream {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}

/// Refuses to replace a file that cannot be made again, unless `overwrite` says so.
pub(crate) fn keep_existing(what: &str, path: &Path, overwrite: bool) -> Result<(), Failure> {
    if !path.exists() {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        return match folder.filter(|folder| !folder.exists()) {
            None => Ok(()),
            Some(folder) => {
                let cause = Some(format!("there is no folder {}", folder.display()));
                Err(Failure::Run { what: format!("cannot write {}", path.display()), cause })
            }
        };
    }
    if overwrite {
        return Ok(());
    }
    Err(Failure::input(format!(
        "{} exists; a {what} is not written over another file: name one with --output, or give --overwrite",
        path.display()
    )))
}

/// Whether two paths lead to one file.
fn same_file(a: &Path, b: &Path) -> bool {
    a == b || a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}

/// Refuses to write `what` to `target` over one of the files that are `read`, which are given with their kinds.
pub(crate) fn keep_inputs<'a>(
    what: &str,
    target: &Path,
    read: impl IntoIterator<Item = (&'a str, &'a Path)>,
    option: &str,
) -> Result<(), Failure> {
    match read.into_iter().find(|(_, path)| same_file(target, path)) {
        None => Ok(()),
        Some((other, path)) => Err(Failure::input(format!(
            "the {what} would be written over the {other}, {}; name another file with {option}",
            path.display()
        ))),
    }
}

/// Prints to standard output. A reader that has gone away, as `head` does, is no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    print_if_read(text).map(drop)
}

/// The same; false if the reader has gone away.
pub(crate) fn print_if_read(text: &str) -> Result<bool, Failure> {
    let mut out = anstream::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(false),
        Err(error) => Err(Failure::run("cannot write to standard output", &error)),
    }
}

/// A line of JSON.
pub(crate) fn json_line(value: &impl serde::Serialize) -> Result<String, Failure> {
    let json = serde_json::to_string(value)
        .map_err(|error| Failure::run("cannot write the answer", &error))?;
    Ok(format!("{json}\n"))
}

/// Prints a line of JSON.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    print(&json_line(value)?)
}

static INTERRUPTED: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// What an interrupt sets, for libraries that look at it.
pub(crate) fn interrupt_flag() -> Arc<AtomicBool> {
    Arc::clone(INTERRUPTED.get_or_init(Arc::default))
}

/// From now on an interrupt (Ctrl-C or a termination signal) sets a flag, see [`check_interrupt`], so that no
/// partial file stays behind. A second one ends the process at once.
pub(crate) fn catch_interrupts() {
    let flag = interrupt_flag();
    // Without a handler an interrupt ends the process at once, which is acceptable.
    let _ = ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(1);
        }
    });
}

/// Repeats something until an interrupt.
pub(crate) fn wait_for_interrupt(mut meanwhile: impl FnMut()) {
    while !interrupted() {
        meanwhile();
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
}

/// Whether an interrupt has come.
pub(crate) fn interrupted() -> bool {
    INTERRUPTED.get().is_some_and(|flag| flag.load(Ordering::Relaxed))
}

/// Acts as an interrupt.
pub(crate) fn interrupt() {
    interrupt_flag().store(true, Ordering::Relaxed);
}

/// Fails once an interrupt has come.
pub(crate) fn check_interrupt() -> Result<(), Failure> {
    if interrupted() {
        return Err(Failure::interrupted());
    }
    Ok(())
}
