//! Errors as the exceptions of `iiwasim._errors`.

use std::{fs, io, path::Path};

use iiwa_files::{OutputError, folder_of};
use iiwa_json::Place;
use iiwa_kin::ProfileError;
use iiwa_program::{Fault, ProgramError, Sources};
use iiwa_scene::SceneError;
use iiwa_traj::{PlanError, TimingError};
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

/// A value of a type that an argument cannot have.
pub(crate) fn unexpected(name: &str, value: &Bound<'_, PyAny>, expected: &str) -> PyErr {
    match value.get_type().name() {
        Ok(found) => {
            PyTypeError::new_err(format!("{name} is of type {found}; {expected} is expected"))
        }
        Err(error) => error,
    }
}

/// Python's `errno.ENOENT` and `errno.EISDIR`, the same on all systems.
const NO_SUCH_FILE: i32 = 2;
const IS_A_FOLDER: i32 = 21;

/// A file that cannot be read or written; Python chooses the exception by the system's number.
pub(crate) fn os_error(path: &Path, error: &io::Error) -> PyErr {
    let text = error.to_string();
    let what = text.split(" (os error").next().unwrap_or(&text).to_owned();
    let number = error.raw_os_error().or_else(|| match path {
        _ if path.is_dir() => Some(IS_A_FOLDER),
        _ if !folder_of(path).is_dir() => Some(NO_SUCH_FILE),
        _ => None,
    });
    match number {
        Some(number) => PyOSError::new_err((number, what, path.display().to_string())),
        None => PyOSError::new_err(format!("{}: {what}", path.display())),
    }
}

/// A file that was not written.
pub(crate) fn output_error(error: &OutputError) -> PyErr {
    match error {
        OutputError::Interrupted => PyKeyboardInterrupt::new_err(()),
        OutputError::Write { path, source } => match source.downcast_ref() {
            Some(error) => os_error(path, error),
            None => PyOSError::new_err(iiwa_view::with_causes(error)),
        },
    }
}

/// The text of a file; an exception of `class` if it is none.
pub(crate) fn read_text(py: Python<'_>, path: &Path, class: &str) -> PyResult<String> {
    fs::read_to_string(path).map_err(|error| match error.kind() {
        io::ErrorKind::InvalidData => {
            exception(py, class, (format!("{}: the text is not UTF-8", path.display()),))
        }
        _ => os_error(path, &error),
    })
}

fn in_text(py: Python<'_>, class: &str, what: &str, place: &Place) -> PyErr {
    exception(py, class, (format!("{what}, at {place}"), place.line, place.column))
}

/// The number of the motion that a message begins with, as all messages about motions do.
fn motion_in(what: &str) -> Option<usize> {
    let rest = what.strip_prefix("motion ")?;
    rest[..rest.find(|c: char| !c.is_ascii_digit())?].parse().ok()
}

fn of_motion(py: Python<'_>, what: &str, place: &Place, motion: Option<usize>) -> PyErr {
    let text = format!("{what}, at {place}");
    exception(py, "ProgramError", (text, place.line, place.column, motion))
}

/// A text that is no program.
pub(crate) fn program_error(py: Python<'_>, error: &ProgramError) -> PyErr {
    let motion = motion_in(&error.what());
    let place = error.place();
    exception(py, "ProgramError", (error.to_string(), place.line, place.column, motion))
}

/// A text that is no robot profile.
pub(crate) fn profile_error(py: Python<'_>, error: &ProfileError) -> PyErr {
    in_text(py, "ProfileError", &error.what(), error.place())
}

/// A text that is no scene.
pub(crate) fn scene_error(py: Python<'_>, error: &SceneError) -> PyErr {
    in_text(py, "SceneError", &error.what(), error.place())
}

/// What a program asks for and the robot cannot do.
pub(crate) fn fault(py: Python<'_>, fault: &Fault, sources: &Sources, text: &str) -> PyErr {
    let (what, place) = (fault.to_string(), fault.place_in(text));
    of_motion(py, &sources.in_message(&what), &place, motion_in(&what))
}

/// A program without a plan.
pub(crate) fn plan_error(
    py: Python<'_>,
    error: &PlanError,
    sources: &Sources,
    text: &str,
) -> PyErr {
    match error {
        PlanError::Fault(error) => fault(py, error, sources, text),
        PlanError::Timing(TimingError::Interrupted) => PyKeyboardInterrupt::new_err(()),
        error => {
            use iiwa_json::Step::{Index, Key};
            let what = error.to_string();
            let motion = motion_in(&what);
            let at = motion.and_then(|number| number.checked_sub(1)).map(Index);
            let path: Vec<_> = std::iter::once(Key("motions")).chain(at).collect();
            let place = iiwa_json::locate(text, &path);
            of_motion(py, &sources.in_message(&what), &place, motion)
        }
    }
}
