//! Conversion of errors to the exceptions of `iiwasim._errors`.

use std::{fs, io, path::Path};

use iiwa_files::{OutputError, folder_of};
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

/// The text of a file; an exception of `class` if the file is not UTF-8.
pub(crate) fn read_text(py: Python<'_>, path: &Path, class: &str) -> PyResult<String> {
    fs::read_to_string(path).map_err(|error| match error.kind() {
        io::ErrorKind::InvalidData => {
            exception(py, class, (format!("{}: the text is not UTF-8", path.display()),))
        }
        _ => os_error(path, &error),
    })
}

fn in_text(py: Python<'_>, class: &str, message: &str, place: &JsonPlace) -> PyErr {
    exception(py, class, (format!("{message}, at {place}"), place.line, place.column))
}

/// A `ProgramError` for an invalid program text.
pub(crate) fn program_error(py: Python<'_>, error: &ProgramError) -> PyErr {
    let place = error.place();
    let motion = error.motion().map(MotionIndex::number);
    exception(py, "ProgramError", (error.to_string(), place.line, place.column, motion))
}

/// A `ProgramError`, or another exception, for a program that cannot be read or planned.
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
