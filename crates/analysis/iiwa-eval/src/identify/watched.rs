//! Recording with its program and planned path.

use std::sync::Arc;

use iiwa_kin::{Joints, Pose, Robot};
use iiwa_log::JointLog;
use iiwa_path::{JointPath, PathOptions, Segment, Step};
use iiwa_program::{Course, Fault, Motion, MotionIndex, OrientationType, Program};

use crate::noise::RecordingNoise;

/// Recording with its program and planned path.
pub(super) struct Watched<'a> {
    /// Index of the recording, from 0.
    pub(super) recording: usize,
    pub(super) program: &'a Program,
    pub(super) log: &'a JointLog,
    pub(super) path: JointPath,
    /// Override of the recording, as a share.
    pub(super) override_share: f64,
    pub(super) noise: RecordingNoise,
    /// Segments of each motion without blends.
    motions: Vec<Vec<Arc<dyn Segment>>>,
}

/// Space in which a corner is rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CornerSpace {
    /// Both motions are straight in joint space.
    Joints,
    /// Both motions are straight paths of the same TCP.
    StraightWays,
    /// Both motions are paths of the same TCP, at least one of them curved.
    Ways,
    /// Only one motion is a TCP path, or the TCPs differ: rounded in joint space, as far as known.
    Mixed,
}

impl<'a> Watched<'a> {
    pub(super) fn new(
        recording: usize,
        program: &'a Program,
        log: &'a JointLog,
        model: &Robot,
    ) -> Result<Self, Fault> {
        let override_share = program.workcell.speed_override.unwrap_or(1.0);
        let mut at_full = program.clone();
        at_full.workcell.speed_override = None;
        // The recorded robot may differ from the one that the program names.
        let path_of =
            |program: &Program| JointPath::on_other_robot(program, model, PathOptions::default());
        let path = path_of(&at_full)?;
        let mut motions = vec![Vec::new(); program.motions.len()];
        for step in path_of(&without_blends(program))?.steps() {
            if let Step::Move { motion, segment, .. } = step {
                motions[motion.index()].push(Arc::clone(segment));
            }
        }
        let noise = RecordingNoise::of(log);
        Ok(Self { recording, program, log, path, override_share, noise, motions })
    }

    /// Returns true if a motion is a TCP path.
    pub(super) fn is_course(&self, motion: MotionIndex) -> bool {
        self.course(motion).is_some()
    }

    fn course(&self, motion: MotionIndex) -> Option<&Course> {
        match self.program.motions.get(motion.index()) {
            Some(Motion::Cartesian(cartesian)) if !cartesian.is_ptp() => Some(&cartesian.course),
            _ => None,
        }
    }

    /// Returns the space in which the corner at the end of a motion is rounded.
    pub(super) fn corner_space(&self, motion: MotionIndex) -> CornerSpace {
        let next = motion.next();
        let by_wrist = |motion: MotionIndex| {
            let entry = &self.program.motions[motion.index()];
            matches!(
                entry,
                Motion::Cartesian(cartesian) if cartesian.orientation == OrientationType::Joints
            )
        };
        let is_straight =
            |course: &Course| matches!(course, Course::Lin { .. } | Course::LinRel { .. });
        match (self.course(motion), self.course(next)) {
            (None, None) => CornerSpace::Joints,
            (Some(a), Some(b))
                if self.path.tcp(motion) == self.path.tcp(next)
                    && !by_wrist(motion)
                    && !by_wrist(next) =>
            {
                if is_straight(a) && is_straight(b) {
                    CornerSpace::StraightWays
                } else {
                    CornerSpace::Ways
                }
            }
            _ => CornerSpace::Mixed,
        }
    }

    /// Returns the start and the target of a motion and the target of the next one, between which
    /// the corner is.
    pub(super) fn corner(&self, motion: MotionIndex) -> Option<[Joints; 3]> {
        let into = self.motions.get(motion.index())?;
        let leaving = self.motions.get(motion.next().index())?;
        Some([into.first()?.at(0.0).q, into.last()?.at(1.0).q, leaving.last()?.at(1.0).q])
    }

    /// Returns the TCP pose of a motion at given joint positions.
    pub(super) fn tcp(&self, motion: MotionIndex, joints_rad: &Joints) -> Pose {
        self.path.robot().flange_pose(joints_rad).then(self.path.tcp(motion))
    }
}

fn without_blends(program: &Program) -> Program {
    let mut plain = program.clone();
    for motion in &mut plain.motions {
        match motion {
            Motion::Ptp(ptp) => ptp.blend = None,
            Motion::Cartesian(cartesian) => cartesian.blend = None,
            Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => {}
        }
    }
    plain
}
