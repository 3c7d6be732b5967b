//! TCP poses and frame poses in the workcell of a program.

use iiwa_json::excerpt;
use iiwa_kin::{Joints, Pose, Redundancy, Robot};
use iiwa_program::{Target, TargetRef, Workcell};
use serde::Serialize;

use crate::{
    args::ToolAndBase,
    failure::Failure,
    input::{self, default_robot, find_robot},
};

/// Robot with the tool and base of a program; without a program, the bare flange and the robot
/// base.
pub(crate) struct Workplace {
    pub(crate) robot: Robot,
    workcell: Workcell,
    place: ToolAndBase,
    tcp: Pose,
    base: Pose,
}

impl Workplace {
    /// Creates the workplace with the robot, and the tool and the base of the options, or those of
    /// the program.
    pub(crate) fn new(robot: Option<&str>, place: &ToolAndBase) -> Result<Self, Failure> {
        let (workcell, robot) = if let Some(path) = &place.program {
            input::workcell(path, robot)?
        } else {
            let robot = robot.map_or_else(default_robot, find_robot)?;
            (Workcell::default(), robot)
        };
        let [tool, base] = [&place.tool, &place.base].map(|name| name.as_deref());
        let unknown = |fault: iiwa_program::NameFault| Failure::input(fault.to_string());
        let tcp = workcell.tcp(tool).map_err(unknown)?;
        let base = workcell.base(base).map_err(unknown)?;
        Ok(Self { robot, workcell, place: place.clone(), tcp, base })
    }

    /// TCP pose in the base, at `joints_rad`.
    pub(crate) fn pose(&self, joints_rad: &Joints) -> Pose {
        let mut pose = self.robot.flange_pose(joints_rad);
        // Skipping identity poses avoids rounding.
        if self.tcp != Pose::IDENTITY {
            pose = pose.then(&self.tcp);
        }
        if self.base != Pose::IDENTITY {
            pose = self.base.inverse().then(&pose);
        }
        pose
    }

    /// Parses `--frame`: JSON or the name of a frame in the program.
    pub(crate) fn frame_named(&self, text: &str) -> Result<TargetRef, Failure> {
        if text.trim_start().starts_with('{') {
            return Target::from_json(text).map(TargetRef::Given).map_err(|error| {
                Failure::in_text(&error.message(), error.place(), "--frame", text)
            });
        }
        if self.place.program.is_none() {
            return Err(Failure::input(format!(
                "--frame: `{}` is not a JSON object; the name of a frame needs --program, the file \
                 that has it",
                excerpt(text)
            )));
        }
        Ok(TargetRef::Named(text.to_owned()))
    }

    /// Returns a target frame, and the corresponding flange pose in the robot base.
    pub(crate) fn target(&self, target: &TargetRef) -> Result<(Target, Pose), Failure> {
        let resolved = self.workcell.target(target, self.place.base.as_deref());
        let (target, pose) = resolved.map_err(|fault| Failure::input(fault.to_string()))?;
        let flange = match self.tcp {
            Pose::IDENTITY => pose,
            tcp => pose.then(&tcp.inverse()),
        };
        Ok((target.clone(), flange))
    }

    /// TCP frame in the base, at `joints_rad`.
    pub(crate) fn frame(&self, joints_rad: &Joints) -> ReachedFrame {
        ReachedFrame::new(&self.robot, &self.pose(joints_rad), joints_rad)
    }
}

/// Frame of the TCP in the base, in the format of [`Target::from_json`].
#[derive(Serialize)]
pub(crate) struct ReachedFrame {
    pub(crate) x_mm: f64,
    pub(crate) y_mm: f64,
    pub(crate) z_mm: f64,
    pub(crate) a_deg: f64,
    pub(crate) b_deg: f64,
    pub(crate) c_deg: f64,
    pub(crate) e1_deg: f64,
    pub(crate) status: u8,
    pub(crate) turn: u8,
}

impl ReachedFrame {
    fn new(robot: &Robot, pose: &Pose, joints_rad: &Joints) -> Self {
        let [x_mm, y_mm, z_mm] = pose.position_m.map(|v| 1e3 * v);
        let [a_deg, b_deg, c_deg] = pose.abc_rad().map(f64::to_degrees);
        let Redundancy { e1_rad, status, turn } = robot.redundancy(joints_rad);
        Self {
            x_mm,
            y_mm,
            z_mm,
            a_deg,
            b_deg,
            c_deg,
            e1_deg: e1_rad.to_degrees(),
            status: status.bits(),
            turn: turn.bits(),
        }
    }
}
