//! Plans from C, C++ and C#: programs are loaded, planned and sampled through the functions of
//! `include/iiwasim.h`, which is generated from this crate. The same library is the binary of FMUs
//! for co-simulation (FMI 3.0).
//!
//! Functions take pointers as optional references, so that the compiler checks all but strings and
//! arrays; `pointers` converts those two. Panics do not cross the C interface, and functions do not
//! keep the pointers they are given, except an FMU's callback for messages.

mod border;
mod failure;
/// cbindgen:ignore
mod fmu;
mod options;
mod plan;
mod planned;
mod planned_fmu;
mod pointers;
mod program;
mod state;
mod strings;

/// Tests of the functions as C calls them, in the same test executable.
#[cfg(test)]
#[path = "../tests/functions.rs"]
mod functions;
#[cfg(test)]
extern crate self as iiwasim;

pub use border::{IiwasimError, IiwasimStatus, iiwasim_last_error};
pub use options::{IiwasimOptions, IiwasimTiming, iiwasim_options_default};
pub use plan::{
    IiwasimPlan, iiwasim_plan, iiwasim_plan_at, iiwasim_plan_cycle_time_s,
    iiwasim_plan_figures_json, iiwasim_plan_free, iiwasim_plan_sample,
};
pub use planned_fmu::iiwasim_plan_fmu_json;
pub use program::{
    IiwasimProgram, iiwasim_program_free, iiwasim_program_from_json, iiwasim_program_load,
};
pub use state::IiwasimState;
pub use strings::{iiwasim_string_free, iiwasim_version};
