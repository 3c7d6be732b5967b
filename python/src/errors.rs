//! Conversion of errors to the exceptions of `iiwasim._errors`.

use std::{
    io::{self, Read},
    path::Path,
};

use iiwa_files::{InputFile, NotUtf8, OutputError, folder_of};
use iiwa_json::JsonPlace;
use iiwa_kin::ProfileError;
use iiwa_plan::Error;
use iiwa_program::{MotionIndex, ProgramError};
use iiwa_scene::SceneError;
use pyo3::{
    exceptions::{PyKeyboardInterrupt, PyOSError, PyTypeError},
    prelude::*,
    types::PyTuple,
};

use crate::{
    arguments::{in_argument, in_program},
    work::interruptible,
};

/// An exception of `iiwasim._errors`, made with these arguments.
pub(crate) fn exception<'py, A>(py: Python<'py>, class: &str, arguments: A) -> PyErr
where
    A: IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
{
    let made = || py.import("iiwasim._errors")?.getattr(class)?.call1(arguments.into_pyobject(py)?);
    match made() {
        Ok(error) => PyErr::from_value(error),
        Err(error) => error,
    }
}

/// A `TypeError` for an argument of the wrong type.
pub(crate) fn unexpected(name: &str, value: &Bound<'_, PyAny>, expected: &str) -> PyErr {
    match value.get_type().name() {
        Ok(class) => {
            PyTypeError::new_err(format!("{name} is of type {class}; {expected} is expected"))
        }
        Err(error) => error,
    }
}

/// Python's `errno.ENOENT` and `errno.EISDIR`, the same on all systems.
const NO_SUCH_FILE: i32 = 2;
const IS_A_FOLDER: i32 = 21;

/// An `OSError` for a file that cannot be read or written; Python chooses the subclass by the
/// error number of the system.
pub(crate) fn os_error(path: &Path, error: &io::Error) -> PyErr {
    let text = error.to_string();
    let message = text.split(" (os error").next().unwrap_or(&text).to_owned();
    let number = error.raw_os_error().or_else(|| match path {
        _ if path.is_dir() => Some(IS_A_FOLDER),
        _ if !folder_of(path).is_dir() => Some(NO_SUCH_FILE),
        _ => None,
    });
    match number {
        Some(number) => PyOSError::new_err((number, message, path.display().to_string())),
        None => PyOSError::new_err(format!("{}: {message}", path.display())),
    }
}

/// An exception for a file that was not written.
pub(crate) fn output_error(error: &OutputError) -> PyErr {
    match error {
        OutputError::Interrupted => PyKeyboardInterrupt::new_err(()),
        OutputError::Write { path, source } => match source.downcast_ref() {
            Some(error) => os_error(path, error),
            None => PyOSError::new_err(iiwa_report::with_causes(error)),
        },
    }
}

/// The text of a file without its byte order mark; an exception of `class` if the file is not
/// UTF-8. Ctrl-C ends the wait for the writer of a pipe.
pub(crate) fn read_text(py: Python<'_>, path: &Path, class: &str) -> PyResult<String> {
    match iiwa_files::text(read_file(py, path)?) {
        Ok(text) => Ok(text),
        Err(error @ NotUtf8::Utf16(_)) => {
            Err(exception(py, class, (format!("{}: {error}", path.display()),)))
        }
        Err(NotUtf8::Other(_)) => {
            Err(exception(py, class, (format!("{}: the text is not UTF-8", path.display()),)))
        }
    }
}

/// The content of a file or a pipe. Ctrl-C ends the wait for the writer of a pipe.
pub(crate) fn read_file(py: Python<'_>, path: &Path) -> PyResult<Vec<u8>> {
    let input = InputFile::open(path).map_err(|error| os_error(path, &error))?;
    read_input(py, path, input)
}

/// The content of the open file or pipe `path`.
pub(crate) fn read_input(py: Python<'_>, path: &Path, input: InputFile) -> PyResult<Vec<u8>> {
    let read = |mut input: InputFile| {
        let mut bytes = Vec::new();
        input.read_to_end(&mut bytes).map(|_| bytes)
    };
    let bytes = if input.is_pipe() {
        interruptible(py, move |stop| read(input.stopped_by(stop)), |_| Ok(()))?
    } else {
        read(input)
    };
    bytes.map_err(|error| os_error(path, &error))
}

fn in_text(py: Python<'_>, class: &str, message: &str, place: &JsonPlace) -> PyErr {
    exception(py, class, (format!("{message}, at {place}"), place.line, place.column))
}

/// A `ProgramError` for an invalid argument, `name`, that was converted to the `text` of a program;
/// `outer` is the path to the argument in the text.
pub(crate) fn argument_error(
    py: Python<'_>,
    error: &ProgramError,
    text: &str,
    outer: &[&str],
    name: &str,
) -> PyErr {
    let message = in_argument(&error.message(), text, error.place().span.start, outer, name);
    exception(py, "ProgramError", (message,))
}

/// Origin of a program text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TextOrigin {
    /// The caller has the text: errors state line and column.
    Given,
    /// The text was made from arguments: errors state the motion and the argument.
    Arguments,
}

/// A `ProgramError` for an invalid program text.
pub(crate) fn program_error(py: Python<'_>, error: &ProgramError) -> PyErr {
    let place = error.place();
    let motion = error.motion().map(MotionIndex::number);
    exception(py, "ProgramError", (error.to_string(), place.line, place.column, motion))
}

/// A `ProgramError`, or another exception, for a program, with its text, that cannot be read or
/// planned.
pub(crate) fn plan_error_in(
    py: Python<'_>,
    error: &Error,
    text: &str,
    origin: TextOrigin,
) -> PyErr {
    let is_of_program =
        matches!(error, Error::Program(_) | Error::Plan { .. } | Error::UnknownRobot { .. });
    if origin == TextOrigin::Given || !is_of_program || error.is_interrupt() {
        return plan_error(py, error);
    }
    let message = match error.place() {
        Some(place) => in_program(&error.message(), text, place.span.start),
        None => error.message(),
    };
    let motion = error.motion().map(MotionIndex::number);
    exception(py, "ProgramError", (message, None::<usize>, None::<usize>, motion))
}

/// A `ProgramError`, or another exception, for a program text that cannot be read or planned.
pub(crate) fn plan_error(py: Python<'_>, error: &Error) -> PyErr {
    if error.is_interrupt() {
        return PyKeyboardInterrupt::new_err(());
    }
    if let Error::Profile { error, .. } = error {
        return profile_error(py, error);
    }
    let place = error.place();
    let [line, column] = [place.map(|place| place.line), place.map(|place| place.column)];
    let motion = error.motion().map(MotionIndex::number);
    exception(py, "ProgramError", (error.to_string(), line, column, motion))
}

/// A `ProfileError` for an invalid robot profile.
pub(crate) fn profile_error(py: Python<'_>, error: &ProfileError) -> PyErr {
    in_text(py, "ProfileError", &error.message(), error.place())
}

/// A `SceneError` for an invalid scene.
pub(crate) fn scene_error(py: Python<'_>, error: &SceneError) -> PyErr {
    in_text(py, "SceneError", &error.message(), error.place())
}
