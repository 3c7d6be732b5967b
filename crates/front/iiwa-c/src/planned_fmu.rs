//! The files of an FMU of a plan, as C has them.

use std::{ffi::c_char, mem::MaybeUninit, ptr};

use crate::{
    border::{IiwasimStatus, call, given},
    fmu::fmu_files,
    plan::IiwasimPlan,
    planned::to_json,
    pointers,
    strings::hand_out,
};

/// Writes the text files of an FMU that does what is planned to `*json`: an object with a text for each path. Together with
/// this library as `binaries/PLATFORM/iiwasim.so`, `.dll` or `.dylib`, as FMI 3.0 names the platform, they are the FMU.
/// `iiwasim_string_free` frees it; `*json` is NULL where it fails.
///
/// # Safety
///
/// `name`, the model's, is NULL, or a string in UTF-8 that ends with a NUL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn iiwasim_plan_fmu_json(
    plan: Option<&IiwasimPlan>,
    name: *const c_char,
    json: Option<&mut MaybeUninit<*mut c_char>>,
) -> IiwasimStatus {
    call(|| {
        let json = given(json, "json")?;
        json.write(ptr::null_mut());
        let plan = given(plan, "plan")?;
        // SAFETY: the caller's promise is the same.
        let name = unsafe { pointers::text(name, "name") }?;
        hand_out(to_json(&fmu_files(&plan.planned, name)?)?, json)
    })
}
