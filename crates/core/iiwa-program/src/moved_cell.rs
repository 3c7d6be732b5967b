//! Programs for a robot at another place in its cell.

use iiwa_kin::Pose;

use crate::{
    cartesian_motion::{CartesianMotion, Course, SegmentCourse},
    program::{Motion, Program, Start},
    target::{Frame, Target, TargetRef},
    workcell::{ROBOT, Workcell},
};

impl Program {
    /// Returns the program for a robot at another place in its cell. `cell` is the pose of the
    /// former robot base in the new one.
    ///
    /// Bases and frames keep their places in the cell. Joint positions stay as they are: the TCP is
    /// elsewhere in the cell there, and so is what follows relative to it. The signs of the joints
    /// (`turn`) at targets are left out, since they hold for the former place.
    ///
    /// ```
    /// use iiwa_kin::Pose;
    /// use iiwa_program::Program;
    ///
    /// let program = Program::from_json(
    ///     r#"{ "version": 1, "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
    ///         "bases": { "table": { "x_mm": 500 } },
    ///         "motions": [{ "type": "wait", "seconds": 1 }] }"#,
    /// )?;
    /// // The robot moves by 100 mm towards the table.
    /// let moved = program.with_cell_at(&Pose::from_xyz_abc([-0.1, 0.0, 0.0], [0.0; 3]));
    /// assert!((moved.workcell.bases["table"].frame.xyz_mm[0] - 400.0).abs() < 1e-9);
    /// # Ok::<(), iiwa_program::ProgramError>(())
    /// ```
    #[must_use]
    pub fn with_cell_at(&self, cell: &Pose) -> Self {
        let moving = MovedCell { cell, workcell: &self.workcell };
        let mut moved = self.clone();
        for base in moved.workcell.bases.values_mut() {
            if base.base.as_deref().is_none_or(|name| name == ROBOT) {
                moving.move_frame(&mut base.frame);
            }
        }
        for target in moved.workcell.frames.values_mut() {
            moving.move_target(target, None);
        }
        if let Start::Frame(start) = &mut moved.start {
            moving.move_reference(start, None);
        }
        for motion in &mut moved.motions {
            if let Motion::Cartesian(motion) = motion {
                moving.move_motion(motion);
            }
        }
        moved
    }

    /// Number of targets that are joint positions, including the start; those of a block count in
    /// each round.
    #[must_use]
    pub fn joint_targets(&self) -> usize {
        let motions = self.motions.iter().filter(|motion| matches!(motion, Motion::Ptp(_)));
        motions.count() + usize::from(self.start.joints_rad().is_some())
    }
}

/// Pose of the former robot base, and the names of the program before it moved.
struct MovedCell<'a> {
    cell: &'a Pose,
    workcell: &'a Workcell,
}

impl MovedCell<'_> {
    /// Moves a frame that is given in the robot base.
    fn move_frame(&self, frame: &mut Frame) {
        *frame = Frame::from(&self.cell.then(&frame.pose()));
    }

    /// Moves a target that is given in the robot base; `base` is the base of its motion. A target
    /// in another base moves with that base.
    fn move_target(&self, target: &mut Target, base: Option<&str>) {
        target.turn = None;
        let base = target.base.as_deref().or(base).or(self.workcell.base.as_deref());
        if base.is_none_or(|name| name == ROBOT) {
            self.move_frame(&mut target.frame);
        }
    }

    fn move_reference(&self, target: &mut TargetRef, base: Option<&str>) {
        if let TargetRef::Given(target) = target {
            self.move_target(target, base);
        }
    }

    fn move_motion(&self, motion: &mut CartesianMotion) {
        let base = motion.base.as_deref();
        match &mut motion.course {
            Course::Ptp { to } | Course::Lin { to } => self.move_reference(to, base),
            Course::LinRel { within: Some(within), .. } => match within {
                TargetRef::Named(name)
                    if name == ROBOT && !self.workcell.frames.contains_key(name) =>
                {
                    let cell = Target::at(Frame::from(self.cell));
                    let base = Some(ROBOT.to_owned());
                    *within = TargetRef::Given(Target { base, ..cell });
                }
                within => self.move_reference(within, base),
            },
            Course::LinRel { within: None, .. } => {}
            Course::Circ(circ) => {
                self.move_reference(&mut circ.aux, base);
                self.move_reference(&mut circ.to, base);
            }
            Course::Spline(segments) => {
                for segment in segments {
                    match &mut segment.course {
                        SegmentCourse::Spl { to } | SegmentCourse::Lin { to } => {
                            self.move_reference(to, base);
                        }
                        SegmentCourse::Circ(circ) => {
                            self.move_reference(&mut circ.aux, base);
                            self.move_reference(&mut circ.to, base);
                        }
                    }
                }
            }
        }
    }
}
