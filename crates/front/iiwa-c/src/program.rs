//! Programs for C.

use std::{ffi::c_char, mem::MaybeUninit, path::Path};

use iiwa_plan::ProgramSource;

use crate::{
    border::{IiwasimStatus, call, required},
    pointers,
};

/// Motion program. It is immutable, and may be used by several threads at once.
#[derive(Debug)]
pub struct IiwasimProgram {
    pub(crate) source: ProgramSource,
}

/// Reads a program from its JSON text, and writes it to `*program`: `iiwasim_program_free` frees
/// it. `*program` is NULL after a failure.
///
/// Use `iiwasim_program_load` for a program that includes a file, or names the file of a robot's
/// profile.
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
        let place = required(program, "program")?.write(std::ptr::null_mut());
        // SAFETY: the caller gives the same guarantee.
        let json = unsafe { pointers::text(json, "json") }?;
        let source = ProgramSource::from_json(json)?;
        *place = Box::into_raw(Box::new(IiwasimProgram { source }));
        Ok(())
    })
}

/// Reads a program from a file, with the files that it includes or names as its robot's profile,
/// and writes it to `*program`: `iiwasim_program_free` frees it. `*program` is NULL after a
/// failure.
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
        let place = required(program, "program")?.write(std::ptr::null_mut());
        // SAFETY: the caller gives the same guarantee.
        let path = unsafe { pointers::text(path, "path") }?;
        let source = ProgramSource::load(Path::new(path))?;
        *place = Box::into_raw(Box::new(IiwasimProgram { source }));
        Ok(())
    })
}

/// Frees a program; NULL is ignored. Plans of this program remain valid.
#[unsafe(no_mangle)]
pub extern "C" fn iiwasim_program_free(program: Option<Box<IiwasimProgram>>) {
    drop(program);
}
