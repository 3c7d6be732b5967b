//! Strings and arrays of C as those of Rust: here, and nowhere else, raw pointers are read.

use std::{
    ffi::{CStr, c_char},
    mem::MaybeUninit,
    slice,
};

use crate::failure::Failure;

/// A text that has to be given; `what` names it in errors.
///
/// # Safety
///
/// `text` is NULL or a string that ends with a NUL and stays as it is for `'a`.
pub(crate) unsafe fn text<'a>(text: *const c_char, what: &str) -> Result<&'a str, Failure> {
    // SAFETY: the caller's promise is the same.
    unsafe { optional_text(text, what) }?
        .ok_or_else(|| Failure::argument(format!("{what} is NULL")))
}

/// A text that may be NULL.
///
/// # Safety
///
/// As of [`text`].
pub(crate) unsafe fn optional_text<'a>(
    text: *const c_char,
    what: &str,
) -> Result<Option<&'a str>, Failure> {
    if text.is_null() {
        return Ok(None);
    }
    // SAFETY: it is not NULL, and the caller promises the rest.
    let text = unsafe { CStr::from_ptr(text) };
    match text.to_str() {
        Ok(text) => Ok(Some(text)),
        Err(error) => Err(Failure::argument(format!("{what} is no text in UTF-8: {error}"))),
    }
}

/// The values of an array.
///
/// # Safety
///
/// `values` is NULL, or has `count` values that stay as they are for `'a`.
pub(crate) unsafe fn values<'a, T>(
    values: *const T,
    count: usize,
    what: &str,
) -> Result<&'a [T], Failure> {
    match (values.is_null(), count) {
        (_, 0) => Ok(&[]),
        (true, _) => Err(Failure::argument(format!("{what} is NULL"))),
        // SAFETY: it is not NULL, and the caller promises the rest.
        (false, _) => Ok(unsafe { slice::from_raw_parts(values, count) }),
    }
}

/// An array to be written, whatever is in it.
///
/// # Safety
///
/// `places` is NULL, or has room for `count` values, which nothing else reads or writes during `'a`.
pub(crate) unsafe fn places<'a, T>(
    places: *mut T,
    count: usize,
    what: &str,
) -> Result<&'a mut [MaybeUninit<T>], Failure> {
    match (places.is_null(), count) {
        (_, 0) => Ok(&mut []),
        (true, _) => Err(Failure::argument(format!("{what} is NULL"))),
        // SAFETY: it is not NULL, and the caller promises the rest; any bytes are a `MaybeUninit`.
        (false, _) => Ok(unsafe { slice::from_raw_parts_mut(places.cast(), count) }),
    }
}
