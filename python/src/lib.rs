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

use pyo3::{prelude::*, types::PyTuple};

/// What makes an object again where it is unpickled: a function and its arguments.
type Pickled<'py> = (Bound<'py, PyAny>, Bound<'py, PyTuple>);

/// What is written in Rust; `iiwasim` has it all.
#[pymodule(gil_used = false)]
mod _native {
    use numpy::PyArray1;
    use pyo3::prelude::*;

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

    /// Loads numpy's part: where an array is made first, Ctrl-C could come in between.
    #[pymodule_init]
    fn load_numpy(module: &Bound<'_, PyModule>) -> PyResult<()> {
        PyArray1::<f64>::zeros(module.py(), 0, false);
        Ok(())
    }
}
