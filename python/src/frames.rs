//! Frames, tools and loads, with the keys of motion programs.

use iiwa_kin::{Joints, Load, Pose, Redundancy, Robot, Status};
use iiwa_program::{Target, TargetRef, Workcell};
use pyo3::{
    exceptions::PyValueError,
    prelude::*,
    types::{PyDict, PyMapping},
};

use crate::{
    errors::{exception, program_error, unexpected},
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
    let workcell = Workcell::from_json(&text).map_err(|error| program_error(py, &error))?;
    workcell
        .load(Some("load"))
        .copied()
        .ok_or_else(|| PyValueError::new_err("load is a dict with mass_kg and center_mm"))
}

/// A robot with the tool and base of a program; without a program, the bare flange and the robot
/// foot.
pub(crate) struct Workplace<'a> {
    robot: &'a Robot,
    workcell: Workcell,
    base_name: Option<String>,
    tcp: Pose,
    base: Pose,
}

impl<'a> Workplace<'a> {
    pub(crate) fn new(
        robot: &'a Robot,
        program: Option<&Program>,
        tool: Option<String>,
        base_name: Option<String>,
    ) -> PyResult<Self> {
        let workcell = program.map(|it| it.parsed().workcell.clone()).unwrap_or_default();
        let tcp = workcell.tcp(tool.as_deref()).map_err(|fault| invalid(&fault))?;
        let base = workcell.base(base_name.as_deref()).map_err(|fault| invalid(&fault))?;
        Ok(Self { robot, workcell, base_name, tcp, base })
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
            let target = Target::from_json(&json(py, frame)?);
            TargetRef::Given(target.map_err(|error| program_error(py, &error))?)
        };
        let resolved = self.workcell.target(&frame, self.base_name.as_deref());
        let (target, pose) = resolved.map_err(|fault| invalid(&fault))?;
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
        let mut pose = self.robot.flange_pose(joints);
        if self.tcp != Pose::IDENTITY {
            pose = pose.then(&self.tcp);
        }
        if self.base != Pose::IDENTITY {
            pose = self.base.inverse().then(&pose);
        }
        let Redundancy { e1_rad, status, turn } = self.robot.redundancy(joints);
        let frame = PyDict::new(py);
        for (key, value) in ["x_mm", "y_mm", "z_mm"].iter().zip(pose.position_m) {
            frame.set_item(key, 1e3 * value)?;
        }
        for (key, value) in ["a_deg", "b_deg", "c_deg"].iter().zip(pose.abc_rad()) {
            frame.set_item(key, value.to_degrees())?;
        }
        frame.set_item("e1_deg", e1_rad.to_degrees())?;
        frame.set_item("status", status.bits())?;
        frame.set_item("turn", turn.bits())?;
        Ok(frame)
    }
}
