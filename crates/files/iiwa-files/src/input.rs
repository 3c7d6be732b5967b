//! Input files: regular files, and pipes, which can be read only once.

use std::{
    fs::{self, File},
    io::{self, BufRead, Read},
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use iiwa_json::{UTF_16, is_utf16, without_mark};

use crate::interrupt;

/// Open input. Reading a pipe waits for its writer, and fails after an
/// [interrupt](mod@crate::interrupt).
#[derive(Debug)]
pub struct InputFile {
    file: File,
    is_pipe: bool,
    /// Flag that ends a wait besides the interrupt flag.
    stop: Option<Arc<AtomicBool>>,
}

impl InputFile {
    /// Opens a regular file or a pipe for reading, without waiting for the writer of a pipe.
    ///
    /// # Errors
    ///
    /// As [`File::open`], and for folders, devices and sockets.
    pub fn open(path: &Path) -> io::Result<Self> {
        // Before the file is opened: opening a device can have effects.
        let kind = fs::metadata(path)?.file_type();
        let is_pipe = is_pipe(kind);
        if kind.is_dir() {
            return Err(io::Error::from(io::ErrorKind::IsADirectory));
        }
        if !kind.is_file() && !is_pipe {
            return Err(io::Error::other("it is a device or a socket, not a file"));
        }
        let file = open_at_once(path)?;
        Ok(Self { file, is_pipe, stop: None })
    }

    /// Ends a wait for the writer of a pipe also when this flag is set.
    #[must_use]
    pub fn stopped_by(self, flag: Arc<AtomicBool>) -> Self {
        Self { stop: Some(flag), ..self }
    }

    /// Returns true for a pipe, which can be read only once.
    #[must_use]
    pub fn is_pipe(&self) -> bool {
        self.is_pipe
    }
}

impl Read for InputFile {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            if self.is_pipe {
                wait_for_data(&self.file, self.stop.as_deref())?;
            }
            match self.file.read(buffer) {
                Err(error) if self.is_pipe && error.kind() == io::ErrorKind::WouldBlock => {}
                read => return read,
            }
        }
    }
}

/// Reads the content of a regular file or a pipe.
///
/// # Errors
///
/// As [`InputFile::open`], and if reading fails.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    InputFile::open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads a regular file or a pipe of at most `max_bytes`. The limit also holds for a file that
/// grows meanwhile.
///
/// # Errors
///
/// As [`read`]; [`io::ErrorKind::FileTooLarge`] for a larger file.
pub(crate) fn read_up_to(path: &Path, max_bytes: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    InputFile::open(path)?.take(max_bytes.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > max_bytes {
        return Err(io::Error::new(
            io::ErrorKind::FileTooLarge,
            format!("the file has more than {max_bytes} bytes"),
        ));
    }
    Ok(bytes)
}

/// Reads a text in UTF-8, without its byte order mark.
///
/// # Errors
///
/// As [`read`]; [`io::ErrorKind::InvalidData`] with the cause [`NotUtf8`] for another encoding.
pub fn read_text(path: &Path) -> io::Result<String> {
    text(read(path)?).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
}

/// Reads standard input to its end. Fails after an [interrupt](mod@crate::interrupt).
///
/// # Errors
///
/// If reading fails.
pub fn read_stdin() -> io::Result<Vec<u8>> {
    let mut stdin = io::stdin().lock();
    let mut bytes = Vec::new();
    loop {
        wait_for_data(&stdin, None)?;
        let length = match stdin.fill_buf() {
            Ok([]) => return Ok(bytes),
            Ok(data) => {
                bytes.extend_from_slice(data);
                data.len()
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => 0,
            Err(error) => return Err(error),
        };
        stdin.consume(length);
    }
}

/// Bytes that are not a text in UTF-8.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotUtf8 {
    /// The bytes begin with a byte order mark of UTF-16.
    #[error("it is {}", UTF_16)]
    Utf16(Vec<u8>),
    /// Any other bytes.
    #[error("it is not text in UTF-8")]
    Other(Vec<u8>),
}

impl NotUtf8 {
    /// Returns the bytes.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8] {
        match self {
            Self::Utf16(bytes) | Self::Other(bytes) => bytes,
        }
    }
}

/// Converts bytes to a text without byte order mark.
///
/// # Errors
///
/// If the bytes are not UTF-8.
pub fn text(bytes: Vec<u8>) -> Result<String, NotUtf8> {
    if is_utf16(&bytes) {
        return Err(NotUtf8::Utf16(bytes));
    }
    let mut text = String::from_utf8(bytes).map_err(|error| NotUtf8::Other(error.into_bytes()))?;
    let mark = text.len() - without_mark(&text).len();
    text.drain(..mark);
    Ok(text)
}

#[cfg(unix)]
fn is_pipe(kind: fs::FileType) -> bool {
    use std::os::unix::fs::FileTypeExt;
    kind.is_fifo()
}

#[cfg(not(unix))]
fn is_pipe(_: fs::FileType) -> bool {
    false
}

/// Opens a file; a named pipe without a writer does not block.
#[cfg(unix)]
fn open_at_once(path: &Path) -> io::Result<File> {
    use rustix::fs::{Mode, OFlags, open};
    let flags = OFlags::RDONLY | OFlags::NONBLOCK | OFlags::CLOEXEC | OFlags::NOCTTY;
    Ok(open(path, flags, Mode::empty())?.into())
}

#[cfg(not(unix))]
fn open_at_once(path: &Path) -> io::Result<File> {
    File::open(path)
}

/// Waits until a stream has data or is at its end; an error after an interrupt.
#[cfg(unix)]
fn wait_for_data(stream: &impl std::os::fd::AsFd, stop: Option<&AtomicBool>) -> io::Result<()> {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    /// Interval in which an interrupt is noticed.
    const INTERVAL: Timespec = Timespec { tv_sec: 0, tv_nsec: 50_000_000 };
    loop {
        check(stop)?;
        match poll(&mut [PollFd::new(stream, PollFlags::IN)], Some(&INTERVAL)) {
            Ok(0) | Err(rustix::io::Errno::INTR) => {}
            Ok(_) => return Ok(()),
            Err(error) => return Err(error.into()),
        }
    }
}

#[cfg(not(unix))]
fn wait_for_data<T>(_: &T, stop: Option<&AtomicBool>) -> io::Result<()> {
    check(stop)
}

/// Fails after an interrupt, or if `stop` is set.
fn check(stop: Option<&AtomicBool>) -> io::Result<()> {
    if interrupt::has_come() || stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
        return Err(io::Error::other("interrupted"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_has_no_byte_order_mark() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        for (content, expected) in [
            (&b"{}"[..], Ok("{}")),
            (b"\xef\xbb\xbf{}", Ok("{}")),
            (b"\xff\xfe{\0}\0", Err("it is text in UTF-16: save it as UTF-8")),
            (b"\xfe\xff\0{\0}", Err("it is text in UTF-16: save it as UTF-8")),
            (b"\xe4", Err("it is not text in UTF-8")),
        ] {
            fs::write(&path, content).unwrap();
            let read = read_text(&path).map_err(|error| error.to_string());
            assert_eq!(read, expected.map(str::to_owned).map_err(str::to_owned));
        }
    }

    #[test]
    fn folders_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let error = InputFile::open(folder.path()).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::IsADirectory);
        let error = InputFile::open(&folder.path().join("none")).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::NotFound);
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_refused() {
        let error = InputFile::open(Path::new("/dev/zero")).unwrap_err();
        assert_eq!(error.to_string(), "it is a device or a socket, not a file");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_pipe_without_a_writer_does_not_block() {
        use rustix::fs::{CWD, FileType, Mode, mknodat};
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pipe");
        mknodat(CWD, &path, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0).unwrap();
        let stop = Arc::new(AtomicBool::new(false));
        let mut input = InputFile::open(&path).unwrap().stopped_by(Arc::clone(&stop));
        std::thread::scope(|scope| {
            let reader = scope.spawn(move || input.read_to_end(&mut Vec::new()));
            stop.store(true, Ordering::Relaxed);
            assert_eq!(reader.join().unwrap().unwrap_err().to_string(), "interrupted");
        });
    }

    /// The content is larger than the buffer of a pipe, so that the reader waits for the writer.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_named_pipe_is_read_to_its_end() {
        use rustix::fs::{CWD, FileType, Mode, mknodat};
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pipe");
        mknodat(CWD, &path, FileType::Fifo, Mode::RUSR | Mode::WUSR, 0).unwrap();
        let mut input = InputFile::open(&path).unwrap();
        assert!(input.is_pipe());
        let content: Vec<u8> = (0..200_000_u32).flat_map(u32::to_le_bytes).collect();
        let mut bytes = Vec::new();
        std::thread::scope(|scope| {
            scope.spawn(|| fs::write(&path, &content).unwrap());
            input.read_to_end(&mut bytes).unwrap();
        });
        assert!(bytes == content);
    }
}
