//! All faults of a program on a robot.

use std::collections::BTreeSet;

use iiwa_kin::{Robot, Unreachable};

use crate::{
    cartesian_fault::CartesianFault,
    cartesian_motion::{CartesianMotion, Circ, Course, SegmentCourse},
    fault::Fault,
    motion_index::MotionIndex,
    program::{CheckedEntry, Motion, Program, check_joints},
    target::TargetRef,
};

/// Fault with the key of the motion or the segment that has it.
type KeyFault = (&'static str, CartesianFault);

impl Program {
    /// Returns the faults that do not depend on preceding motions: at most one for the start and
    /// for each motion, in order; one for all rounds of a motion in repeat blocks. Checked are
    /// numbers, joint ranges of given joint positions, names of tools, bases and frames, and the
    /// distance of frames from the shoulder. Courses are not checked, because they depend on the
    /// end of the preceding motion.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_program::Program;
    ///
    /// let far = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.1];
    /// let program = Program::from_rad([0.0; 7]).ptp_rad(far).ptp_rad([0.0; 7]).ptp_rad(far);
    /// let program = program.build();
    /// let faults = program.faults(&Robot::default());
    /// let motions = faults.iter().filter_map(|fault| fault.motion());
    /// assert_eq!(motions.map(|it| it.index()).collect::<Vec<_>>(), [0, 2]);
    /// ```
    #[must_use]
    pub fn faults(&self, robot: &Robot) -> Vec<Fault> {
        let start = self.start_rad(robot);
        let start = start.and_then(|start_rad| check_joints(None, &start_rad, robot.limits()));
        let mut faults: Vec<Fault> = start.err().into_iter().collect();
        // In each round, the same motion has the same fault; but a motion after another round may
        // have a fault that the motion before the block does not cause.
        let mut faulty = BTreeSet::new();
        for checked in self.checked_entries(0..self.motions.len()) {
            let CheckedEntry { motion, entry, .. } = checked;
            let first = self.sources.in_first_rounds(motion);
            let is_repeated = first != motion && self.motions.get(first.index()) == Some(entry);
            if is_repeated && faulty.contains(&first) {
                continue;
            }
            let check = self.check_entry(&checked);
            // The reach does not depend on other motions.
            let reach =
                || if is_repeated { Ok(()) } else { self.check_reach(robot, motion, entry) };
            if let Err(fault) = check.and_then(|()| reach()) {
                faulty.insert(if is_repeated { first } else { motion });
                faults.push(fault);
            }
        }
        faults
    }

    fn check_reach(&self, robot: &Robot, motion: MotionIndex, entry: &Motion) -> Result<(), Fault> {
        match entry {
            Motion::Ptp(ptp) => check_joints(Some(motion), &ptp.target_rad, robot.limits()),
            Motion::Cartesian(it) => self
                .motion_fault(robot, it)
                .map_or(Ok(()), |fault| Err(cartesian(Some(motion), fault))),
            Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => Ok(()),
        }
    }

    fn motion_fault(&self, robot: &Robot, motion: &CartesianMotion) -> Option<KeyFault> {
        let (tool, base) = (motion.tool.as_deref(), motion.base.as_deref());
        let target = |target: &TargetRef| self.target_fault(robot, [tool, base], "frame", target);
        // With an angle, the arc may end before the frame.
        let circle = |circ: &Circ| {
            let end = target(&circ.to).filter(|(_, fault)| {
                circ.angle_rad.is_none() || matches!(fault, CartesianFault::Name(_))
            });
            self.name_fault(base, "aux", &circ.aux).or(end)
        };
        match &motion.course {
            Course::Ptp { to } | Course::Lin { to } => target(to),
            Course::LinRel { within, .. } => {
                let tool = self.workcell.tcp(tool).err().map(|fault| ("tool", fault.into()));
                let reference = |within| self.workcell.reference(within, base).err();
                tool.or_else(|| Some(("in", reference(within.as_ref()?)?.into())))
            }
            Course::Circ(circ) => circle(circ),
            Course::Spline(segments) => segments.iter().enumerate().find_map(|(index, segment)| {
                let (key, fault) = match &segment.course {
                    SegmentCourse::Spl { to } | SegmentCourse::Lin { to } => target(to),
                    SegmentCourse::Circ(circ) => circle(circ),
                }?;
                let fault = CartesianFault::Segment { index, key, fault: Box::new(fault) };
                Some(("segments", fault))
            }),
        }
    }

    fn name_fault(
        &self,
        base: Option<&str>,
        key: &'static str,
        target: &TargetRef,
    ) -> Option<KeyFault> {
        self.workcell.target(target, base).err().map(|fault| (key, fault.into()))
    }

    /// Unknown names of a target, and a distance from the shoulder that the arm cannot reach with
    /// any E1 and status.
    fn target_fault(
        &self,
        robot: &Robot,
        names: [Option<&str>; 2],
        key: &'static str,
        target: &TargetRef,
    ) -> Option<KeyFault> {
        let (found_key, fault) = self.joints_at(robot, Some(&[0.0; 7]), target, names).err()?;
        let key = if found_key == "tool" { found_key } else { key };
        let is_independent = match &fault {
            CartesianFault::Name(_) => true,
            CartesianFault::Unreachable(reason) => {
                matches!(reason, Unreachable::TooFar { .. } | Unreachable::TooNear { .. })
            }
            _ => false,
        };
        is_independent.then_some((key, fault))
    }
}

fn cartesian(motion: Option<MotionIndex>, (key, fault): KeyFault) -> Fault {
    Fault::Cartesian { motion, key, fault: Box::new(fault) }
}
