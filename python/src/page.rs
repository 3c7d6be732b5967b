//! Pages of recorded plans and measurements.

use std::path::PathBuf;

use iiwa_page::{Page, PageOptions};
use iiwa_report::with_causes;
use pyo3::{exceptions::PyValueError, prelude::*};
use rayon::ThreadPoolBuilder;

use crate::{scene::Scene, work::interruptible};

/// The page of a plan's or a recording's file, with that of a measurement beside it: HTML.
#[pyfunction]
#[pyo3(signature = (file, measured = None, scene = None))]
pub(crate) fn page(
    py: Python<'_>,
    file: PathBuf,
    measured: Option<PathBuf>,
    scene: Option<&Bound<'_, Scene>>,
) -> PyResult<String> {
    let scene = scene.map(|scene| (*scene.get().parsed).clone());
    let work = move |_| -> Result<String, String> {
        let options = PageOptions { scene, ..PageOptions::default() };
        // A pool that ends here: see `interruptible`.
        let pool = ThreadPoolBuilder::new().build().map_err(|error| error.to_string())?;
        pool.install(|| {
            Page::read(&file, measured.as_deref(), &options)
                .and_then(|page| page.html())
                .map_err(|error| with_causes(&error))
        })
    };
    interruptible(py, work, |_| Ok(()))?.map_err(PyValueError::new_err)
}
