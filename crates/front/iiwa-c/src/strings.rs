//! Strings that callers own.

use std::{
    ffi::{CString, c_char},
    mem::MaybeUninit,
};

use crate::failure::{CallFailure, FailureKind};

/// Returns the version of the library, such as `0.1.0`. It must not be freed.
#[unsafe(no_mangle)]
pub extern "C" fn iiwasim_version() -> *const c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}

/// Frees a string written by a function of this library; NULL is ignored.
///
/// # Safety
///
/// `string` is NULL, or was written by this library and has not been freed yet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn iiwasim_string_free(string: *mut c_char) {
    if !string.is_null() {
        // SAFETY: the caller guarantees that the string comes from `hand_out`.
        drop(unsafe { CString::from_raw(string) });
    }
}

/// Passes a text to the caller, who must free it.
pub(crate) fn hand_out(
    text: String,
    place: &mut MaybeUninit<*mut c_char>,
) -> Result<(), CallFailure> {
    let text = CString::new(text).map_err(|error| {
        CallFailure::new(FailureKind::Internal, format!("a text with a NUL: {error}"))
    })?;
    place.write(text.into_raw());
    Ok(())
}
