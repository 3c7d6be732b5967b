//! Joint positions at the targets of a program.

use iiwa_kin::{Joints, Robot, Status};

use crate::{
    cartesian_fault::CartesianFault,
    fault::Fault,
    program::{Program, Start},
    target::TargetRef,
};

impl Program {
    /// Joint positions before the first motion, in rad.
    ///
    /// # Errors
    ///
    /// If the start is given as a frame that the robot cannot reach.
    pub fn start_rad(&self, robot: &Robot) -> Result<Joints, Fault> {
        match &self.start {
            Start::Joints(joints_rad) => Ok(*joints_rad),
            Start::Frame(target) => {
                self.joints_at(robot, None, target, [None, None]).map_err(|(key, fault)| {
                    Fault::Cartesian { motion: None, key, fault: Box::new(fault) }
                })
            }
        }
    }

    /// Joint positions at a target. E1 and status default to those of the joints `before`; `tool`
    /// and `base` are the motion's names, by default the program's.
    ///
    /// # Errors
    ///
    /// If a name is unknown or the robot cannot reach the frame; returns the fault with the key of
    /// the motion at which it is.
    pub fn joints_at(
        &self,
        robot: &Robot,
        before: Option<&Joints>,
        target: &TargetRef,
        [tool, base]: [Option<&str>; 2],
    ) -> Result<Joints, (&'static str, CartesianFault)> {
        let named = |key| move |fault| (key, CartesianFault::Name(fault));
        let tcp = self.workcell.tcp(tool).map_err(named("tool"))?;
        let (target, pose) = self.workcell.target(target, base).map_err(named("frame"))?;
        let e1_rad = target.e1_rad.or(before.map(|q| q[2])).unwrap_or(0.0);
        let status = target
            .status
            .or(before.map(|q| Status::of(robot, q)))
            .unwrap_or_else(|| Status::of(robot, &[0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0]));
        let at_frame = |fault| ("frame", fault);
        let flange = pose.then(&tcp.inverse());
        let joints = robot
            .inverse(&flange, e1_rad, status)
            .map_err(|fault| at_frame(CartesianFault::Unreachable(fault)))?;
        robot.limits().check(&joints).map_err(|outside| {
            at_frame(CartesianFault::outside(robot, &flange, e1_rad, status, outside))
        })?;
        Ok(joints)
    }
}
