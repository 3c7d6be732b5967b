//! FMU in a simulation: allowed calls, and message logging.

use std::{
    ffi::{CString, c_char, c_void},
    path::Path,
};

use super::{
    model::{FmuModel, Misuse, Moment},
    resources,
};
use crate::{border::caught, failure::CallFailure};

/// `fmi3Status`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(dead_code, reason = "all of the standard's")]
pub(super) enum FmiStatus {
    Ok = 0,
    Warning = 1,
    Discard = 2,
    Error = 3,
    Fatal = 4,
}

/// `fmi3LogMessageCallback`: the environment, the status, the category, the message.
pub(super) type LogMessage =
    unsafe extern "C" fn(*mut c_void, FmiStatus, *const c_char, *const c_char);

/// Destination of messages.
#[derive(Debug)]
pub(super) struct Logger {
    pub(super) environment: *mut c_void,
    pub(super) log: Option<LogMessage>,
}

impl Logger {
    fn error(&self, status: FmiStatus, message: &str) {
        let Some(log) = self.log else { return };
        let message = CString::new(message.replace('\0', "\u{fffd}")).unwrap_or_default();
        // SAFETY: the importer provides function and environment for this; both texts end with a
        // NUL and outlive the call.
        unsafe { log(self.environment, status, c"logStatusError".as_ptr(), message.as_ptr()) }
    }
}

/// Reason for rejecting a call.
#[derive(Debug)]
pub(super) struct CallRefusal {
    status: FmiStatus,
    message: String,
}

impl CallRefusal {
    pub(super) fn error(message: impl Into<String>) -> Self {
        Self { status: FmiStatus::Error, message: message.into() }
    }
}

impl From<Misuse> for CallRefusal {
    fn from(misuse: Misuse) -> Self {
        match misuse {
            Misuse::OutOfRange(message) => Self { status: FmiStatus::Discard, message },
            Misuse::Illegal(message) => Self::error(message),
        }
    }
}

impl From<CallFailure> for CallRefusal {
    fn from(failure: CallFailure) -> Self {
        Self::error(failure.message)
    }
}

/// Mode of an instance in the standard's state machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    Instantiated,
    Initialization,
    Step,
    Terminated,
}

/// FMU in a simulation. Instances share no state.
#[derive(Debug)]
pub(super) struct FmuInstance {
    pub(super) model: FmuModel,
    pub(super) mode: Mode,
    logger: Logger,
}

/// State that `fmi3SetFMUState` restores.
#[derive(Clone, Copy, Debug)]
pub(super) struct Snapshot {
    moment: Moment,
    mode: Mode,
}

impl FmuInstance {
    /// Plans the program of an FMU; if that fails, logs a message and returns `None`.
    ///
    /// `arguments` returns the instantiation token, and the folder of the resources.
    pub(super) fn new<'a>(
        arguments: impl FnOnce() -> Result<(&'a str, &'a str), CallFailure>,
        logger: Logger,
    ) -> Option<Box<Self>> {
        let model = caught(|| {
            let (token, folder) = arguments()?;
            Ok(FmuModel::new(resources::plan(Path::new(folder), token)?))
        });
        match model {
            Ok(model) => Some(Box::new(Self { model, mode: Mode::Instantiated, logger })),
            Err(failure) => {
                logger.error(FmiStatus::Error, &failure.message);
                None
            }
        }
    }

    /// Changes from one mode to another.
    pub(super) fn change(&mut self, from: Mode, to: Mode) -> Result<(), CallRefusal> {
        self.is_in(from)?;
        self.mode = to;
        Ok(())
    }

    pub(super) fn is_in(&self, mode: Mode) -> Result<(), CallRefusal> {
        if self.mode == mode {
            return Ok(());
        }
        Err(CallRefusal::error(format!(
            "the call is for an FMU in the state {mode:?}, and it is in the state {:?}",
            self.mode
        )))
    }

    pub(super) fn snapshot(&self) -> Snapshot {
        Snapshot { moment: self.model.moment(), mode: self.mode }
    }

    pub(super) fn restore(&mut self, Snapshot { moment, mode }: Snapshot) {
        self.model.restore(moment);
        self.mode = mode;
    }
}

/// Runs a function, logs the reason for its failure, and catches panics.
pub(super) fn call(
    instance: Option<&mut FmuInstance>,
    work: impl FnOnce(&mut FmuInstance) -> Result<(), CallRefusal>,
) -> FmiStatus {
    let Some(instance) = instance else { return FmiStatus::Error };
    match caught(|| Ok(work(instance))).unwrap_or_else(|failure| Err(failure.into())) {
        Ok(()) => FmiStatus::Ok,
        Err(CallRefusal { status, message }) => {
            instance.logger.error(status, &message);
            status
        }
    }
}
