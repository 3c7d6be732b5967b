//! Programs, as C has them.

use std::{ffi::c_char, mem::MaybeUninit, path::Path};

use iiwa_plan::ProgramSource;

use crate::{
    border::{IiwasimStatus, call, given},
    pointers,
};

/// A motion program. It does not change, and may be used by several threads at once.
#[derive(Debug)]
pub struct IiwasimProgram {
    pub(crate) source: ProgramSource,
}

/// Reads a program from its JSON text, and writes it to `*program`: `iiwasim_program_free` frees it. `*program` is NULL
/// where it fails.
///
/// A program that includes a file, or names a robot's profile by its file, is loaded by `iiwasim_program_load`.
///
/// # Safety
///
/// `json` is NULL, or a string that ends with a NUL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn iiwasim_program_from_json(
    json: *const c_char,
    program: Option<&mut MaybeUninit<*mut IiwasimProgram>>,
) -> IiwasimStatus {
    call(|| {
        let place = given(program, "program")?.write(std::ptr::null_mut());
        // SAFETY: the caller's promise is the same.
        let json = unsafe { pointers::text(json, "json") }?;
        let source = ProgramSource::from_json(json)?;
        *place = Box::into_raw(Box::new(IiwasimProgram { source }));
        Ok(())
    })
}

/// Reads a program from a file, with the files beside it that it includes or names as its robot's profile, and writes it to
/// `*program`: `iiwasim_program_free` frees it. `*program` is NULL where it fails.
///
/// # Safety
///
/// `path` is NULL, or a string in UTF-8 that ends with a NUL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn iiwasim_program_load(
    path: *const c_char,
    program: Option<&mut MaybeUninit<*mut IiwasimProgram>>,
) -> IiwasimStatus {
    call(|| {
        let place = given(program, "program")?.write(std::ptr::null_mut());
        // SAFETY: the caller's promise is the same.
        let path = unsafe { pointers::text(path, "path") }?;
        let source = ProgramSource::load(Path::new(path))?;
        *place = Box::into_raw(Box::new(IiwasimProgram { source }));
        Ok(())
    })
}

/// Frees a program; NULL is left alone. Plans that were made of it stay.
#[unsafe(no_mangle)]
pub extern "C" fn iiwasim_program_free(program: Option<Box<IiwasimProgram>>) {
    drop(program);
}
