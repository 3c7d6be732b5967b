//! Conversion of C strings and arrays: raw pointers are read only in this module.

use std::{
    ffi::{CStr, c_char},
    mem::MaybeUninit,
    slice,
};

use crate::failure::CallFailure;

/// Converts a mandatory text; `name` names it in errors.
///
/// # Safety
///
/// `text` is NULL or a string that ends with a NUL and does not change during `'a`.
pub(crate) unsafe fn text<'a>(text: *const c_char, name: &str) -> Result<&'a str, CallFailure> {
    // SAFETY: the caller gives the same guarantee.
    unsafe { optional_text(text, name) }?
        .ok_or_else(|| CallFailure::argument(format!("{name} is NULL")))
}

/// Converts a text that may be NULL.
///
/// # Safety
///
/// See [`text`].
pub(crate) unsafe fn optional_text<'a>(
    text: *const c_char,
    name: &str,
) -> Result<Option<&'a str>, CallFailure> {
    if text.is_null() {
        return Ok(None);
    }
    // SAFETY: `text` is not NULL, and the caller guarantees the rest.
    let text = unsafe { CStr::from_ptr(text) };
    match text.to_str() {
        Ok(text) => Ok(Some(text)),
        Err(error) => Err(CallFailure::argument(format!("{name} is not UTF-8 text: {error}"))),
    }
}

/// Converts an array of values.
///
/// # Safety
///
/// `values` is NULL, or has `count` values that do not change during `'a`.
pub(crate) unsafe fn values<'a, T>(
    values: *const T,
    count: usize,
    name: &str,
) -> Result<&'a [T], CallFailure> {
    match (values.is_null(), count) {
        (_, 0) => Ok(&[]),
        (true, _) => Err(CallFailure::argument(format!("{name} is NULL"))),
        // SAFETY: `values` is not NULL, and the caller guarantees the rest.
        (false, _) => Ok(unsafe { slice::from_raw_parts(values, count) }),
    }
}

/// Converts an array to be written, which may be uninitialised.
///
/// # Safety
///
/// `places` is NULL, or has room for `count` values, which nothing else reads or writes during
/// `'a`.
pub(crate) unsafe fn places<'a, T>(
    places: *mut T,
    count: usize,
    name: &str,
) -> Result<&'a mut [MaybeUninit<T>], CallFailure> {
    match (places.is_null(), count) {
        (_, 0) => Ok(&mut []),
        (true, _) => Err(CallFailure::argument(format!("{name} is NULL"))),
        // SAFETY: `places` is not NULL, and the caller guarantees the rest; any bytes are a valid
        // `MaybeUninit`.
        (false, _) => Ok(unsafe { slice::from_raw_parts_mut(places.cast(), count) }),
    }
}
