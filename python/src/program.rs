//! Motion programs.

use std::{path::PathBuf, sync::Arc};

use iiwa_kin::Robot as Model;
use iiwa_plan::{Error, ProgramSource};
use iiwa_program::Program as Motions;
use numpy::PyArrayDyn;
use pyo3::{exceptions::PyValueError, prelude::*, types::PyDict};

use crate::{
    Pickled,
    arrays::{JointsLike, Rows, array},
    errors::{TextOrigin, plan_error, plan_error_in, read_text},
    frames::{json_of_program, object},
    options::RobotArgument,
    robot::{Robot, find, is_same, restorable, restored, write},
};

/// A motion program: the start position and the motions. Immutable.
///
/// `motions` are results of `ptp`, `lin`, `wait` and so on, or equal dicts. The start is in deg, in
/// rad, or a frame. Tools, bases, frames and the other arguments are as in program files. Raises
/// `ProgramError`, which names the motion and the argument.
///
/// >>> import iiwasim as iw
/// >>> iw.Program([iw.ptp(deg=[30] + [0] * 6), iw.wait(0.5)], start_deg=[0] * 7)
/// <iiwasim.Program 2 motions, lbr_iiwa_7_r800>
#[pyclass(frozen, module = "iiwasim")]
pub(crate) struct Program {
    /// The program with its text, as read or as serialised.
    pub(crate) source: Arc<ProgramSource>,
    /// Origin of the text, for errors.
    pub(crate) origin: TextOrigin,
    /// The robot that the program names, if any.
    robot: Option<Arc<Model>>,
}

impl Program {
    /// A program from its parsed form; its text is serialised from it.
    pub(crate) fn of(py: Python<'_>, program: Motions, robot: Option<Model>) -> PyResult<Self> {
        let source = ProgramSource::from(program);
        Self::with_named_robot(py, source, robot.map(Arc::new), TextOrigin::Arguments)
    }

    /// A program for `robot`, or for the robot that it names: a built-in model, or the path of a
    /// profile.
    fn with_named_robot(
        py: Python<'_>,
        source: ProgramSource,
        robot: Option<Arc<Model>>,
        origin: TextOrigin,
    ) -> PyResult<Self> {
        let robot = match (&source.program.robot, robot) {
            (Some(name), None) => {
                Some(Arc::new(source.program.with_flange(find(py, name.as_ref())?)))
            }
            (_, robot) => robot,
        };
        Ok(Self { source: Arc::new(source), origin, robot })
    }

    /// The program of a plan, which was read from `text` unless its limits were changed.
    pub(crate) fn planned(
        source: &Arc<ProgramSource>,
        parsed: &Arc<Motions>,
        robot: &Model,
        origin: TextOrigin,
    ) -> Self {
        let (source, origin) = if source.program == *parsed {
            (Arc::clone(source), origin)
        } else {
            (Arc::new(ProgramSource::from((**parsed).clone())), TextOrigin::Arguments)
        };
        let program = Self { source, origin, robot: Some(Arc::new(robot.clone())) };
        if program.names_its_robot() {
            return program;
        }
        let mut parsed = (**parsed).clone();
        parsed.robot = Some(program.model().name().to_owned());
        let source = Arc::new(parsed.into());
        Self { source, origin: TextOrigin::Arguments, robot: program.robot }
    }

    pub(crate) fn parsed(&self) -> &Motions {
        &self.source.program
    }

    pub(crate) fn text(&self) -> &str {
        self.source.text.as_read()
    }

    /// True if the program text alone identifies the robot.
    fn names_its_robot(&self) -> bool {
        let name = self.parsed().robot.as_deref();
        let named = name.map_or_else(|| Some(Model::default()), Model::built_in);
        named.is_some_and(|named| is_same(&self.parsed().with_flange(named), &self.model()))
    }

    fn read(
        py: Python<'_>,
        text: &str,
        robot: Option<Arc<Model>>,
        origin: TextOrigin,
    ) -> PyResult<Self> {
        let source = ProgramSource::from_json(text)
            .map_err(|error| plan_error_in(py, &error, text, origin))?;
        Self::with_named_robot(py, source, robot, origin)
    }

    /// The dicts under a key of the program; empty without the key.
    fn dicts<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyAny>> {
        object(py, self.text())?.call_method1("get", (key, PyDict::new(py)))
    }

    /// The robot of the program.
    pub(crate) fn model(&self) -> Model {
        let robot = self.robot.as_deref().cloned();
        robot.unwrap_or_else(|| self.parsed().with_flange(Model::default()))
    }

    /// The program with another value of a key.
    fn with(&self, py: Python<'_>, key: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let program = object(py, self.text())?;
        program.set_item(key, value)?;
        let text = json_of_program(py, program.cast()?)?;
        Self::read(py, &text, self.robot.clone(), TextOrigin::Arguments)
    }
}

#[pymethods]
impl Program {
    #[new]
    #[pyo3(signature = (
        motions, *, start_deg = None, start_rad = None, start_frame = None, robot = None,
        tools = None, bases = None, frames = None, tool = None, base = None, mount = None,
        mode = None, limit_torque_percent = None, override_percent = None, tasks = None
    ))]
    #[expect(clippy::too_many_arguments, reason = "they are options by keyword in Python")]
    fn new<'py>(
        py: Python<'py>,
        motions: Bound<'py, PyAny>,
        start_deg: Option<JointsLike<'py>>,
        start_rad: Option<JointsLike<'py>>,
        start_frame: Option<Bound<'py, PyAny>>,
        robot: Option<RobotArgument<'py>>,
        tools: Option<Bound<'py, PyAny>>,
        bases: Option<Bound<'py, PyAny>>,
        frames: Option<Bound<'py, PyAny>>,
        tool: Option<String>,
        base: Option<String>,
        mount: Option<Bound<'py, PyAny>>,
        mode: Option<String>,
        limit_torque_percent: Option<f64>,
        override_percent: Option<f64>,
        tasks: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        let start = PyDict::new(py);
        for (name, key, given) in
            [("start_deg", "joints_deg", start_deg), ("start_rad", "joints_rad", start_rad)]
        {
            if let Some(given) = given {
                start.set_item(key, *Rows::new(name, &given)?.single(name)?)?;
            }
        }
        if let Some(frame) = start_frame {
            start.set_item("frame", frame)?;
        }
        if start.len() != 1 {
            return Err(PyValueError::new_err(
                "a program has to start somewhere: give one of start_deg, start_rad and \
                 start_frame",
            ));
        }
        let program = PyDict::new(py);
        program.set_item("version", 1)?;
        let mut model = None;
        match &robot {
            None => {}
            Some(RobotArgument::Robot(robot)) => {
                program.set_item("robot", robot.get().model.name())?;
                model = Some(Arc::clone(&robot.get().model));
            }
            Some(RobotArgument::Path(name)) => program.set_item("robot", name.to_string_lossy())?,
        }
        program.set_item("start", start)?;
        for (key, value) in [
            ("tools", tools),
            ("bases", bases),
            ("frames", frames),
            ("tool", tool.map(|it| it.into_pyobject(py)).transpose()?.map(Bound::into_any)),
            ("base", base.map(|it| it.into_pyobject(py)).transpose()?.map(Bound::into_any)),
            ("mount", mount),
            ("mode", mode.map(|it| it.into_pyobject(py)).transpose()?.map(Bound::into_any)),
        ] {
            if let Some(value) = value {
                program.set_item(key, value)?;
            }
        }
        for (key, percent) in
            [("limit_torque_percent", limit_torque_percent), ("override_percent", override_percent)]
        {
            if let Some(percent) = percent {
                program.set_item(key, percent)?;
            }
        }
        for (key, entries) in [("tasks", tasks), ("motions", Some(motions))] {
            if let Some(entries) = entries {
                let list = py.import("builtins")?.call_method1("list", (entries,))?;
                program.set_item(key, list)?;
            }
        }
        Self::read(py, &json_of_program(py, &program)?, model, TextOrigin::Arguments)
    }

    /// Reads a program from its text. Raises `ProgramError` with line, column and motion.
    ///
    /// >>> import iiwasim as iw
    /// >>> text = '''{"version": 1, "start": {"joints_deg": [0, 0, 0, 0, 0, 0, 0]},
    /// ...     "motions": [{"type": "wait", "seconds": 1}]}'''
    /// >>> len(iw.Program.from_json(text))
    /// 1
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Self> {
        Self::read(py, text, None, TextOrigin::Given)
    }

    /// Reads a program from a file, with the robot profile and the frames that the file names.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Program.load('fixtures/appendix-b.json')
    /// <iiwasim.Program 4 motions, lbr_iiwa_7_r800>
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let text = read_text(py, &path, "ProgramError")?;
        let raise = |error| plan_error(py, &error);
        let source = ProgramSource::beside(&path, &text);
        let source = source.map_err(raise)?;
        let robot = source.named_robot().map_err(raise)?.map(Arc::new);
        // Places in later errors refer to `to_json()`.
        Self::read(py, source.text.complete(), robot, TextOrigin::Given)
    }

    /// The program text, which `from_json` and `iiwasim plan` read. It has a custom robot by its
    /// name only; `save` also writes the profile.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.wait(1)], start_deg=[0] * 7)
    /// >>> iw.Program.from_json(program.to_json()) == program
    /// True
    fn to_json(&self) -> &str {
        self.text()
    }

    /// Writes the program to a file, and the profile of a custom robot to a second file next to it:
    /// for `cell.json`, `cell-robot.json`.
    ///
    /// >>> import iiwasim as iw, os, tempfile
    /// >>> with tempfile.TemporaryDirectory() as folder:
    /// ...     file = os.path.join(folder, 'wait.json')
    /// ...     iw.Program([iw.wait(1)], start_deg=[0] * 7).save(file)
    /// ...     len(iw.Program.load(file))
    /// 1
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        if self.names_its_robot() {
            return write(&path, self.text());
        }
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let name = format!("{stem}-robot.json");
        let named = self.with(py, "robot", name.as_str().into_pyobject(py)?.as_any())?;
        write(&path.with_file_name(&name), &self.model().to_full_profile())?;
        write(&path, named.text())
    }

    /// A program with the same motions from another start (7,), in deg or in rad.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.ptp(deg=[30] + [0] * 6)], start_deg=[0] * 7)
    /// >>> nearer = program.with_start(deg=[20] + [0] * 6)
    /// >>> iw.plan(nearer).cycle_time_s < iw.plan(program).cycle_time_s
    /// True
    #[pyo3(signature = (*, deg = None, rad = None))]
    fn with_start(
        &self,
        py: Python<'_>,
        deg: Option<JointsLike<'_>>,
        rad: Option<JointsLike<'_>>,
    ) -> PyResult<Self> {
        let start = PyDict::new(py);
        for (name, key, given) in [("deg", "joints_deg", deg), ("rad", "joints_rad", rad)] {
            if let Some(given) = given {
                start.set_item(key, *Rows::new(name, &given)?.single(name)?)?;
            }
        }
        if start.len() != 1 {
            return Err(PyValueError::new_err("give the start either in deg or in rad"));
        }
        self.with(py, "start", &start)
    }

    /// A program with the same start, tools and frames, and other motions.
    ///
    /// >>> import iiwasim as iw
    /// >>> program = iw.Program([iw.wait(1)], start_deg=[0] * 7)
    /// >>> len(program.with_motions([*program.motions, iw.wait(2)]))
    /// 2
    fn with_motions(&self, py: Python<'_>, motions: Bound<'_, PyAny>) -> PyResult<Self> {
        let motions = py.import("builtins")?.call_method1("list", (motions,))?;
        self.with(py, "motions", &motions)
    }

    /// The motions, as dicts; changes of the dicts do not change the program. A repeat block is one
    /// dict, while `len` of the program counts the motions of all rounds.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Program([iw.wait(1)], start_deg=[0] * 7).motions
    /// [{'type': 'wait', 'seconds': 1}]
    #[getter]
    fn motions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        object(py, self.text())?.get_item("motions")
    }

    /// The frames by name, as dicts; changes of the dicts do not change the program. `iw.pose`
    /// converts a frame to a pose (4, 4).
    ///
    /// >>> import iiwasim as iw
    /// >>> sorted(iw.Program.load('fixtures/pick-and-place.json').frames)
    /// ['pick', 'place', 'via']
    #[getter]
    fn frames<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.dicts(py, "frames")
    }

    /// The tools by name, as dicts; changes of the dicts do not change the program.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Program.load('fixtures/pick-and-place.json').tools['gripper']['tcp']
    /// {'z_mm': 120}
    #[getter]
    fn tools<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.dicts(py, "tools")
    }

    /// The bases by name, as dicts; changes of the dicts do not change the program.
    ///
    /// >>> import iiwasim as iw
    /// >>> list(iw.Program.load('fixtures/pick-and-place.json').bases)
    /// ['table']
    #[getter]
    fn bases<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.dicts(py, "bases")
    }

    /// Name of the tool in use by default; `None` is the bare flange.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Program.load('fixtures/pick-and-place.json').tool
    /// 'gripper'
    #[getter]
    fn tool(&self) -> Option<&str> {
        self.parsed().workcell.tool.as_deref()
    }

    /// Name of the base in use by default; `None` is the robot base.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Program([iw.wait(1)], start_deg=[0] * 7).base is None
    /// True
    #[getter]
    fn base(&self) -> Option<&str> {
        self.parsed().workcell.base.as_deref()
    }

    /// The robot of the program.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Program([iw.wait(1)], start_deg=[0] * 7, robot='lbr_iiwa_14_r820').robot
    /// <iiwasim.Robot lbr_iiwa_14_r820>
    #[getter]
    fn robot(&self) -> Robot {
        Robot::of(self.model())
    }

    /// Joint positions (7,) at the start, in rad. Raises `ProgramError` if the start is a frame
    /// that the robot cannot reach.
    ///
    /// >>> import iiwasim as iw
    /// >>> iw.Program([iw.wait(1)], start_deg=[0, 0, 0, 90, 0, 0, 0]).start_rad[3]
    /// np.float64(1.5707963267948966)
    #[getter]
    fn start_rad<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let start = self.parsed().start_rad(&self.model());
        let start = start.map_err(|fault| {
            let error = Error::plan(fault.into(), &self.parsed().sources, self.text());
            plan_error_in(py, &error, self.text(), self.origin)
        })?;
        array(py, vec![start], &[7], true)
    }

    fn __len__(&self) -> usize {
        self.parsed().motions.len()
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| {
            other.get().parsed() == self.parsed() && is_same(&other.get().model(), &self.model())
        })
    }

    fn __hash__(&self) -> u64 {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hasher = DefaultHasher::new();
        self.parsed().motions.len().hash(&mut hasher);
        hasher.finish()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Pickled<'py>> {
        let program = slf.get();
        let is_given = program.origin == TextOrigin::Given;
        let parts = (program.text(), program.robot.as_deref().map(restorable), is_given);
        Ok((slf.get_type().getattr("_restore")?, parts.into_pyobject(slf.py())?))
    }

    #[staticmethod]
    #[pyo3(signature = (text, robot, is_given = true, /))]
    fn _restore(py: Python<'_>, text: &str, robot: Option<&str>, is_given: bool) -> PyResult<Self> {
        let model = robot.map(|text| restored(py, text)).transpose()?;
        let origin = if is_given { TextOrigin::Given } else { TextOrigin::Arguments };
        Self::read(py, text, model.map(Arc::new), origin)
    }

    fn __repr__(&self) -> String {
        let count = self.parsed().motions.len();
        let robot = self
            .robot
            .as_ref()
            .map_or_else(|| Model::default().name().to_owned(), |it| it.name().to_owned());
        let motions = if count == 1 { "1 motion".to_owned() } else { format!("{count} motions") };
        format!("<iiwasim.Program {motions}, {robot}>")
    }
}
