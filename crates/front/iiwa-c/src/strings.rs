//! Strings that are handed out.

use std::{
    ffi::{CString, c_char},
    mem::MaybeUninit,
};

use crate::failure::{Failure, FailureKind};

/// The library's version, such as `0.1.0`. It is not to be freed.
#[unsafe(no_mangle)]
pub extern "C" fn iiwasim_version() -> *const c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}

/// Frees a string that a function has written; NULL is left alone.
///
/// # Safety
///
/// `string` is NULL, or was written by this library and not freed yet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn iiwasim_string_free(string: *mut c_char) {
    if !string.is_null() {
        // SAFETY: the caller promises that it comes from `hand_out`.
        drop(unsafe { CString::from_raw(string) });
    }
}

/// Hands a text out, which is then the caller's to free.
pub(crate) fn hand_out(text: String, place: &mut MaybeUninit<*mut c_char>) -> Result<(), Failure> {
    let text = CString::new(text).map_err(|error| {
        Failure::new(FailureKind::Internal, format!("a text with a NUL: {error}"))
    })?;
    place.write(text.into_raw());
    Ok(())
}
