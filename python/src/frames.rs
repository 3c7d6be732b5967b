//! Frames, tools and loads, with the keys of motion programs.

use iiwa_kin::{Joints, Load, Pose, Redundancy, Robot, Status};
use iiwa_program::{Target, TargetRef, Workcell};
use numpy::{Ix2, PyArrayDyn, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::{
    exceptions::PyValueError,
    prelude::*,
    types::{PyDict, PyMapping, PyString},
};

use crate::{
    arrays::{RealArray, array},
    errors::{argument_error, exception, unexpected},
    program::Program,
};

/// The JSON of a Python object.
pub(crate) fn json(py: Python<'_>, value: &Bound<'_, PyAny>) -> PyResult<String> {
    py.import("iiwasim._json")?.call_method1("dumps", (value,))?.extract()
}

/// The JSON of a program; the error names the motion in which a value is not finite.
pub(crate) fn json_of_program(py: Python<'_>, program: &Bound<'_, PyDict>) -> PyResult<String> {
    py.import("iiwasim._json")?.call_method1("program", (program,))?.extract()
}

/// The Python object of a JSON text.
pub(crate) fn object<'py>(py: Python<'py>, json: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (json,))
}

fn invalid(error: &dyn std::error::Error) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// A load from a dict as in programs: `mass_kg`, `center_mm` and so on.
pub(crate) fn load(py: Python<'_>, load: &Bound<'_, PyAny>) -> PyResult<Load> {
    if load.cast::<PyMapping>().is_err() {
        return Err(unexpected("load", load, "a dict with mass_kg and center_mm"));
    }
    let text = format!(
        r#"{{"version": 1, "tools": {{"load": {{"tcp": {{}}, "load": {}}}}}}}"#,
        json(py, load)?
    );
    let workcell = Workcell::from_json(&text)
        .map_err(|error| argument_error(py, &error, &text, &["tools", "load", "load"], "load"))?;
    workcell
        .load(Some("load"))
        .copied()
        .ok_or_else(|| PyValueError::new_err("load is a dict with mass_kg and center_mm"))
}

/// Checks that joint positions, the argument `name`, are within the joint limits.
pub(crate) fn check_range(name: &str, robot: &Robot, joints: &Joints) -> PyResult<()> {
    let Err(outside) = robot.limits().check(joints) else { return Ok(()) };
    // Positions in degrees are within the limits if they are converted.
    let are_degrees = robot.limits().check(&joints.map(f64::to_radians)).is_ok();
    let advice = if are_degrees { "; convert degrees with numpy.radians" } else { "" };
    Err(PyValueError::new_err(format!(
        "{name} is in rad, and outside the joint limits: {outside}{advice}"
    )))
}

/// Homogeneous matrix of a pose, row-major.
pub(crate) fn matrix(pose: &Pose) -> [f64; 16] {
    let [[a, b, c], [d, e, f], [g, h, i]] = pose.rotation;
    let [x, y, z] = pose.position_m;
    [a, b, c, x, d, e, f, y, g, h, i, z, 0.0, 0.0, 0.0, 1.0]
}

/// The pose of a homogeneous matrix (4, 4), the argument `name`, with its position in m.
fn pose_of_matrix(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Pose> {
    /// Largest deviation of a rotation matrix from an orthonormal one.
    const TOLERANCE: f64 = 1e-6;
    let wrong =
        |fault: &str| PyValueError::new_err(format!("{name} is not a pose (4, 4): {fault}"));
    let given: RealArray<'_, Ix2> = value.extract().map_err(|_| wrong("numbers are expected"))?;
    let rows = given.as_array();
    if rows.shape() != [4, 4] {
        return Err(wrong(&format!("its shape is {:?}", rows.shape())));
    }
    if !rows.iter().all(|value| value.is_finite()) {
        return Err(wrong("it contains a value that is not finite"));
    }
    if (0..4).any(|j| (rows[[3, j]] - f64::from(u8::from(j == 3))).abs() > TOLERANCE) {
        return Err(wrong("its last row has to be [0, 0, 0, 1]"));
    }
    let rotation: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| rows[[i, j]]));
    let product = |a: usize, b: usize| (0..3).map(|k| rotation[k][a] * rotation[k][b]).sum::<f64>();
    let is_unit =
        |a: usize, b: usize| (product(a, b) - f64::from(u8::from(a == b))).abs() <= TOLERANCE;
    let [[a, b, c], [d, e, f], [g, h, i]] = rotation;
    let determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
    if !(0..3).all(|a| (0..3).all(|b| is_unit(a, b))) || determinant < 0.0 {
        return Err(wrong("its upper left part is not a rotation matrix"));
    }
    Ok(Pose { position_m: std::array::from_fn(|i| rows[[i, 3]]), rotation })
}

fn is_array(value: &Bound<'_, PyAny>) -> bool {
    value.cast::<PyUntypedArray>().is_ok_and(|array| array.ndim() > 0)
}

/// Position and orientation of a frame in a dict with the keys of programs.
fn pose_dict<'py>(py: Python<'py>, pose: &Pose) -> PyResult<Bound<'py, PyDict>> {
    let frame = PyDict::new(py);
    for (key, value) in ["x_mm", "y_mm", "z_mm"].iter().zip(pose.position_m) {
        frame.set_item(key, 1e3 * value)?;
    }
    for (key, value) in ["a_deg", "b_deg", "c_deg"].iter().zip(pose.abc_rad()) {
        frame.set_item(key, value.to_degrees())?;
    }
    Ok(frame)
}

/// Converts a pose (4, 4), with its position in m, to a frame of programs: a dict with `x_mm` to
/// `c_deg`, and with `e1_deg`, `status` and `turn` if given.
///
/// Frames of motions and of programs may also be poses themselves, if they need no E1 and status.
///
/// >>> import iiwasim as iw, numpy as np
/// >>> pose = np.eye(4)
/// >>> pose[:3, 3] = 0.5, 0, 0.25
/// >>> iw.frame(pose, e1_deg=0)
/// {'x_mm': 500.0, 'y_mm': 0.0, 'z_mm': 250.0, 'a_deg': 0.0, ..., 'e1_deg': 0.0}
#[pyfunction]
#[pyo3(signature = (pose, *, e1_deg = None, status = None, turn = None))]
pub(crate) fn frame<'py>(
    py: Python<'py>,
    pose: &Bound<'py, PyAny>,
    e1_deg: Option<f64>,
    status: Option<i64>,
    turn: Option<i64>,
) -> PyResult<Bound<'py, PyDict>> {
    let frame = pose_dict(py, &pose_of_matrix("pose", pose)?)?;
    if let Some(e1_deg) = e1_deg {
        frame.set_item("e1_deg", e1_deg)?;
    }
    for (key, bits) in [("status", status), ("turn", turn)] {
        if let Some(bits) = bits {
            frame.set_item(key, bits)?;
        }
    }
    Ok(frame)
}

/// Converts a frame, a dict with the keys of programs, to a pose (4, 4) with its position in m, in
/// the base of the frame.
///
/// >>> import iiwasim as iw
/// >>> iw.pose({'x_mm': 500, 'z_mm': 250}).tolist()[0]
/// [1.0, 0.0, 0.0, 0.5]
#[pyfunction]
#[pyo3(signature = (frame, /))]
pub(crate) fn pose<'py>(
    py: Python<'py>,
    frame: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    if frame.cast::<PyMapping>().is_err() {
        return Err(unexpected("frame", frame, "a dict with x_mm to c_deg"));
    }
    let plain = PyDict::new(py);
    for item in frame.call_method0("items")?.try_iter()? {
        let (key, value): (String, Bound<'py, PyAny>) = item?.extract()?;
        // The other keys of a frame do not change its pose.
        if !["base", "e1_deg", "e1_rad", "status", "turn"].contains(&key.as_str()) {
            plain.set_item(key, value)?;
        }
    }
    array(py, vec![matrix(&pose_of_frame(py, "frame", plain.as_any())?)], &[4, 4], true)
}

/// The pose of a frame without base, the argument `name`.
fn pose_of_frame(py: Python<'_>, name: &str, frame: &Bound<'_, PyAny>) -> PyResult<Pose> {
    let text = format!(r#"{{"version": 1, "tools": {{"t": {{"tcp": {}}}}}}}"#, json(py, frame)?);
    let workcell = Workcell::from_json(&text)
        .map_err(|error| argument_error(py, &error, &text, &["tools", "t", "tcp"], name))?;
    workcell.tcp(Some("t")).map_err(|fault| invalid(&fault))
}

/// A tool or a base: its name, a frame, or a pose (4, 4).
pub(crate) enum PlaceArgument<'py> {
    Name(String),
    Value(Bound<'py, PyAny>),
}

impl<'py> FromPyObject<'_, 'py> for PlaceArgument<'py> {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if value.is_instance_of::<PyString>() {
            return value.extract().map(Self::Name);
        }
        if is_array(&value) || value.cast::<PyMapping>().is_ok() {
            return Ok(Self::Value(value.to_owned()));
        }
        Err(unexpected(
            "tool or base",
            &value,
            "a name, a dict with x_mm to c_deg, or a pose (4, 4)",
        ))
    }
}

impl PlaceArgument<'_> {
    /// The name, if it is one.
    fn name(&self) -> Option<&str> {
        match self {
            Self::Name(name) => Some(name),
            Self::Value(_) => None,
        }
    }

    /// The pose of a frame or a matrix, the argument `name`.
    fn pose(&self, py: Python<'_>, name: &str) -> PyResult<Option<Pose>> {
        match self {
            Self::Name(_) => Ok(None),
            Self::Value(value) if is_array(value) => pose_of_matrix(name, value).map(Some),
            Self::Value(value) => pose_of_frame(py, name, value).map(Some),
        }
    }
}

/// A robot with the tool and base of a program; without a program, the bare flange and the robot
/// foot.
pub(crate) struct Workplace<'a> {
    robot: &'a Robot,
    workcell: Workcell,
    base_name: Option<String>,
    tcp: Pose,
    base: Pose,
    /// True if `base` is not a base of the program.
    has_free_base: bool,
}

impl<'a> Workplace<'a> {
    pub(crate) fn new(
        py: Python<'_>,
        robot: &'a Robot,
        program: Option<&Program>,
        tool: Option<PlaceArgument<'_>>,
        base: Option<PlaceArgument<'_>>,
    ) -> PyResult<Self> {
        let workcell = program.map(|it| it.parsed().workcell.clone()).unwrap_or_default();
        let free_tcp = tool.as_ref().map(|tool| tool.pose(py, "tool")).transpose()?.flatten();
        let free_base = base.as_ref().map(|base| base.pose(py, "base")).transpose()?.flatten();
        let tcp = if let Some(pose) = free_tcp {
            pose
        } else {
            let name = tool.as_ref().and_then(PlaceArgument::name);
            workcell.tcp(name).map_err(|fault| invalid(&fault))?
        };
        let base_name = base.as_ref().and_then(PlaceArgument::name).map(str::to_owned);
        let base = match free_base {
            Some(pose) => pose,
            None => workcell.base(base_name.as_deref()).map_err(|fault| invalid(&fault))?,
        };
        let has_free_base = free_base.is_some();
        Ok(Self { robot, workcell, base_name, tcp, base, has_free_base })
    }

    /// True if TCP and base are the flange and the robot base.
    pub(crate) fn is_flange(&self) -> bool {
        self.tcp == Pose::IDENTITY && self.base == Pose::IDENTITY
    }

    /// The TCP pose in the base, from the flange pose.
    pub(crate) fn tcp_pose(&self, flange: &Pose) -> Pose {
        let mut pose = *flange;
        if self.tcp != Pose::IDENTITY {
            pose = pose.then(&self.tcp);
        }
        if self.base != Pose::IDENTITY {
            pose = self.base.inverse().then(&pose);
        }
        pose
    }

    /// The Jacobian of the TCP, row-major, along the axes of the base.
    pub(crate) fn jacobian(&self, q: &Joints) -> [f64; 42] {
        let jacobian = self.robot.jacobian(q);
        let mut columns: [[f64; 6]; 7] =
            std::array::from_fn(|j| std::array::from_fn(|i| jacobian[(i, j)]));
        if !self.is_flange() {
            let flange = self.robot.flange_pose(q);
            let tcp_m = flange.then(&self.tcp).position_m;
            let arm: [f64; 3] = std::array::from_fn(|i| tcp_m[i] - flange.position_m[i]);
            for column in &mut columns {
                let [vx, vy, vz, wx, wy, wz] = *column;
                // v + w x arm
                let linear = [
                    vx + wy * arm[2] - wz * arm[1],
                    vy + wz * arm[0] - wx * arm[2],
                    vz + wx * arm[1] - wy * arm[0],
                ];
                let in_base = |vector: [f64; 3]| -> [f64; 3] {
                    let axes = &self.base.rotation;
                    std::array::from_fn(|i| (0..3).map(|k| axes[k][i] * vector[k]).sum())
                };
                let ([x, y, z], [a, b, c]) = (in_base(linear), in_base([wx, wy, wz]));
                *column = [x, y, z, a, b, c];
            }
        }
        std::array::from_fn(|i| columns[i % 7][i / 7])
    }

    /// Joint positions with the TCP at `frame`, a dict or the name of a program frame.
    pub(crate) fn joints(
        &self,
        py: Python<'_>,
        frame: &Bound<'_, PyAny>,
        e1_deg: Option<f64>,
        status: Option<i64>,
        near: Option<&Joints>,
    ) -> PyResult<Joints> {
        let frame = if let Ok(name) = frame.extract::<String>() {
            TargetRef::Named(name)
        } else {
            let text = if is_array(frame) {
                json(py, pose_dict(py, &pose_of_matrix("frame", frame)?)?.as_any())?
            } else {
                json(py, frame)?
            };
            let target = Target::from_json(&text);
            TargetRef::Given(
                target.map_err(|error| argument_error(py, &error, &text, &[], "frame"))?,
            )
        };
        let resolved = self.workcell.target(&frame, self.base_name.as_deref());
        let (target, mut pose) = resolved.map_err(|fault| invalid(&fault))?;
        // A named frame, and a frame with a base of its own, are not in the given base.
        if let (true, TargetRef::Given(Target { base: None, .. })) = (self.has_free_base, &frame) {
            pose = self.base.then(&target.frame.pose());
        }
        if let Some(near) = near {
            check_range("near", self.robot, near)?;
        }
        let flange = if self.tcp == Pose::IDENTITY { pose } else { pose.then(&self.tcp.inverse()) };
        let near = near.map(|joints| self.robot.redundancy(joints));
        let missing = |quantity: &str, key: &str| {
            PyValueError::new_err(format!(
                "{quantity} is missing: give {key}, or joints nearby as near"
            ))
        };
        if let Some(e1_deg) = e1_deg.filter(|it| !it.is_finite()) {
            return Err(PyValueError::new_err(format!("e1_deg is {e1_deg}; it has to be finite")));
        }
        let e1_rad = e1_deg.map(f64::to_radians).or(target.e1_rad);
        let e1_rad = e1_rad
            .or(near.map(|near| near.e1_rad))
            .ok_or_else(|| missing("E1, the position of joint A3,", "e1_deg"))?;
        let given = match status {
            None => None,
            Some(bits) => {
                let known = u8::try_from(bits).ok().and_then(Status::new);
                let refused = || format!("status is {bits}; it is from 0 to 7");
                Some(known.ok_or_else(|| PyValueError::new_err(refused()))?)
            }
        };
        let status = given
            .or(target.status)
            .or(near.map(|near| near.status))
            .ok_or_else(|| missing("the status, 0 to 7,", "status"))?;
        let unreachable = |reason: &dyn std::error::Error| {
            let ranges = self.robot.allowed_e1(&flange, status).unwrap_or_default();
            let ranges = ranges.iter().map(|range| range.map(f64::to_degrees)).collect::<Vec<_>>();
            exception(py, "UnreachableError", (reason.to_string(), ranges))
        };
        let joints = self.robot.inverse(&flange, e1_rad, status).map_err(|it| unreachable(&it))?;
        self.robot.limits().check(&joints).map_err(|outside| unreachable(&outside))?;
        Ok(joints)
    }

    /// The TCP frame in the base, as [`Target::from_json`] reads it.
    pub(crate) fn frame<'py>(
        &self,
        py: Python<'py>,
        joints: &Joints,
    ) -> PyResult<Bound<'py, PyDict>> {
        let pose = self.tcp_pose(&self.robot.flange_pose(joints));
        let Redundancy { e1_rad, status, turn } = self.robot.redundancy(joints);
        let frame = pose_dict(py, &pose)?;
        frame.set_item("e1_deg", e1_rad.to_degrees())?;
        frame.set_item("status", status.bits())?;
        frame.set_item("turn", turn.bits())?;
        Ok(frame)
    }
}
