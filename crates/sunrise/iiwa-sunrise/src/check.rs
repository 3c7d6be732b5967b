//! Checks that a robot reaches frames as they were taught.

use std::fmt;

use iiwa_kin::{Joints, OutsideRange, Robot, Status, Turn, Unreachable};

use crate::cell::{ImportedCell, ImportedFrame};

/// Result of a reachability check of a taught frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameCheck {
    /// Joint positions from inverse kinematics in rad; `None` without a solution.
    pub joints_rad: Option<Joints>,
    /// Verdict.
    pub verdict: Verdict,
}

/// Verdict of a check.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Verdict {
    /// All joints are within their limits, and status and turn are as taught.
    Agrees,
    /// The frame was taught without E1, status or TCP: the check does not apply.
    NotTaught,
    /// Inverse kinematics has no solution.
    Unreachable(Unreachable),
    /// The solution is outside the joint limits.
    Outside(OutsideRange),
    /// The solution has another status.
    OtherStatus {
        /// Taught status.
        stated: Status,
        /// Status of the solution.
        reached: Status,
    },
    /// The solution has another turn.
    OtherTurn {
        /// Taught turn.
        stated: Turn,
        /// Turn of the solution.
        reached: Turn,
    },
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Agrees => f.write_str("agrees"),
            Self::NotTaught => f.write_str("not taught"),
            Self::Unreachable(reason) => reason.fmt(f),
            Self::Outside(outside) => outside.fmt(f),
            Self::OtherStatus { stated, reached } => {
                write!(f, "taught with status {stated}, the joints have {reached}")
            }
            Self::OtherTurn { stated, reached } => {
                write!(f, "taught with turn {stated}, the joints have {reached}")
            }
        }
    }
}

impl ImportedCell {
    /// Returns the number of frames that were taught with E1, status and a TCP, and the number of
    /// these that `robot` reaches as taught.
    #[must_use]
    pub fn taught_and_agreeing(&self, robot: &Robot) -> [usize; 2] {
        let verdicts = self.frames.iter().map(|frame| frame.check(robot).verdict);
        let taught: Vec<_> = verdicts.filter(|verdict| *verdict != Verdict::NotTaught).collect();
        let agreeing = taught.iter().filter(|verdict| **verdict == Verdict::Agrees).count();
        [taught.len(), agreeing]
    }
}

impl ImportedFrame {
    /// Checks that `robot` reaches the frame with the taught TCP, E1 and status. The TCP is the one
    /// at the time of teaching, even if the tool has been changed since.
    #[must_use]
    pub fn check(&self, robot: &Robot) -> FrameCheck {
        let (Some(teaching), Some(e1_rad), Some(status)) =
            (&self.teaching, self.e1_rad, self.status)
        else {
            return FrameCheck { joints_rad: None, verdict: Verdict::NotTaught };
        };
        let flange = self.pose.then(&teaching.tcp.pose().inverse());
        let joints_rad = match robot.inverse(&flange, e1_rad, status) {
            Ok(joints_rad) => joints_rad,
            Err(reason) => {
                return FrameCheck { joints_rad: None, verdict: Verdict::Unreachable(reason) };
            }
        };
        let reached = Status::of(robot, &joints_rad);
        let verdict = if let Err(outside) = robot.limits().check(&joints_rad) {
            Verdict::Outside(outside)
        } else if reached != status {
            Verdict::OtherStatus { stated: status, reached }
        } else {
            match self.turn.filter(|turn| !turn.agrees_with(&joints_rad)) {
                Some(stated) => Verdict::OtherTurn { stated, reached: Turn::of(&joints_rad) },
                None => Verdict::Agrees,
            }
        };
        FrameCheck { joints_rad: Some(joints_rad), verdict }
    }
}
