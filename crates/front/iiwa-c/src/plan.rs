//! Plans for C.

use std::{ffi::c_char, mem::MaybeUninit, ptr};

use crate::{
    border::{IiwasimStatus, call, required},
    failure::CallFailure,
    options::IiwasimOptions,
    planned::{Choices, PlannedProgram},
    pointers,
    program::IiwasimProgram,
    state::IiwasimState,
    strings::hand_out,
};

/// Plan of a program. It is immutable, and may be used by several threads at once.
#[derive(Debug)]
pub struct IiwasimPlan {
    pub(crate) planned: PlannedProgram,
}

/// Maximum number of samples at once: a gigabyte.
const MAX_SAMPLES: f64 = 4e6;

/// Plans a program, and writes the plan to `*plan`: `iiwasim_plan_free` frees it. `*plan` is NULL
/// after a failure. Without `options` (NULL) the default options apply.
///
/// # Safety
///
/// `options->robot` is NULL, or a string that ends with a NUL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn iiwasim_plan(
    program: Option<&IiwasimProgram>,
    options: Option<&IiwasimOptions>,
    plan: Option<&mut MaybeUninit<*mut IiwasimPlan>>,
) -> IiwasimStatus {
    call(|| {
        let place = required(plan, "plan")?.write(ptr::null_mut());
        let program = required(program, "program")?;
        let (robot, choices) = match options {
            None => (None, Choices::default()),
            // SAFETY: the caller gives the same guarantee.
            Some(options) => unsafe { options.read() }?,
        };
        let planned = PlannedProgram::new(&program.source, robot, choices)?;
        *place = Box::into_raw(Box::new(IiwasimPlan { planned }));
        Ok(())
    })
}

/// Frees a plan; NULL is ignored.
#[unsafe(no_mangle)]
pub extern "C" fn iiwasim_plan_free(plan: Option<Box<IiwasimPlan>>) {
    drop(plan);
}

/// Writes the cycle time to `*seconds`: from the start to the end of the last settle time or wait,
/// in s.
#[unsafe(no_mangle)]
pub extern "C" fn iiwasim_plan_cycle_time_s(
    plan: Option<&IiwasimPlan>,
    seconds: Option<&mut MaybeUninit<f64>>,
) -> IiwasimStatus {
    call(|| {
        let plan = required(plan, "plan")?;
        required(seconds, "seconds")?.write(plan.planned.trajectory().cycle_time_s());
        Ok(())
    })
}

/// Writes the state of the arm `t_s` after the start of the program to `*state`. Before the start
/// and after the end the arm is at rest.
#[unsafe(no_mangle)]
pub extern "C" fn iiwasim_plan_at(
    plan: Option<&IiwasimPlan>,
    t_s: f64,
    state: Option<&mut MaybeUninit<IiwasimState>>,
) -> IiwasimStatus {
    call(|| {
        let planned = &required(plan, "plan")?.planned;
        let place = required(state, "state")?;
        if t_s.is_nan() {
            return Err(CallFailure::argument("t_s is not a number"));
        }
        place.write(IiwasimState::of(planned, &planned.trajectory().at(t_s)));
        Ok(())
    })
}

/// Writes the states of the arm at `rate_hz` samples per second to `states`, from the start to the
/// end: the first sample is at 0, the last exactly at the cycle time. `*count` is the number of
/// samples.
///
/// With `states` NULL and `capacity` 0 the function only counts. If `capacity` is too small, it
/// writes `capacity` states, and returns `IIWASIM_STATUS_ARGUMENT`.
///
/// # Safety
///
/// `states` is NULL, or has room for `capacity` states.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn iiwasim_plan_sample(
    plan: Option<&IiwasimPlan>,
    rate_hz: f64,
    states: *mut IiwasimState,
    capacity: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> IiwasimStatus {
    call(|| {
        let planned = &required(plan, "plan")?.planned;
        let count_place = required(count, "count")?;
        let samples = rate_hz * planned.trajectory().cycle_time_s();
        if !(rate_hz > 0.0 && samples <= MAX_SAMPLES) {
            return Err(CallFailure::argument(format!(
                "rate_hz is {rate_hz}; it must be above 0, and give at most {MAX_SAMPLES} samples"
            )));
        }
        // SAFETY: the caller guarantees room for `capacity` states.
        let places = unsafe { pointers::places(states, capacity, "states") }?;
        let mut count = 0;
        for state in planned.trajectory().samples(rate_hz) {
            if let Some(place) = places.get_mut(count) {
                place.write(IiwasimState::of(planned, &state));
            }
            count += 1;
        }
        count_place.write(count);
        if count > capacity && !states.is_null() {
            return Err(CallFailure::argument(format!(
                "there are {count} samples; the array has a capacity of {capacity}"
            )));
        }
        Ok(())
    })
}

/// Writes the figures to `*json`: the object of `iiwasim plan --json`, without `output`.
/// `iiwasim_string_free` frees it; `*json` is NULL after a failure.
#[unsafe(no_mangle)]
pub extern "C" fn iiwasim_plan_figures_json(
    plan: Option<&IiwasimPlan>,
    json: Option<&mut MaybeUninit<*mut c_char>>,
) -> IiwasimStatus {
    call(|| {
        let json = required(json, "json")?;
        json.write(ptr::null_mut());
        hand_out(required(plan, "plan")?.planned.figures_json()?, json)
    })
}
