//! Pages of recorded plans and measurements.

use std::path::PathBuf;

use iiwa_page::{Page, PageOptions};
use iiwa_report::with_causes;
use pyo3::{exceptions::PyValueError, prelude::*};
use rayon::ThreadPoolBuilder;

use crate::{scene::Scene, work::interruptible};

/// The HTML page of a plan or recording file, with a second file as measurement.
#[pyfunction]
#[pyo3(signature = (file, measured = None, scene = None))]
pub(crate) fn page(
    py: Python<'_>,
    file: PathBuf,
    measured: Option<PathBuf>,
    scene: Option<&Bound<'_, Scene>>,
) -> PyResult<String> {
    for file in [Some(&file), measured.as_ref()].into_iter().flatten() {
        // Reading a pipe could not be interrupted.
        if file.metadata().is_ok_and(|kind| !kind.is_file() && !kind.is_dir()) {
            let name = file.display();
            return Err(PyValueError::new_err(format!("{name} is a pipe or a device, not a file")));
        }
    }
    let scene = scene.map(|scene| (*scene.get().parsed).clone());
    let work = move |_| -> Result<String, String> {
        let options = PageOptions { scene, ..PageOptions::default() };
        // A local pool: threads of the global pool do not exist in a forked process.
        let pool = ThreadPoolBuilder::new().build().map_err(|error| error.to_string())?;
        pool.install(|| {
            Page::read(&file, measured.as_deref(), &options)
                .and_then(|page| page.html())
                .map_err(|error| with_causes(&error))
        })
    };
    interruptible(py, work, |_| Ok(()))?.map_err(PyValueError::new_err)
}
