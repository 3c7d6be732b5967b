//! Robot models and their kinematics and dynamics.

use std::{path::Path, sync::Arc};

use iiwa_files::Output;
use iiwa_kin::{Joints, Pose, Robot as Model};
use numpy::PyArrayDyn;
use pyo3::{exceptions::PyValueError, prelude::*, types::PyDict};

use crate::{
    Pickled,
    arrays::{JointsLike, Rows, array, room},
    errors::{output_error, profile_error, read_text},
    frames::{self, PlaceArgument, Workplace, matrix},
    program::Program,
};

/// Number of poses per block: small enough that the memory stores a block while the next one is
/// computed.
const BLOCK: usize = 32;

/// A model of the robot: its kinematics, limits and dynamics. Immutable.
///
/// `model` is the name of a built-in model or the path of a profile; `flange_m` overrides the
/// flange length, in m.
///
/// >>> import iiwasim as iw
/// >>> robot = iw.Robot()
/// >>> robot
/// <iiwasim.Robot lbr_iiwa_7_r800>
/// >>> robot.flange([0, 0.5, 0, -1.0, 0, 0.7, 0]).round(4).tolist()
/// [0.7137, 0.0, 0.6299]
#[pyclass(frozen, module = "iiwasim")]
pub(crate) struct Robot {
    pub(crate) model: Arc<Model>,
}

/// The built-in model with this name, or the robot of the profile at this path.
pub(crate) fn find(py: Python<'_>, name: &Path) -> PyResult<Model> {
    if let Some(model) = name.to_str().and_then(Model::built_in) {
        return Ok(model);
    }
    if !name.is_file() {
        return Err(PyValueError::new_err(format!(
            "no robot is called '{}': {} are built in, and there is no such profile file",
            name.display(),
            Model::BUILT_IN.join(" and "),
        )));
    }
    of_profile(py, &read_text(py, name, "ProfileError")?)
}

/// The name of a built-in model, or a profile with the assumptions, as input of [`restored`].
pub(crate) fn restorable(model: &Model) -> String {
    match Model::built_in(model.name()) {
        Some(built_in) if built_in == *model => model.name().to_owned(),
        _ => {
            let assumptions: Vec<_> =
                model.assumptions().iter().map(|it| (&it.quantity, &it.basis)).collect();
            // Lists of texts can always be serialised.
            serde_json::to_string(&(model.to_full_profile(), assumptions)).unwrap_or_default()
        }
    }
}

/// Writes a file atomically.
pub(crate) fn write(path: &Path, text: &str) -> PyResult<()> {
    let write = || {
        let output = Output::new(path)?;
        output.write(text.as_bytes())?;
        output.complete()
    };
    write().map_err(|error| output_error(&error))
}

/// True if two models move in the same way: a profile does not say which of its numbers are
/// assumed.
pub(crate) fn is_same(one: &Model, other: &Model) -> bool {
    one == other || one.to_full_profile() == other.to_full_profile()
}

/// The model of a text from [`restorable`].
pub(crate) fn restored(py: Python<'_>, text: &str) -> PyResult<Model> {
    if let Some(model) = Model::built_in(text) {
        return Ok(model);
    }
    let (profile, assumptions): (String, Vec<(String, String)>) =
        serde_json::from_str(text).map_err(|error| PyValueError::new_err(error.to_string()))?;
    let model = of_profile(py, &profile)?;
    let assume =
        |model: Model, (quantity, basis): (String, String)| model.with_assumption(quantity, basis);
    Ok(assumptions.into_iter().fold(model, assume))
}

fn of_profile(py: Python<'_>, text: &str) -> PyResult<Model> {
    Model::from_profile(text).map_err(|error| profile_error(py, &error))
}

type NumberArray<'py> = Bound<'py, PyArrayDyn<f64>>;

impl Robot {
    pub(crate) fn of(model: Model) -> Self {
        Self { model: Arc::new(model) }
    }

    /// Passes the poses at `q` of the TCP in the base of `place` to `take`, block by block, so that
    /// joints are checked while they are in the cache.
    fn tcp_poses(
        &self,
        q: &Rows<'_>,
        place: &Workplace<'_>,
        mut take: impl FnMut(&[Pose]),
    ) -> PyResult<()> {
        if place.is_flange() {
            return self.poses(q, take);
        }
        self.poses(q, |poses| {
            let poses: Vec<_> = poses.iter().map(|pose| place.tcp_pose(pose)).collect();
            take(&poses);
        })
    }

    /// Passes the flange poses at `q` to `take`, block by block.
    fn poses(&self, q: &Rows<'_>, mut take: impl FnMut(&[Pose])) -> PyResult<()> {
        let count = q.joints.len();
        let mut poses = vec![Pose::IDENTITY; BLOCK.min(count)];
        for first in (0..count).step_by(BLOCK) {
            let block = first..count.min(first + BLOCK);
            q.check("q", block.clone())?;
            let poses = &mut poses[..block.len()];
            self.model.flange_pose_batch(&q.joints[block], poses);
            take(poses);
        }
        Ok(())
    }
}

#[pymethods]
impl Robot {
    #[new]
    #[pyo3(
        signature = (model = "lbr_iiwa_7_r800".into(), *, flange_m = None),
        text_signature = "(model='lbr_iiwa_7_r800', *, flange_m=None)"
    )]
    fn new(py: Python<'_>, model: std::path::PathBuf, flange_m: Option<f64>) -> PyResult<Self> {
        let mut model = find(py, &model)?;
        if let Some(flange_m) = flange_m {
            model = model
                .with_flange_m(flange_m)
                .map_err(|error| PyValueError::new_err(error.to_string()))?;
        }
        Ok(Self::of(model))
    }

    /// Reads a robot from a JSON profile. Raises `ProfileError` with line and column.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> iw.Robot.from_profile(robot.profile()).name == robot.name
    /// True
    #[staticmethod]
    fn from_profile(py: Python<'_>, text: &str) -> PyResult<Self> {
        of_profile(py, text).map(Self::of)
    }

    /// Name of the model or profile.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> robot.name
    /// 'lbr_iiwa_7_r800'
    #[getter]
    fn name(&self) -> &str {
        self.model.name()
    }

    /// Lower and upper joint position limits (2, 7), in rad.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> robot.position_limits_rad.shape
    /// (2, 7)
    #[getter]
    fn position_limits_rad<'py>(&self, py: Python<'py>) -> PyResult<NumberArray<'py>> {
        let limits = self.model.limits();
        array(py, vec![limits.lower_rad, limits.upper_rad], &[7], false)
    }

    /// Velocity limits (7,), in rad/s.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> float(robot.velocity_limits_rad_s[0].round(3))
    /// 1.71
    #[getter]
    fn velocity_limits_rad_s<'py>(&self, py: Python<'py>) -> PyResult<NumberArray<'py>> {
        array(py, vec![self.model.limits().velocity_rad_s], &[7], true)
    }

    /// Acceleration limits (7,), in rad/s^2.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> robot.acceleration_limits_rad_s2.shape
    /// (7,)
    #[getter]
    fn acceleration_limits_rad_s2<'py>(&self, py: Python<'py>) -> PyResult<NumberArray<'py>> {
        array(py, vec![self.model.limits().acceleration_rad_s2], &[7], true)
    }

    /// Jerk limits (7,), in rad/s^3.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> bool((robot.jerk_limits_rad_s3 > 0).all())
    /// True
    #[getter]
    fn jerk_limits_rad_s3<'py>(&self, py: Python<'py>) -> PyResult<NumberArray<'py>> {
        array(py, vec![self.model.limits().jerk_rad_s3], &[7], true)
    }

    /// Torque limits (7,), in Nm.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> robot.torque_limits_nm.tolist()
    /// [176.0, 176.0, 110.0, 110.0, 110.0, 40.0, 40.0]
    #[getter]
    fn torque_limits_nm<'py>(&self, py: Python<'py>) -> PyResult<NumberArray<'py>> {
        array(py, vec![self.model.limits().torque_nm], &[7], true)
    }

    /// Assumptions of the model: parameters that no source states, each with its reason.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> any(line.startswith('masses') for line in robot.assumptions)
    /// True
    #[getter]
    fn assumptions(&self) -> Vec<String> {
        let text = |it: &iiwa_kin::Assumption| format!("{}: {}", it.quantity, it.basis);
        self.model.assumptions().iter().map(text).collect()
    }

    /// Positions of the flange centre at `q`, (7,) or (n, 7) in rad: (3,) or (n, 3), in m. `fk`
    /// and `pose` also compute the TCP of a tool.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> robot.flange([[0.0] * 7] * 1000).shape
    /// (1000, 3)
    fn flange<'py>(&self, py: Python<'py>, q: JointsLike<'py>) -> PyResult<NumberArray<'py>> {
        let rows = Rows::unchecked("q", &q)?;
        let mut positions = room(rows.joints.len())?;
        py.detach(|| {
            self.poses(&rows, |poses| positions.extend(poses.iter().map(|pose| pose.position_m)))
        })?;
        array(py, positions, &[3], rows.is_single)
    }

    /// TCP poses at `q`, (7,) or (n, 7) in rad: positions (3,) or (n, 3), in m, and rotation
    /// matrices (3, 3) or (n, 3, 3).
    ///
    /// The TCP is the flange centre, or the TCP of `tool`: the name of a tool of `program`, a frame
    /// or a pose (4, 4) in the flange frame. `program` has its own tool and base by default. `base`
    /// is the name of a base, or a frame or a pose, in the robot base.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> position, rotation = robot.fk([0.0] * 7)
    /// >>> float(position[2].round(3)), rotation.shape
    /// (1.292, (3, 3))
    /// >>> position, _ = robot.fk([0.0] * 7, tool={'z_mm': 100})
    /// >>> float(position[2].round(3))
    /// 1.392
    #[pyo3(signature = (q, *, program = None, tool = None, base = None))]
    fn fk<'py>(
        &self,
        py: Python<'py>,
        q: JointsLike<'py>,
        program: Option<&Bound<'py, Program>>,
        tool: Option<PlaceArgument<'py>>,
        base: Option<PlaceArgument<'py>>,
    ) -> PyResult<(NumberArray<'py>, NumberArray<'py>)> {
        let place = Workplace::new(py, &self.model, program.map(Bound::get), tool, base)?;
        let rows = Rows::unchecked("q", &q)?;
        let count = rows.joints.len();
        let (mut positions, mut rotations) = (room(count)?, room::<[f64; 9]>(count)?);
        py.detach(|| {
            self.tcp_poses(&rows, &place, |poses| {
                positions.extend(poses.iter().map(|pose| pose.position_m));
                rotations.extend(poses.iter().map(|pose| {
                    let [[a, b, c], [d, e, f], [g, h, i]] = pose.rotation;
                    [a, b, c, d, e, f, g, h, i]
                }));
            })
        })?;
        let positions = array(py, positions, &[3], rows.is_single)?;
        Ok((positions, array(py, rotations, &[3, 3], rows.is_single)?))
    }

    /// TCP poses at `q`, (7,) or (n, 7) in rad, as homogeneous matrices (4, 4) or (n, 4, 4) with
    /// positions in m. `program`, `tool` and `base` are as in `fk`.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> robot.pose([0.0] * 7, tool={'z_mm': 100}).round(3).tolist()[2]
    /// [0.0, 0.0, 1.0, 1.392]
    #[pyo3(signature = (q, *, program = None, tool = None, base = None))]
    fn pose<'py>(
        &self,
        py: Python<'py>,
        q: JointsLike<'py>,
        program: Option<&Bound<'py, Program>>,
        tool: Option<PlaceArgument<'py>>,
        base: Option<PlaceArgument<'py>>,
    ) -> PyResult<NumberArray<'py>> {
        let place = Workplace::new(py, &self.model, program.map(Bound::get), tool, base)?;
        let rows = Rows::unchecked("q", &q)?;
        let mut matrices = room::<[f64; 16]>(rows.joints.len())?;
        py.detach(|| {
            self.tcp_poses(&rows, &place, |poses| matrices.extend(poses.iter().map(matrix)))
        })?;
        array(py, matrices, &[4, 4], rows.is_single)
    }

    /// The TCP Jacobian at `q`, (7,) or (n, 7) in rad: (6, 7) or (n, 6, 7); three rows of linear
    /// velocity, in m, and three rows of angular velocity, along the axes of the base. `program`,
    /// `tool` and `base` are as in `fk`: without them, the Jacobian is that of the flange.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> robot.jacobian([0.1] * 7, tool={'z_mm': 100}).shape
    /// (6, 7)
    #[pyo3(signature = (q, *, program = None, tool = None, base = None))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        q: JointsLike<'py>,
        program: Option<&Bound<'py, Program>>,
        tool: Option<PlaceArgument<'py>>,
        base: Option<PlaceArgument<'py>>,
    ) -> PyResult<NumberArray<'py>> {
        let place = Workplace::new(py, &self.model, program.map(Bound::get), tool, base)?;
        let rows = Rows::new("q", &q)?;
        let all = py.detach(|| rows.joints.iter().map(|q| place.jacobian(q)).collect());
        array(py, all, &[6, 7], rows.is_single)
    }

    /// Joint positions (7,), in rad, with the TCP at `frame`.
    ///
    /// `frame` is a dict as in programs (`x_mm` to `c_deg`, with `e1_deg` and `status`), a pose
    /// (4, 4) with its position in m, or the name of a frame of `program`. `program`, `tool` and
    /// `base` are as in `fk`. E1 (the A3 position) and the status may be separate arguments, or
    /// taken from nearby joint positions, `near` (7,), in rad within the joint limits. Raises
    /// `UnreachableError` with the reachable ranges of E1.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> frame = robot.frame([0, 0.5, 0.1, -1.0, 0, 0.7, 0])
    /// >>> bool(abs(robot.ik(frame) - [0, 0.5, 0.1, -1.0, 0, 0.7, 0]).max() < 1e-9)
    /// True
    #[pyo3(signature = (frame, *, e1_deg = None, status = None, near = None, program = None,
        tool = None, base = None))]
    #[expect(clippy::too_many_arguments, reason = "they are options by keyword in Python")]
    fn ik<'py>(
        &self,
        py: Python<'py>,
        frame: &Bound<'py, PyAny>,
        e1_deg: Option<f64>,
        status: Option<i64>,
        near: Option<JointsLike<'py>>,
        program: Option<&Bound<'py, Program>>,
        tool: Option<PlaceArgument<'py>>,
        base: Option<PlaceArgument<'py>>,
    ) -> PyResult<NumberArray<'py>> {
        let near = near.as_ref().map(|near| Rows::new("near", near)).transpose()?;
        let near = near.as_ref().map(|near| near.single("near")).transpose()?;
        let place = Workplace::new(py, &self.model, program.map(Bound::get), tool, base)?;
        let joints = place.joints(py, frame, e1_deg, status, near)?;
        array(py, vec![joints], &[7], true)
    }

    /// The TCP frame at `q` (7,), in rad, as a dict for programs: `x_mm` to `c_deg`, `e1_deg`,
    /// `status` and `turn`. `program`, `tool` and `base` are as in `fk`. `q` has to be within the
    /// joint limits.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> sorted(robot.frame([0.0] * 7))
    /// ['a_deg', 'b_deg', 'c_deg', 'e1_deg', 'status', 'turn', 'x_mm', 'y_mm', 'z_mm']
    #[pyo3(signature = (q, *, program = None, tool = None, base = None))]
    fn frame<'py>(
        &self,
        py: Python<'py>,
        q: JointsLike<'py>,
        program: Option<&Bound<'py, Program>>,
        tool: Option<PlaceArgument<'py>>,
        base: Option<PlaceArgument<'py>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let rows = Rows::new("q", &q)?;
        let place = Workplace::new(py, &self.model, program.map(Bound::get), tool, base)?;
        let joints = rows.single("q")?;
        frames::check_range("q", &self.model, joints)?;
        place.frame(py, joints)
    }

    /// Joint torques, in Nm, at `q` with the velocities `dq` and the accelerations `ddq`, which are
    /// 0 by default; all (7,) or (n, 7). `load` is the load at the flange, a dict as in programs:
    /// `mass_kg`, `center_mm` and so on.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> lying = [0, 1.5707963, 0, 0, 0, 0, 0]
    /// >>> robot.torques(lying).round(1).tolist()[1]
    /// -65.3
    /// >>> robot.torques(lying, load={'mass_kg': 5, 'center_mm': [0, 0, 50]}).round(1).tolist()[1]
    /// -114.4
    #[pyo3(signature = (q, dq = None, ddq = None, *, load = None))]
    fn torques<'py>(
        &self,
        py: Python<'py>,
        q: JointsLike<'py>,
        dq: Option<JointsLike<'py>>,
        ddq: Option<JointsLike<'py>>,
        load: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<NumberArray<'py>> {
        let rows = Rows::new("q", &q)?;
        let count = rows.joints.len();
        let dq = dq.as_ref().map(|rates| Rows::new("dq", rates)).transpose()?;
        let ddq = ddq.as_ref().map(|rates| Rows::new("ddq", rates)).transpose()?;
        for (name, rates) in [("dq", &dq), ("ddq", &ddq)] {
            if rates.as_ref().is_some_and(|it| it.joints.len() != count) {
                return Err(PyValueError::new_err(format!("{name} has not as many rows as q")));
            }
        }
        let mut dynamics = self.model.dynamics();
        if let Some(load) = load {
            dynamics = dynamics.with_load(&frames::load(py, load)?);
        }
        let mut torques = vec![[0.0; 7]; count];
        py.detach(|| {
            let zeros = vec![[0.0; 7]; count];
            let or_zeros = |rates: &Option<Rows<'_>>| -> Vec<Joints> {
                rates.as_ref().map_or_else(|| zeros.clone(), |rates| rates.joints.to_vec())
            };
            dynamics.torques_batch(&rows.joints, &or_zeros(&dq), &or_zeros(&ddq), &mut torques);
        });
        array(py, torques, &[7], rows.is_single)
    }

    /// The mass matrix (7, 7) at `q` (7,), in kg m^2.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> robot.mass_matrix([0.0] * 7).shape
    /// (7, 7)
    fn mass_matrix<'py>(&self, py: Python<'py>, q: JointsLike<'py>) -> PyResult<NumberArray<'py>> {
        let rows = Rows::new("q", &q)?;
        let matrix = self.model.dynamics().mass_matrix(rows.single("q")?);
        array(py, matrix.to_vec(), &[7], false)
    }

    /// The complete JSON profile, which `from_profile` reads.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> robot.profile().startswith('{')
    /// True
    fn profile(&self) -> String {
        self.model.to_full_profile()
    }

    /// Writes the profile to a file, which `Robot(path)` and `iiwasim plan --robot` read. A profile
    /// contains all parameters, but not `assumptions`.
    ///
    /// >>> import iiwasim as iw, os, tempfile
    /// >>> with tempfile.TemporaryDirectory() as folder:
    /// ...     file = os.path.join(folder, 'mine.json')
    /// ...     iw.Robot().save(file)
    /// ...     iw.Robot(file) == iw.Robot()
    /// True
    fn save(&self, path: std::path::PathBuf) -> PyResult<()> {
        write(&path, &format!("{}\n", self.model.to_full_profile()))
    }

    /// The robot model as URDF.
    ///
    /// >>> import iiwasim as iw
    /// >>> robot = iw.Robot()
    /// >>> '<robot' in robot.urdf()
    /// True
    fn urdf(&self) -> String {
        self.model.to_urdf()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Pickled<'py>> {
        let parts = (restorable(&slf.get().model),);
        Ok((slf.get_type().getattr("_restore")?, parts.into_pyobject(slf.py())?))
    }

    #[staticmethod]
    #[pyo3(signature = (text, /))]
    fn _restore(py: Python<'_>, text: &str) -> PyResult<Self> {
        restored(py, text).map(Self::of)
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| is_same(&other.get().model, &self.model))
    }

    fn __hash__(&self) -> u64 {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hasher = DefaultHasher::new();
        self.model.name().hash(&mut hasher);
        hasher.finish()
    }

    fn __repr__(&self) -> String {
        format!("<iiwasim.Robot {}>", self.model.name())
    }
}
