//! Recordings.

use std::{
    io::{Cursor, Read},
    mem,
    path::{Path, PathBuf},
    sync::Arc,
};

use iiwa_files::InputFile;
use iiwa_kin::Joints;
use iiwa_log::{JointLog, JointLogError};
use numpy::{Ix1, PyArray1, PyArrayDyn, PyArrayLike1, PyArrayLike2};
use pyo3::{exceptions::PyValueError, prelude::*, sync::PyOnceLock};

use crate::{
    Pickled,
    arrays::{JointsLike, RealArray, Rows, joint_array, shared},
    errors::{exception, os_error, read_input},
    options::log_options,
    program::Program,
};

/// Recorded joint positions with their times, and further data of the file. Immutable.
///
/// `t` (n,) is in s and increases strictly, `q` (n, 7) is in rad. Their getters always return the
/// same read-only arrays.
///
/// >>> import iiwasim as iw
/// >>> iw.Recording([0.0, 0.01, 0.02], [[0.0] * 7] * 3)
/// <iiwasim.Recording 3 samples, 0.020 s>
#[pyclass(frozen, module = "iiwasim")]
pub(crate) struct Recording {
    pub(crate) log: Arc<JointLog>,
    /// Computed on first access.
    t: PyOnceLock<Py<PyArray1<f64>>>,
    q: PyOnceLock<Py<PyArrayDyn<f64>>>,
}

impl Recording {
    fn of(log: JointLog) -> Self {
        Self { log: Arc::new(log), t: PyOnceLock::new(), q: PyOnceLock::new() }
    }
}

/// Opens a file. A pipe is read to its end, until which Ctrl-C can end the wait.
fn open(py: Python<'_>, path: &Path) -> PyResult<Box<dyn Read + Send>> {
    let input = InputFile::open(path).map_err(|error| os_error(path, &error))?;
    if input.is_pipe() {
        return Ok(Box::new(Cursor::new(read_input(py, path, input)?)));
    }
    Ok(Box::new(input))
}

/// A `RecordingError` for an invalid recording.
pub(crate) fn recording_error(py: Python<'_>, name: &str, error: &JointLogError) -> PyErr {
    exception(py, "RecordingError", (format!("{name}: {}", iiwa_report::with_causes(error)),))
}

#[pymethods]
impl Recording {
    #[new]
    #[pyo3(signature = (t, q, *, cycle_time_s = None, program = None))]
    fn new<'py>(
        py: Python<'py>,
        t: RealArray<'py, Ix1>,
        q: JointsLike<'py>,
        cycle_time_s: Option<f64>,
        program: Option<&Bound<'py, Program>>,
    ) -> PyResult<Self> {
        let t: Vec<f64> = t.as_array().iter().copied().collect();
        let rows = Rows::new("q", &q)?;
        if rows.is_single || rows.joints.len() != t.len() {
            return Err(PyValueError::new_err(format!(
                "q has to be of the shape ({}, 7), a row for each time in t",
                t.len()
            )));
        }
        if !t.iter().all(|t| t.is_finite()) || t.windows(2).any(|pair| pair[1] <= pair[0]) {
            return Err(PyValueError::new_err("t has to be finite and to increase strictly"));
        }
        if cycle_time_s.is_some_and(|time_s| !(time_s >= 0.0 && time_s.is_finite())) {
            return Err(PyValueError::new_err("cycle_time_s has to be finite, and not negative"));
        }
        let mut log = JointLog::new(t, rows.joints.into_owned());
        log.cycle_time_s = cycle_time_s;
        if let Some(program) = program.map(Bound::get) {
            let robot = program.model();
            log.program = Some(program.text().to_owned());
            log.robot = Some(robot.name().to_owned());
            // The differences from a built-in model, so that its assumptions are kept.
            log.profile = Some(robot.to_profile());
        }
        log.check_rate().map_err(|error| recording_error(py, "the recording", &error))?;
        Ok(Self::of(log))
    }

    /// Reads a recording from a file: MCAP (also of a plan), CSV, or a log of KUKA's DataRecorder.
    /// Raises `RecordingError`.
    ///
    /// `unit`, 'rad' or 'deg', applies to positions whose columns do not name a unit. Without
    /// `unit`, DataRecorder positions are taken as degrees if one of them is outside all joint
    /// ranges in rad, and `losses` says so. `positions` selects 'measured' or 'commanded' positions
    /// if a DataRecorder log has both.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Recording.load('fixtures/data-recorder.log')
    /// <iiwasim.Recording ...>
    #[staticmethod]
    #[pyo3(signature = (path, *, unit = None, positions = "measured"))]
    fn load(py: Python<'_>, path: PathBuf, unit: Option<&str>, positions: &str) -> PyResult<Self> {
        let options = log_options(unit, positions)?;
        let name = path.display().to_string();
        let file = open(py, &path)?;
        let log = py.detach(|| {
            JointLog::read_with(file, options).and_then(|log| log.check_rate().map(|()| log))
        });
        let log = log.map_err(|error| recording_error(py, &name, &error))?;
        Ok(Self::of(log))
    }

    /// Times (n,), in s.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Recording([0.0, 0.01], [[0.0] * 7] * 2).t.tolist()
    /// [0.0, 0.01]
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let made = self.t.get_or_init(py, || shared(PyArray1::from_slice(py, &self.log.t_s)));
        made.bind(py).clone()
    }

    /// Positions (n, 7), in rad.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Recording([0.0, 0.01], [[0.0] * 7] * 2).q.shape
    /// (2, 7)
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let made = self.q.get_or_try_init(py, || {
            Ok::<_, PyErr>(shared(joint_array(py, self.log.q_rad.clone())?.into_bound(py)))
        })?;
        Ok(made.bind(py).clone())
    }

    /// Joint torques (n, 7), in Nm, NaN where they are missing; `None` if the file has no torques.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Recording([0.0, 0.01], [[0.0] * 7] * 2).torque is None
    /// True
    #[getter]
    fn torque(&self, py: Python<'_>) -> PyResult<Option<Py<PyArrayDyn<f64>>>> {
        if self.log.torques_nm.iter().all(Option::is_none) {
            return Ok(None);
        }
        let rows = self.log.exerted_nm().map(|torque| torque.unwrap_or([f64::NAN; 7])).collect();
        joint_array(py, rows).map(Some)
    }

    /// The cycle time stated in the recording, in s, if any.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Recording([0.0, 0.01], [[0.0] * 7] * 2, cycle_time_s=0.01).cycle_time_s
    /// 0.01
    #[getter]
    fn cycle_time_s(&self) -> Option<f64> {
        self.log.cycle_time_s
    }

    /// Time from the first to the last sample, in s.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Recording([0.0, 0.01], [[0.0] * 7] * 2).duration_s
    /// 0.01
    #[getter]
    fn duration_s(&self) -> f64 {
        self.log.duration_s()
    }

    /// The program of the run, if the recording contains it.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Recording([0.0, 0.01], [[0.0] * 7] * 2).program is None
    /// True
    #[getter]
    fn program(&self, py: Python<'_>) -> PyResult<Option<Program>> {
        let robot = self.log.recorded_robot().ok().flatten();
        let program = self.log.program.as_deref().map(|text| {
            iiwa_program::Program::from_json(text)
                .map_err(|error| crate::errors::program_error(py, &error))
                .and_then(|program| Program::of(py, program, robot))
        });
        program.transpose()
    }

    /// Descriptions of missing or lost data, in the order of time.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Recording([0.0, 0.01], [[0.0] * 7] * 2).losses
    /// []
    #[getter]
    fn losses(&self) -> Vec<String> {
        self.log.losses.iter().map(ToString::to_string).collect()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Pickled<'py>> {
        let (py, recording) = (slf.py(), slf.get());
        let mut rest = (*recording.log).clone();
        (rest.t_s, rest.q_rad) = (Vec::new(), Vec::new());
        let torques = mem::take(&mut rest.torques_nm);
        let torques: Vec<_> = torques.into_iter().map(|it| it.unwrap_or([f64::NAN; 7])).collect();
        let rest = serde_json::to_string(&rest)
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        let parts = (recording.t(py), recording.q(py)?, joint_array(py, torques)?, rest);
        Ok((slf.get_type().getattr("_restore")?, parts.into_pyobject(py)?))
    }

    /// Restores a recording from its arrays (torques as in the file, NaN where they are missing)
    /// and the rest as JSON.
    #[staticmethod]
    #[pyo3(signature = (t, q, torques, rest, /))]
    fn _restore<'py>(
        t: PyArrayLike1<'py, f64>,
        q: PyArrayLike2<'py, f64>,
        torques: PyArrayLike2<'py, f64>,
        rest: &str,
    ) -> PyResult<Self> {
        let rows = |array: &PyArrayLike2<'_, f64>| -> Vec<Joints> {
            let flat: Vec<f64> = array.as_array().iter().copied().collect();
            flat.as_chunks().0.to_vec()
        };
        let mut log: JointLog =
            serde_json::from_str(rest).map_err(|error| PyValueError::new_err(error.to_string()))?;
        log.t_s = t.as_array().to_vec();
        log.q_rad = rows(&q);
        log.torques_nm =
            rows(&torques).into_iter().map(|it| (!it[0].is_nan()).then_some(it)).collect();
        Ok(Self::of(log))
    }

    fn __len__(&self) -> usize {
        self.log.t_s.len()
    }

    fn __repr__(&self) -> String {
        format!(
            "<iiwasim.Recording {} samples, {:.3} s>",
            self.log.t_s.len(),
            self.log.duration_s()
        )
    }
}
