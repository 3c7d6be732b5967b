//! The native part of the Python package `iiwasim`.

mod arrays;
mod errors;
mod evaluation;
mod frames;
mod options;
mod page;
mod plan;
mod planning;
mod program;
mod recording;
mod robot;
mod samples;
mod scene;
mod sunrise;
mod work;

use pyo3::prelude::*;

/// What is written in Rust; `iiwasim` has it all.
#[pymodule(gil_used = false)]
mod _native {
    #[pymodule_export]
    use super::{
        evaluation::{Comparison, Identification, compare, identify},
        page::page,
        plan::Plan,
        planning::{plan, plan_all},
        program::Program,
        recording::Recording,
        robot::Robot,
        samples::Samples,
        scene::{Clearance, Scene},
        sunrise::{applications, import_application},
    };
}
