//! Overwrite protection of output files; standard output; interrupts.

use std::{
    io::{self, Write},
    path::Path,
    sync::atomic::Ordering,
};

use iiwa_files::{Output, destination, interrupt};

use crate::{failure::Failure, output_kind::OutputKind};

/// Starts a file that will be at `path`, and may replace a file of the same kind.
pub(crate) fn replacing(path: &Path, kind: OutputKind) -> Result<Output, Failure> {
    kind.check_existing(path)?;
    Ok(Output::new(path)?)
}

/// Writes a whole file, unless the process was interrupted.
pub(crate) fn write(path: &Path, content: &[u8]) -> Result<(), Failure> {
    let file = Output::new(path)?;
    file.write(content)?;
    Ok(file.complete()?)
}

/// Rejects replacing a file that cannot be generated again, unless `overwrite` is set.
pub(crate) fn keep_existing(kind: OutputKind, path: &Path, overwrite: bool) -> Result<(), Failure> {
    kind.check_name(path)?;
    if !path.exists() {
        // Reports an output that cannot be written before a robot moves, or a long computation
        // begins.
        return Ok(Output::new(path).map(drop)?);
    }
    if overwrite {
        return Ok(());
    }
    Err(Failure::input(format!(
        "{} exists; a {} is not written over another file: name one with --output, or give \
         --overwrite",
        path.display(),
        kind.name()
    )))
}

/// Returns true if two paths lead to the same file, which need not exist yet.
pub(crate) fn same_file(a: &Path, b: &Path) -> bool {
    a == b || destination(a).is_ok_and(|a| destination(b).is_ok_and(|b| a == b))
}

/// Rejects an output at `target` whose name does not fit its kind, or that would replace one of the
/// `other` files of the command, which are given with their names in messages.
pub(crate) fn keep_others<'a>(
    kind: OutputKind,
    target: &Path,
    other: impl IntoIterator<Item = (&'a str, &'a Path)>,
    option: &str,
) -> Result<(), Failure> {
    // `-` is standard input or output, not a file.
    let is_dash = target == Path::new("-");
    match other.into_iter().find(|(_, path)| !is_dash && same_file(target, path)) {
        None => kind.check_name(target),
        Some((other, path)) => Err(Failure::input(format!(
            "the {} would be written over the {other}, {}; name another file with {option}",
            kind.name(),
            path.display()
        ))),
    }
}

/// Prints to standard output. A closed reader, such as `head`, is not a failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    print_if_read(text).map(drop)
}

/// Prints to standard output; returns false if the reader has closed it.
pub(crate) fn print_if_read(text: &str) -> Result<bool, Failure> {
    let mut out = anstream::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(false),
        Err(error) => Err(Failure::run("cannot write to standard output", &error)),
    }
}

/// Formats a line of JSON.
pub(crate) fn json_line(value: &impl serde::Serialize) -> Result<String, Failure> {
    let json = serde_json::to_string(value)
        .map_err(|error| Failure::run("cannot write the answer", &error))?;
    Ok(format!("{json}\n"))
}

/// Prints a line of JSON.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    print(&json_line(value)?)
}

/// Installs a handler: an interrupt (Ctrl-C or a termination signal) sets a flag, see
/// [`check_interrupt`], so that no partial file remains. A second interrupt ends the process at
/// once.
pub(crate) fn catch_interrupts() {
    let flag = interrupt::flag();
    // Without a handler, an interrupt ends the process at once, which is acceptable.
    let _ = ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(1);
        }
    });
}

/// Repeats an action until an interrupt.
#[cfg(feature = "live")]
pub(crate) fn wait_for_interrupt(mut meanwhile: impl FnMut()) {
    while !interrupt::has_come() {
        meanwhile();
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
}

/// Fails after an interrupt.
pub(crate) fn check_interrupt() -> Result<(), Failure> {
    if interrupt::has_come() {
        return Err(Failure::interrupted());
    }
    Ok(())
}
