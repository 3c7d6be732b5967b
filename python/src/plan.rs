//! Plans.

use std::{
    path::PathBuf,
    sync::{Arc, OnceLock},
};

use iiwa_files::Output;
use iiwa_kin::Joints;
use iiwa_log::{PlanConfig, write_plan};
use iiwa_plan::{PlanFigures, ProgramSource};
use iiwa_report::{PlanPicture, carried, plan_table, with_causes};
use iiwa_scene::{ArmInScene, PlannedClearance};
use iiwa_traj::Trajectory;
use numpy::{Ix1, PyArray1};
use pyo3::{
    exceptions::{PyOSError, PyRuntimeError, PyValueError},
    prelude::*,
    sync::PyOnceLock,
    types::PyDict,
};

use crate::{
    Pickled,
    arrays::{RealArray, array, room},
    errors::{TextOrigin, output_error, plan_error},
    frames::object,
    program::Program,
    robot::{Robot, is_same},
    samples::Samples,
    scene::{Clearance, Scene},
};

/// Number of characters per line of tables: the width of the narrowest usual terminal.
pub(crate) const TABLE_WIDTH: u16 = 80;

/// A plan: the time-parameterised path of the robot through a program. Immutable.
///
/// A pickle contains the program and the options; unpickling plans again, with the same result.
/// Plans are equal if their programs, robots and options are.
///
/// >>> import iiwasim as iw
/// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
/// >>> plan = iw.plan(program)
/// >>> plan
/// <iiwasim.Plan 1.196 s, 2 motions, sunrise>
#[pyclass(frozen, module = "iiwasim")]
pub(crate) struct Plan {
    /// The program as given by the caller.
    source: Arc<ProgramSource>,
    /// Origin of the program's text.
    origin: TextOrigin,
    planned: iiwa_plan::Plan,
    /// Computed on first access.
    figures: OnceLock<PlanFigures>,
    motions: PyOnceLock<Py<PyAny>>,
}

/// Checks a sampling rate: above 0 and up to 1 MHz.
pub(crate) fn rate(rate_hz: f64) -> PyResult<f64> {
    if rate_hz.is_finite() && rate_hz > 0.0 && rate_hz <= 1e6 {
        return Ok(rate_hz);
    }
    Err(PyValueError::new_err(format!("rate_hz is {rate_hz}; above 0 and up to 1e6 is possible")))
}

impl Plan {
    pub(crate) fn new(
        source: Arc<ProgramSource>,
        origin: TextOrigin,
        planned: iiwa_plan::Plan,
    ) -> Self {
        let (figures, motions) = (OnceLock::new(), PyOnceLock::new());
        Self { source, origin, planned, figures, motions }
    }

    /// Options of the plan by name: timing, blend shape, blend search, samples.
    fn options(&self) -> (&'static str, &'static str, &'static str, u32) {
        let path = self.planned.options.path;
        (
            self.timing(),
            crate::options::shape_name(path.blend_shape),
            crate::options::search_name(path.blend_search),
            self.planned.options.samples,
        )
    }

    pub(crate) fn trajectory(&self) -> &Trajectory {
        &self.planned.trajectory
    }

    fn record(&self) -> &PlanFigures {
        self.figures.get_or_init(|| self.planned.figures())
    }

    /// The states at an array of times.
    fn states<'py>(&self, py: Python<'py>, t_s: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let times: RealArray<'py, Ix1> = t_s.extract()?;
        let times: Vec<f64> = times.as_array().iter().copied().collect();
        if let Some(index) = times.iter().position(|time| !time.is_finite()) {
            let message = format!("t_s[{index}] is {}; it has to be finite", times[index]);
            return Err(PyValueError::new_err(message));
        }
        let rows = || room::<Joints>(times.len());
        let (mut q, mut dq, mut ddq, mut dddq) = (rows()?, rows()?, rows()?, rows()?);
        let mut motions = room(times.len())?;
        py.detach(|| {
            for &time in &times {
                let state = self.trajectory().at(time);
                q.push(state.q);
                dq.push(state.dq);
                ddq.push(state.ddq);
                dddq.push(state.dddq);
                motions.push(u32::try_from(state.motion.number()).unwrap_or(u32::MAX));
            }
        });
        let states = (
            PyArray1::from_vec(py, times),
            array(py, q, &[7], false)?,
            array(py, dq, &[7], false)?,
            array(py, ddq, &[7], false)?,
            array(py, dddq, &[7], false)?,
            PyArray1::from_vec(py, motions),
        );
        py.import("iiwasim._figures")?.getattr("States")?.call1(states)
    }

    fn clearance_of(
        &self,
        py: Python<'_>,
        scene: &Scene,
        find: impl Fn(&ArmInScene, &Trajectory) -> Option<PlannedClearance> + Send + Sync,
    ) -> PyResult<Option<Clearance>> {
        let carried = carried(&self.source).map_err(|error| plan_error(py, &error))?;
        Ok(py.detach(|| {
            let arm = ArmInScene::new(self.planned.robot(), &scene.parsed).carrying(&carried);
            let clearance = find(&arm, self.trajectory())?;
            Some(Clearance::new(&arm, &clearance.clearance, Some(&clearance)))
        }))
    }
}

#[pymethods]
impl Plan {
    /// Cycle time from the start to the end of the last settling or waiting time, in s.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> round(plan.cycle_time_s, 3)
    /// 1.196
    #[getter]
    pub(crate) fn cycle_time_s(&self) -> f64 {
        self.trajectory().cycle_time_s()
    }

    /// Part of the cycle time in motion, in s.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> round(plan.motion_time_s, 3)
    /// 0.646
    #[getter]
    fn motion_time_s(&self) -> f64 {
        self.trajectory().motion_time_s()
    }

    /// Part of the cycle time in which the robot settles, in s.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.settle_time_s
    /// 0.05
    #[getter]
    fn settle_time_s(&self) -> f64 {
        self.trajectory().totals().settle_time_s
    }

    /// Part of the cycle time in which the program waits, in s.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.wait_time_s
    /// 0.5
    #[getter]
    fn wait_time_s(&self) -> f64 {
        self.trajectory().totals().wait_time_s
    }

    /// Timing option of the plan: `sunrise` (the default of `plan`), `jerk` (velocity, acceleration
    /// and jerk limits) or `acceleration` (velocity and acceleration limits).
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.timing
    /// 'sunrise'
    #[getter]
    fn timing(&self) -> &'static str {
        self.planned.options.timing.name()
    }

    /// The robot of the plan.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.robot.name
    /// 'lbr_iiwa_7_r800'
    #[getter]
    fn robot(&self) -> Robot {
        Robot::of(self.planned.robot().clone())
    }

    /// The program of the plan.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> len(plan.program)
    /// 2
    #[getter]
    fn program(&self) -> Program {
        Program::planned(&self.source, &self.planned.program, self.planned.robot(), self.origin)
    }

    /// The motions, as `MotionFigures`. Each access returns the same tuple.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> [motion.type for motion in plan.motions]
    /// ['ptp', 'wait']
    #[getter]
    fn motions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let made = self.motions.get_or_try_init(py, || {
            let motions = py.import("iiwasim._figures")?.getattr("motions")?;
            motions.call1((self.figures(py)?,)).map(Bound::unbind)
        })?;
        Ok(made.bind(py).clone())
    }

    /// The groups of motions with their times, as `GroupFigures`, in the order of their first
    /// motions.
    ///
    /// >>> import iiwasim as iw
    /// >>> motions = [iw.ptp(deg=[30] + [0] * 6, group="pick"), iw.wait(0.5, group="pick")]
    /// >>> plan = iw.plan(iw.Program(motions, start_deg=[0] * 7))
    /// >>> [(group.name, round(group.duration_s, 3)) for group in plan.groups]
    /// [('pick', 1.146)]
    #[getter]
    fn groups<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("iiwasim._figures")?.call_method1("groups", (self.figures(py)?,))
    }

    /// The repeat blocks with their times, as `RepeatFigures`, each before its inner blocks.
    ///
    /// >>> import iiwasim as iw
    /// >>> swing = [iw.ptp(deg=[30] + [0] * 6), iw.ptp(deg=[0] * 7)]
    /// >>> plan = iw.plan(iw.Program([iw.repeat(3, swing)], start_deg=[0] * 7))
    /// >>> [(repeat.count, repeat.motions) for repeat in plan.repeats]
    /// [(3, 2)]
    #[getter]
    fn repeats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("iiwasim._figures")?.call_method1("repeats", (self.figures(py)?,))
    }

    /// Warnings about the program, and about torques above their limits.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.warnings
    /// []
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.planned.warnings(self.record())
    }

    /// All figures as a dict, as in `iiwasim plan --json`.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> figures = plan.figures()
    /// >>> figures['motions'][0]['limited_by']
    /// {'joint': 1, 'kind': 'acceleration'}
    fn figures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let json = py.detach(|| serde_json::to_string(self.record()));
        object(py, &json.map_err(|error| PyRuntimeError::new_err(error.to_string()))?)
    }

    /// The table that `iiwasim plan` prints to a terminal of 80 characters per line.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> print(plan.table())
    /// motion  type  start s  time s  top %  limited by, % of its time
    /// ...
    fn table(&self, py: Python<'_>) -> String {
        py.detach(|| plan_table(self.record(), Some(TABLE_WIDTH)))
    }

    /// The joint state at `t_s`, a `State`; at an array of times (n,), a `States` with arrays. The
    /// robot is at rest before the start and after the end.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.at(0.4).q.shape, plan.at([0.1, 0.4]).q.shape
    /// ((7,), (2, 7))
    fn at<'py>(&self, py: Python<'py>, t_s: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        // An array without dimensions has no length.
        if t_s.len().is_ok() {
            return self.states(py, t_s);
        }
        let t_s: f64 = t_s.extract()?;
        if !t_s.is_finite() {
            return Err(PyValueError::new_err(format!("t_s is {t_s}; it has to be finite")));
        }
        let state = self.trajectory().at(t_s);
        let row = |values| array(py, vec![values], &[7], true);
        let state = (
            state.t_s,
            row(state.q)?,
            row(state.dq)?,
            row(state.ddq)?,
            row(state.dddq)?,
            state.motion.number(),
        );
        py.import("iiwasim._figures")?.getattr("State")?.call1(state)
    }

    /// Samples the plan at `rate_hz`; the first sample is at 0, the last exactly at the cycle time.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.sample(rate_hz=500).q.shape
    /// (600, 7)
    #[pyo3(signature = (*, rate_hz = 1000.0))]
    fn sample(slf: &Bound<'_, Self>, rate_hz: f64) -> PyResult<Samples> {
        Samples::of(slf, rate(rate_hz)?)
    }

    /// Minimum clearance between robot and obstacles of the scene, accurate to 0.1 mm, including
    /// the shapes of loads while the robot carries them; `None` without obstacles. `link` of the
    /// clearance is 8 for the shapes of a tool's load, and 9 for those of `load`.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> scene = iw.Scene.load('fixtures/cage.json')
    /// >>> plan.clearance(scene)
    /// <iiwasim.Clearance ...>
    fn clearance(&self, py: Python<'_>, scene: &Bound<'_, Scene>) -> PyResult<Option<Clearance>> {
        self.clearance_of(py, scene.get(), ArmInScene::clearance_of)
    }

    /// Minimum clearance of the robot to itself, including the tool of the scene if given, and the
    /// shapes of loads while the robot carries them.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.self_clearance().distance_m > 0.1
    /// True
    #[pyo3(signature = (scene = None))]
    fn self_clearance(
        &self,
        py: Python<'_>,
        scene: Option<&Bound<'_, Scene>>,
    ) -> PyResult<Option<Clearance>> {
        let bare = Scene::bare()?;
        let scene = scene.map_or(&bare, |scene| scene.get());
        self.clearance_of(py, scene, ArmInScene::self_clearance_of)
    }

    /// Writes the plan to an MCAP file, as `iiwasim plan` does, with `rate_hz` joint states per
    /// second.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> import os, tempfile
    /// >>> with tempfile.TemporaryDirectory() as folder:
    /// ...     file = os.path.join(folder, 'plan.mcap')
    /// ...     plan.write(file)
    /// ...     len(iw.Recording.load(file))
    /// 301
    #[pyo3(signature = (path, *, rate_hz = 250.0))]
    fn write(&self, py: Python<'_>, path: PathBuf, rate_hz: f64) -> PyResult<()> {
        let config = PlanConfig { rate_hz: rate(rate_hz)?, ..PlanConfig::default() };
        let failed = |error: &dyn std::error::Error| PyOSError::new_err(with_causes(error));
        py.detach(|| {
            let output = Output::new(&path).map_err(|error| output_error(&error))?;
            let stream = output.stream().map_err(|error| output_error(&error))?;
            write_plan(stream, &self.planned, config, self.source.text.complete())
                .map_err(|error| failed(&error))?
                .into_inner()
                .map_err(|error| failed(error.error()))?;
            output.complete().map_err(|error| output_error(&error))
        })
    }

    /// TCP path and joint speeds as an SVG picture, as in `iiwasim plan --picture`.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.picture().startswith('<svg')
    /// True
    fn picture(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| {
            let robot = self.planned.robot();
            let mut picture = PlanPicture::new(robot).with_frames(&self.planned.program);
            for section in self.trajectory().sections() {
                picture.add(section);
            }
            picture.draw().map_err(|error| PyRuntimeError::new_err(error.to_string()))
        })
    }

    /// The HTML page that shows the plan in 3D, which is also written to `path` if given;
    /// optionally with a recording, and with the obstacles of a scene.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> page = plan.report()
    /// >>> '<html' in page
    /// True
    #[pyo3(signature = (path = None, *, measured = None, scene = None))]
    fn report<'py>(
        slf: &Bound<'py, Self>,
        path: Option<PathBuf>,
        measured: Option<Bound<'py, PyAny>>,
        scene: Option<Bound<'py, Scene>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = PyDict::new(slf.py());
        options.set_item("measured", measured)?;
        options.set_item("scene", scene)?;
        slf.py().import("iiwasim._pages")?.getattr("report")?.call((slf, path), Some(&options))
    }

    /// Samples as a pandas data frame, with the columns of `iiwasim plan --csv`.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.to_pandas(rate_hz=100)['joint_1_rad'].iloc[-1].round(4)
    /// np.float64(0.5236)
    #[pyo3(signature = (*, rate_hz = 250.0))]
    fn to_pandas<'py>(slf: &Bound<'py, Self>, rate_hz: f64) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("iiwasim._tables")?.call_method1("pandas", (slf, rate_hz))
    }

    /// Samples as a polars data frame, with the columns of `iiwasim plan --csv`.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> plan.to_polars(rate_hz=100).columns[:2]
    /// ['t_s', 'joint_1_rad']
    #[pyo3(signature = (*, rate_hz = 250.0))]
    fn to_polars<'py>(slf: &Bound<'py, Self>, rate_hz: f64) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("iiwasim._tables")?.call_method1("polars", (slf, rate_hz))
    }

    /// TCP path, joint speeds, and speed and rotation of the TCP as a matplotlib figure.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
    /// >>> plan = iw.plan(program)
    /// >>> len(plan.plot().axes)
    /// 5
    #[pyo3(signature = (*, rate_hz = 250.0))]
    fn plot<'py>(slf: &Bound<'py, Self>, rate_hz: f64) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("iiwasim._plots")?.call_method1("plot", (slf, rate_hz))
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("iiwasim._pages")?.call_method1("notebook", (slf,))
    }

    /// Reduces the plan to its input, as the same input gives the same plan.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Pickled<'py>> {
        let (py, plan) = (slf.py(), slf.get());
        let restore = py.import("iiwasim._figures")?.getattr("planned")?;
        Ok((restore, (plan.program(), plan.options()).into_pyobject(py)?))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| {
            let other = other.get();
            other.options() == self.options()
                && other.planned.program == self.planned.program
                && is_same(other.planned.robot(), self.planned.robot())
        })
    }

    fn __hash__(&self) -> u64 {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hasher = DefaultHasher::new();
        self.cycle_time_s().to_bits().hash(&mut hasher);
        hasher.finish()
    }

    fn __repr__(&self) -> String {
        let count = self.planned.program.motions.len();
        let motions = if count == 1 { "1 motion".to_owned() } else { format!("{count} motions") };
        format!("<iiwasim.Plan {:.3} s, {motions}, {}>", self.cycle_time_s(), self.timing())
    }
}
