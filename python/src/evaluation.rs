//! Comparison of plans with recordings, and identification of robots from recordings.

use std::path::{Path, PathBuf};

use iiwa_eval::{
    Comparison as Compared, PlannedTrajectory as Reference, TracePoint, identify as identified,
};
use iiwa_kin::Robot as Model;
use iiwa_plan::{PlanRequest, ProgramSource};
use iiwa_report::{ComparisonReport, IdentificationReport, draw_comparison, with_causes};
use pyo3::{
    exceptions::{PyRuntimeError, PyValueError},
    prelude::*,
    types::{PyBytes, PyDict, PyList},
};

use crate::{
    Pickled,
    arrays::array,
    errors::{exception, plan_error, read_file, unexpected},
    frames::object,
    options::RobotArgument,
    plan::{Plan, TABLE_WIDTH},
    program::Program,
    recording::{Recording, recording_error},
    robot::Robot,
    work::interruptible,
};

/// The comparison of a plan with a recording, returned by `compare`.
///
/// A pickle contains the plan and the recording; unpickling compares them again.
///
/// >>> import iiwasim as iw
/// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
/// >>> plan = iw.plan(program)
/// >>> samples = plan.sample(rate_hz=250)
/// >>> comparison = iw.compare(plan, iw.Recording(samples.t, samples.q))
/// >>> comparison.planned_s > 0.7
/// True
#[pyclass(frozen, module = "iiwasim")]
pub(crate) struct Comparison {
    made_of: (PlanArgument, Py<Recording>),
    plan: Reference,
    compared: Compared,
    report: ComparisonReport,
}

/// The plan of a comparison: from a file or from memory.
pub(crate) enum PlanArgument {
    Plan(Py<Plan>),
    /// Name and current content of a file.
    File(String, Py<PyBytes>),
}

impl<'py> FromPyObject<'_, 'py> for PlanArgument {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(plan) = value.cast::<Plan>() {
            return Ok(Self::Plan(plan.to_owned().unbind()));
        }
        // The form in which a file is pickled.
        if let Ok((name, bytes)) = value.extract() {
            return Ok(Self::File(name, bytes));
        }
        let path: PathBuf = value
            .extract()
            .map_err(|_| unexpected("plan", &value, "a Plan or the path of its MCAP file"))?;
        let bytes = read_file(value.py(), &path)?;
        let name = path.display().to_string();
        Ok(Self::File(name, PyBytes::new(value.py(), &bytes).unbind()))
    }
}

impl PlanArgument {
    fn reference(&self, py: Python<'_>) -> PyResult<Reference> {
        match self {
            Self::Plan(plan) => Ok(Reference::from_trajectory(plan.get().trajectory())),
            Self::File(name, bytes) => {
                Reference::read_mcap(bytes.as_bytes(py), None).map_err(|error| {
                    let message = format!("{name}: {}", with_causes(&error));
                    exception(py, "RecordingError", (message,))
                })
            }
        }
    }
}

/// Compares a plan with a recording; see `iiwasim/_recordings.py`.
#[pyfunction]
#[pyo3(signature = (plan, measured, /))]
pub(crate) fn compare(
    py: Python<'_>,
    plan: PlanArgument,
    measured: &Bound<'_, Recording>,
) -> PyResult<Comparison> {
    let made_of = (plan, measured.clone().unbind());
    let plan = made_of.0.reference(py)?;
    let log = &measured.get().log;
    log.check_robot(plan.robot()).map_err(|error| recording_error(py, "the recording", &error))?;
    let compared = py.detach(|| iiwa_eval::compare(&plan, log));
    let compared =
        compared.map_err(|error| exception(py, "RecordingError", (with_causes(&error),)))?;
    let files = [Path::new("plan"), Path::new("recording")];
    let report = ComparisonReport::new(files, None, &plan, log, &compared);
    Ok(Comparison { made_of, plan, compared, report })
}

#[pymethods]
impl Comparison {
    /// Planned minus measured cycle time, in s.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> samples = plan.sample(rate_hz=250)
    /// >>> comparison = iw.compare(plan, iw.Recording(samples.t, samples.q))
    /// >>> abs(comparison.cycle_time_error_s) < 0.01
    /// True
    #[getter]
    fn cycle_time_error_s(&self) -> f64 {
        self.compared.cycle_time.error_s
    }

    /// Cycle time error as a share of the measured time, in per cent.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> samples = plan.sample(rate_hz=250)
    /// >>> comparison = iw.compare(plan, iw.Recording(samples.t, samples.q))
    /// >>> abs(comparison.cycle_time_error_percent) < 1
    /// True
    #[getter]
    fn cycle_time_error_percent(&self) -> f64 {
        self.compared.cycle_time.error_percent
    }

    /// Planned cycle time, in s.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> samples = plan.sample(rate_hz=250)
    /// >>> comparison = iw.compare(plan, iw.Recording(samples.t, samples.q))
    /// >>> round(comparison.planned_s, 2)
    /// 1.2
    #[getter]
    fn planned_s(&self) -> f64 {
        self.compared.cycle_time.simulated_s
    }

    /// Measured cycle time, in s.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> samples = plan.sample(rate_hz=250)
    /// >>> comparison = iw.compare(plan, iw.Recording(samples.t, samples.q))
    /// >>> abs(comparison.measured_s - comparison.planned_s) < 0.01
    /// True
    #[getter]
    fn measured_s(&self) -> f64 {
        self.compared.cycle_time.real_s
    }

    /// Maximum deviation of the TCP from the planned path, in mm.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> samples = plan.sample(rate_hz=250)
    /// >>> comparison = iw.compare(plan, iw.Recording(samples.t, samples.q))
    /// >>> comparison.max_deviation_mm < 0.1
    /// True
    #[getter]
    fn max_deviation_mm(&self) -> f64 {
        self.report.max_deviation_mm()
    }

    /// All figures as a dict, as in `iiwasim compare --json`.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> samples = plan.sample(rate_hz=250)
    /// >>> comparison = iw.compare(plan, iw.Recording(samples.t, samples.q))
    /// >>> 'cycle_time' in comparison.figures()
    /// True
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        figures(py, &self.report)
    }

    /// The table that `iiwasim compare` prints to a terminal of 80 characters per line.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> samples = plan.sample(rate_hz=250)
    /// >>> comparison = iw.compare(plan, iw.Recording(samples.t, samples.q))
    /// >>> 'Cycle time' in comparison.table()
    /// True
    fn table(&self) -> String {
        self.report.text(Some(TABLE_WIDTH))
    }

    /// Planned and measured path as a picture, SVG.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> samples = plan.sample(rate_hz=250)
    /// >>> comparison = iw.compare(plan, iw.Recording(samples.t, samples.q))
    /// >>> comparison.picture().startswith('<svg')
    /// True
    fn picture(&self) -> PyResult<String> {
        draw_comparison(&self.plan, &self.compared)
            .map_err(|error| PyRuntimeError::new_err(error.to_string()))
    }

    /// Planned and measured flange path, and their deviation over time, as a matplotlib figure.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> samples = plan.sample(rate_hz=250)
    /// >>> comparison = iw.compare(plan, iw.Recording(samples.t, samples.q))
    /// >>> len(comparison.plot().axes)
    /// 4
    fn plot<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("iiwasim._plots")?.call_method1("compared", (slf,))
    }

    /// Compared samples, for plots: times, in s, of the plan and of the recording; measured and
    /// planned flange positions, in m; and the deviations, in rad and in m.
    fn _trace<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let points = &self.compared.trace;
        let row = |point: &TracePoint| {
            let planned = self.plan.robot().flange_pose(&self.plan.at(point.plan_s)).position_m;
            let [x, y, z] = point.flange_m;
            let [u, v, w] = planned;
            let deviations = [point.joints_rad, point.flange_deviation_m];
            [point.plan_s, point.measured_s, x, y, z, u, v, w, deviations[0], deviations[1]]
        };
        let rows = points.iter().map(row).collect();
        array(py, rows, &[10], false).map(Bound::into_any)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py>> {
        let (plan, measured) = &self.made_of;
        let plan = match plan {
            PlanArgument::Plan(plan) => plan.bind(py).clone().into_any(),
            PlanArgument::File(name, bytes) => {
                (name.as_str(), bytes.bind(py)).into_pyobject(py)?.into_any()
            }
        };
        let compare = py.import("iiwasim._native")?.getattr("compare")?;
        Ok((compare, (plan, measured.clone_ref(py)).into_pyobject(py)?))
    }

    fn __repr__(&self) -> String {
        format!(
            "<iiwasim.Comparison {:+.3} s ({:+.2} %), at most {:.2} mm off>",
            self.cycle_time_error_s(),
            self.cycle_time_error_percent(),
            self.max_deviation_mm()
        )
    }
}

fn figures<'py>(py: Python<'py>, report: &impl serde::Serialize) -> PyResult<Bound<'py, PyAny>> {
    let json = serde_json::to_string(report);
    object(py, &json.map_err(|error| PyRuntimeError::new_err(error.to_string()))?)
}

/// The robot parameters found from recordings, returned by `identify`.
///
/// A pickle contains the recordings and options; unpickling identifies the robot again.
///
/// >>> import iiwasim as iw
/// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
/// >>> plan = iw.plan(program)
/// >>> samples = plan.sample(rate_hz=250)
/// >>> found = iw.identify([iw.Recording(samples.t, samples.q, program=program)])
/// >>> found
/// <iiwasim.Identification of identified>
#[pyclass(frozen, module = "iiwasim")]
pub(crate) struct Identification {
    /// The arguments of `identify`.
    made_of: (Vec<Py<Recording>>, Option<Py<Program>>, Option<Model>),
    robot: Model,
    model: Model,
    report: IdentificationReport,
}

/// Identifies a robot from recordings; see `iiwasim/_recordings.py`.
#[pyfunction]
#[pyo3(signature = (recordings, *, program = None, robot = None, name = "identified"))]
pub(crate) fn identify(
    py: Python<'_>,
    recordings: Vec<Bound<'_, Recording>>,
    program: Option<&Bound<'_, Program>>,
    robot: Option<RobotArgument<'_>>,
    name: &str,
) -> PyResult<Identification> {
    let mut model = robot.map(|robot| robot.model(py)).transpose()?;
    let made_of = (
        recordings.iter().map(|it| it.clone().unbind()).collect(),
        program.map(|it| it.clone().unbind()),
        model.clone(),
    );
    let mut sources = Vec::new();
    for (index, recording) in recordings.iter().enumerate() {
        let log = &recording.get().log;
        let planned_program = match (program, &log.program) {
            (Some(program), _) => ProgramSource::clone(&program.get().source),
            (None, Some(text)) => {
                ProgramSource::from_json(text).map_err(|error| plan_error(py, &error))?
            }
            (None, None) => {
                return Err(PyValueError::new_err(format!(
                    "recordings[{index}] does not hold the program that was run; give program"
                )));
            }
        };
        if model.is_none() {
            let recorded = log
                .recorded_robot()
                .map_err(|error| PyValueError::new_err(format!("{error}; give robot")))?;
            model = Some(match (program, recorded) {
                (Some(program), _) => program.get().model(),
                (None, Some(robot)) => robot,
                (None, None) => PlanRequest::default()
                    .robot(&planned_program)
                    .map_err(|error| plan_error(py, &error))?,
            });
        }
        if let Some(model) = &model {
            let name = format!("recordings[{index}]");
            let checked = log.check_robot(model).and_then(|()| log.check_motion());
            checked.map_err(|error| recording_error(py, &name, &error))?;
        }
        sources.push((planned_program.program, std::sync::Arc::clone(log)));
    }
    if sources.is_empty() {
        return Err(PyValueError::new_err("recordings is empty; at least one is needed"));
    }
    let model = model.unwrap_or_default();
    let work = {
        let model = model.clone();
        move |_| {
            let recordings: Vec<_> = sources
                .iter()
                .map(|(program, log)| identified::RecordedRun { program, log })
                .collect();
            let result = identified::identify(&recordings, &model);
            (result, sources)
        }
    };
    let (result, sources) = interruptible(py, work, |_| Ok(()))?;
    let identified = result.map_err(|error| {
        let message = format!("recordings[{}]: {}", error.recording(), with_causes(&error));
        exception(py, "RecordingError", (message,))
    })?;
    let names: Vec<_> = (0..sources.len()).map(|index| format!("recordings[{index}]")).collect();
    let named: Vec<_> =
        names.iter().zip(&sources).map(|(name, (_, log))| (name.as_str(), &**log)).collect();
    let report = IdentificationReport::new(&named, name, &identified, None);
    if report.is_empty() {
        return Err(exception(
            py,
            "RecordingError",
            ("the recordings show no limit, no time to settle and no blend",),
        ));
    }
    Ok(Identification { made_of, robot: identified.robot(&model).with_name(name), model, report })
}

#[pymethods]
impl Identification {
    /// The robot with the identified parameters, for planning. Parameters that the recordings do
    /// not show have the values of the assumed robot; `robot.assumptions` lists them.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> samples = plan.sample(rate_hz=250)
    /// >>> found = iw.identify([iw.Recording(samples.t, samples.q, program=program)])
    /// >>> iw.plan(program, robot=found.robot).cycle_time_s > 0.7
    /// True
    #[getter]
    fn robot(&self) -> Robot {
        Robot::of(self.robot.clone())
    }

    /// All figures as a dict, as in `iiwasim identify --json`.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> samples = plan.sample(rate_hz=250)
    /// >>> found = iw.identify([iw.Recording(samples.t, samples.q, program=program)])
    /// >>> 'velocity_deg_s' in found.figures()
    /// True
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        figures(py, &self.report)
    }

    /// The tables that `iiwasim identify` prints.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> samples = plan.sample(rate_hz=250)
    /// >>> found = iw.identify([iw.Recording(samples.t, samples.q, program=program)])
    /// >>> 'joint' in found.table()
    /// True
    fn table(&self) -> String {
        self.report.text(&self.model)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py>> {
        let (recordings, program, robot) = &self.made_of;
        let options = PyDict::new(py);
        options.set_item("program", program.as_ref().map(|it| it.bind(py)))?;
        options.set_item("robot", robot.clone().map(Robot::of))?;
        options.set_item("name", self.robot.name())?;
        let recordings = recordings.iter().map(|it| it.bind(py));
        let restore = py.import("iiwasim._recordings")?.getattr("identified")?;
        Ok((restore, (PyList::new(py, recordings)?, options).into_pyobject(py)?))
    }

    fn __repr__(&self) -> String {
        format!("<iiwasim.Identification of {}>", self.robot.name())
    }
}
