//! Whether a robot reaches frames as they were taught.

use std::fmt;

use iiwa_kin::{Joints, OutsideRange, Robot, Status, Turn, Unreachable};

use crate::cell::{ImportedCell, ImportedFrame};

/// Whether a robot reaches a frame as it was taught.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameCheck {
    /// The joints that inverse kinematics gives, in rad; none if it gives none.
    pub joints_rad: Option<Joints>,
    /// What is to be said of them.
    pub verdict: Verdict,
}

/// What a check says.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Verdict {
    /// All joints are within their limits, and status and turn are those that were taught.
    Agrees,
    /// The frame was not taught with E1, status and a TCP: there is nothing to check.
    NotTaught,
    /// No joints reach it.
    Unreachable(Unreachable),
    /// The joints that reach it are outside their limits.
    Outside(OutsideRange),
    /// The joints have another status.
    OtherStatus {
        /// As it was taught.
        stated: Status,
        /// That of the joints.
        found: Status,
    },
    /// The joints have another turn.
    OtherTurn {
        /// As it was taught.
        stated: Turn,
        /// That of the joints.
        found: Turn,
    },
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Agrees => f.write_str("agrees"),
            Self::NotTaught => f.write_str("not taught"),
            Self::Unreachable(reason) => reason.fmt(f),
            Self::Outside(outside) => outside.fmt(f),
            Self::OtherStatus { stated, found } => {
                write!(f, "taught with status {stated}, the joints have {found}")
            }
            Self::OtherTurn { stated, found } => {
                write!(f, "taught with turn {stated}, the joints have {found}")
            }
        }
    }
}

impl ImportedCell {
    /// The number of frames that were taught with E1, status and a TCP, and how many of them `robot` reaches as they were.
    #[must_use]
    pub fn taught_and_agreeing(&self, robot: &Robot) -> [usize; 2] {
        let verdicts = self.frames.iter().map(|frame| frame.check(robot).verdict);
        let taught: Vec<_> = verdicts.filter(|own| *own != Verdict::NotTaught).collect();
        let agreeing = taught.iter().filter(|own| **own == Verdict::Agrees).count();
        [taught.len(), agreeing]
    }
}

impl ImportedFrame {
    /// Whether `robot` reaches the frame with the TCP, E1 and status that it was taught with. The TCP is the one of that
    /// time, whatever has become of the tool since.
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
        let found = Status::of(robot, &joints_rad);
        let verdict = if let Err(outside) = robot.limits().check(&joints_rad) {
            Verdict::Outside(outside)
        } else if found != status {
            Verdict::OtherStatus { stated: status, found }
        } else {
            match self.turn.filter(|turn| !turn.agrees_with(&joints_rad)) {
                Some(stated) => Verdict::OtherTurn { stated, found: Turn::of(&joints_rad) },
                None => Verdict::Agrees,
            }
        };
        FrameCheck { joints_rad: Some(joints_rad), verdict }
    }
}
