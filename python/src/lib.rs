//! The native part of the Python package `iiwasim`.

// Methods for Python take what PyO3 gives them, and return Python's `None`; docstrings are its own.
#![allow(
    clippy::doc_link_with_quotes,
    clippy::doc_markdown,
    clippy::missing_errors_doc,
    clippy::must_use_candidate,
    clippy::needless_pass_by_value,
    clippy::unnecessary_wraps
)]

mod arguments;
mod arrays;
mod errors;
mod evaluation;
mod frames;
mod optimise;
mod options;
mod order;
mod page;
mod place;
mod plan;
mod planning;
mod program;
mod recording;
mod robot;
mod samples;
mod scene;
mod search;
mod sunrise;
mod work;

use pyo3::{prelude::*, types::PyTuple};

/// A pickled object: the function that restores it, and its arguments.
type Pickled<'py> = (Bound<'py, PyAny>, Bound<'py, PyTuple>);

/// The native part of the package; `iiwasim` exports all of it.
#[pymodule(gil_used = false)]
mod _native {
    use numpy::PyArray1;
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::{
        evaluation::{Comparison, Identification, compare, identify},
        frames::{frame, pose},
        optimise::{Optimum, optimise},
        order::{TaskOrder, order},
        page::page,
        place::{PlaceMap, place},
        plan::Plan,
        planning::{plan, plan_all},
        program::Program,
        recording::Recording,
        robot::Robot,
        samples::Samples,
        scene::{Clearance, Scene},
        sunrise::{applications, import_application},
    };

    /// Loads NumPy's C API on import: Ctrl-C could interrupt a later load, with the first array.
    #[pymodule_init]
    fn load_numpy(module: &Bound<'_, PyModule>) -> PyResult<()> {
        PyArray1::<f64>::zeros(module.py(), 0, false);
        Ok(())
    }
}
