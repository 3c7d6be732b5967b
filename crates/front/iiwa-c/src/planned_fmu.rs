//! FMU files of a plan, for C.

use std::{ffi::c_char, mem::MaybeUninit, ptr};

use crate::{
    border::{IiwasimStatus, call, required},
    fmu::fmu_files,
    plan::IiwasimPlan,
    planned::to_json,
    pointers,
    strings::hand_out,
};

/// Writes the text files of an FMU that runs the plan to `*json`: an object with a text for each
/// path. Together with this library as `binaries/PLATFORM/iiwasim.so`, `.dll` or `.dylib`, where
/// FMI 3.0 defines the platform names, these files are the FMU. `iiwasim_string_free` frees the
/// text; `*json` is NULL after a failure.
///
/// # Safety
///
/// `name`, the name of the model, is NULL, or a string in UTF-8 that ends with a NUL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn iiwasim_plan_fmu_json(
    plan: Option<&IiwasimPlan>,
    name: *const c_char,
    json: Option<&mut MaybeUninit<*mut c_char>>,
) -> IiwasimStatus {
    call(|| {
        let json = required(json, "json")?;
        json.write(ptr::null_mut());
        let plan = required(plan, "plan")?;
        // SAFETY: the caller gives the same guarantee.
        let name = unsafe { pointers::text(name, "name") }?;
        hand_out(to_json(&fmu_files(&plan.planned, name)?)?, json)
    })
}
