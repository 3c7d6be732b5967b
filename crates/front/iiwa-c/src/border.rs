//! Results of calls: a status, and the last error of the thread.

use std::{
    cell::RefCell,
    ffi::{CString, c_char},
    mem::MaybeUninit,
    panic::{AssertUnwindSafe, catch_unwind},
    ptr,
};

use iiwa_program::MotionIndex;

use crate::failure::{CallFailure, FailureKind};

/// Status of a call.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IiwasimStatus {
    /// The call succeeded.
    Ok = 0,
    /// An argument is NULL or out of range.
    Argument = 1,
    /// A file cannot be read.
    File = 2,
    /// The program or the robot's profile is invalid.
    Program = 3,
    /// The robot cannot perform the program.
    Plan = 4,
    /// A fault of this library; please report it.
    Internal = 5,
}

impl From<FailureKind> for IiwasimStatus {
    fn from(kind: FailureKind) -> Self {
        match kind {
            FailureKind::Argument => Self::Argument,
            FailureKind::File => Self::File,
            FailureKind::Program => Self::Program,
            FailureKind::Plan => Self::Plan,
            FailureKind::Internal => Self::Internal,
        }
    }
}

/// Reason for the failure of the last call of this thread.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IiwasimError {
    /// Status that the call returned.
    pub status: IiwasimStatus,
    /// Line in the program's text, from 1; 0 if the error has no place in the text.
    pub line: u32,
    /// Column in characters, from 1; 0 as for `line`.
    pub column: u32,
    /// Motion of the program, from 1; 0 if the error concerns no motion.
    pub motion: u32,
    /// Message with the fault, its place and its remedy, in UTF-8; empty after a call that
    /// succeeded.
    pub message: *const c_char,
}

/// Error, and the text that it points to.
struct LastError {
    error: IiwasimError,
    message: CString,
}

impl LastError {
    fn new(failure: Option<&CallFailure>) -> Self {
        let number = |n: Option<usize>| n.and_then(|n| u32::try_from(n).ok()).unwrap_or_default();
        let place = failure.and_then(|failure| failure.place);
        let text = failure.map_or("", |failure| &failure.message).replace('\0', "\u{fffd}");
        let mut failure = Self {
            error: IiwasimError {
                status: failure.map_or(IiwasimStatus::Ok, |failure| failure.kind.into()),
                line: number(place.map(|place| place.0)),
                column: number(place.map(|place| place.1)),
                motion: number(failure.and_then(|it| it.motion).map(MotionIndex::number)),
                message: ptr::null(),
            },
            message: CString::new(text).unwrap_or_default(),
        };
        failure.error.message = failure.message.as_ptr();
        failure
    }
}

thread_local! {
    static LAST: RefCell<LastError> = RefCell::new(LastError::new(None));
}

/// Runs a function, stores the reason for its failure, and catches panics.
pub(crate) fn call(work: impl FnOnce() -> Result<(), CallFailure>) -> IiwasimStatus {
    let failure = caught(work).err();
    let last = LastError::new(failure.as_ref());
    let status = last.error.status;
    // A thread that is ending stores no error.
    let _ = LAST.try_with(|place| *place.borrow_mut() = last);
    status
}

/// Returns the result, or converts a panic to a failure.
pub(crate) fn caught<T>(work: impl FnOnce() -> Result<T, CallFailure>) -> Result<T, CallFailure> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let message = panic
            .downcast_ref::<String>()
            .map(String::as_str)
            .or_else(|| panic.downcast_ref::<&str>().copied())
            .unwrap_or("for no stated reason");
        Err(CallFailure::new(
            FailureKind::Internal,
            format!("the library failed; please report it, with the program: {message}"),
        ))
    })
}

/// Returns an argument that must not be NULL.
pub(crate) fn required<T>(argument: Option<T>, name: &str) -> Result<T, CallFailure> {
    argument.ok_or_else(|| CallFailure::argument(format!("{name} is NULL")))
}

/// Writes the reason for the failure of the last call of this thread to `*error`. Its message is
/// valid until the next call of this thread.
///
/// Returns `IIWASIM_STATUS_ARGUMENT` if `error` is NULL, and keeps the error then.
#[unsafe(no_mangle)]
pub extern "C" fn iiwasim_last_error(
    error: Option<&mut MaybeUninit<IiwasimError>>,
) -> IiwasimStatus {
    let Some(error) = error else { return IiwasimStatus::Argument };
    match LAST.try_with(|last| last.borrow().error) {
        Ok(last) => {
            error.write(last);
            IiwasimStatus::Ok
        }
        Err(_) => IiwasimStatus::Internal,
    }
}

#[cfg(test)]
mod tests {
    use std::{ffi::CStr, mem::MaybeUninit};

    use super::{IiwasimStatus, call, iiwasim_last_error};

    #[test]
    fn a_panic_is_an_error() {
        let status = call(|| panic!("at the {}th joint", 8));
        assert_eq!(status, IiwasimStatus::Internal);
        let mut error = MaybeUninit::uninit();
        assert_eq!(iiwasim_last_error(Some(&mut error)), IiwasimStatus::Ok);
        // SAFETY: `error` was written, and its message ends with a NUL.
        let message = unsafe { CStr::from_ptr(error.assume_init().message) };
        assert!(message.to_str().unwrap().ends_with("with the program: at the 8th joint"));
    }
}
