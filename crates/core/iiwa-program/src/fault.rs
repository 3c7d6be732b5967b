//! Faults of programs.

use iiwa_json::{JsonPlace, JsonStep, locate};
use iiwa_kin::{Joint, OutsideRange};

use crate::{
    blend::Blend,
    cartesian_fault::CartesianFault,
    limit_kind::{LimitKind, percent},
    motion_index::MotionIndex,
    workcell::{MAX_FLANGE_M, MAX_TORQUE_LIMIT, MIN_OVERRIDE, MIN_TORQUE_LIMIT},
};

/// Fault: a motion program cannot be planned.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// The motion list is empty.
    #[error("the program has no motions; add at least one")]
    NoMotions,
    /// A joint is outside its range, or not a number.
    #[error("{}: {outside}", place_name(*.motion))]
    JointOutside {
        /// Motion index; `None` for the start pose.
        motion: Option<MotionIndex>,
        /// Joint found outside, and its range.
        outside: OutsideRange,
    },
    /// A relative speed, acceleration or jerk is not in (0, 1], or below its minimum.
    #[error(
        "motion {motion}: {}{} is {found}; it must be {} and at most 1{}",
        .kind.share_key(),
        .joint.map(|joint| format!(" of joint {joint}")).unwrap_or_default(),
        if *.found > 0.0 && *.found < *.min {
            format!("at least {min}")
        } else {
            "above 0".to_owned()
        },
        percent(*.found)
    )]
    Share {
        /// Motion index.
        motion: MotionIndex,
        /// Limit kind.
        kind: LimitKind,
        /// Joint; `None` if the share is the same for all joints.
        joint: Option<Joint>,
        /// Value found.
        found: f64,
        /// Smallest accepted value.
        min: f64,
    },
    /// A wait is negative, longer than a day, or not a number.
    #[error("motion {motion}: a wait of {found} s; it must be from 0 to {max_s} s")]
    Wait {
        /// Motion index.
        motion: MotionIndex,
        /// Duration found, in s.
        found: f64,
        /// Largest accepted duration, in s.
        max_s: f64,
    },
    /// A wait overlaps too many motions.
    #[error("motion {motion}: a wait that overlaps {found} motions; it may overlap at most {max}")]
    Overlap {
        /// Motion index of the wait.
        motion: MotionIndex,
        /// Number of motions to overlap.
        found: usize,
        /// Largest accepted number.
        max: usize,
    },
    /// A wait overlaps more motions than precede it since the last stop.
    #[error(
        "motion {motion}: the wait is to overlap {}, and {} before it; a plain wait or a change of \
         the load before it stops the arm", motions(*.found), there_are(*.before)
    )]
    NothingToOverlap {
        /// Motion index of the wait.
        motion: MotionIndex,
        /// Number of motions to overlap.
        found: usize,
        /// Number of motions available.
        before: usize,
    },
    /// A blend's size is out of range.
    #[error("motion {motion}: {}", blend_range(*.blend))]
    Blend {
        /// Motion index.
        motion: MotionIndex,
        /// Blend found.
        blend: Blend,
    },
    /// A motion before a wait has a blend.
    #[error(
        "motion {motion} is followed by a wait and has nothing to blend into; remove its blend"
    )]
    BlendBeforeWait {
        /// Motion index.
        motion: MotionIndex,
    },
    /// A motion before a payload change has a blend.
    #[error(
        "motion {motion} is followed by a change of the load, for which the arm stops; remove its \
         blend"
    )]
    BlendBeforeLoad {
        /// Motion index.
        motion: MotionIndex,
    },
    /// The inertia of a payload is not physically possible.
    #[error(
        "motion {motion}: the load is that of no body; mass and moments of inertia must be 0 or \
         more"
    )]
    Load {
        /// Motion index.
        motion: MotionIndex,
    },
    /// A torque limit is out of range or not a number.
    #[error(
        "a limit of {} % of the robot's torques; it must be from {} to {} %",
        1e2 * .found, 1e2 * MIN_TORQUE_LIMIT, 1e2 * MAX_TORQUE_LIMIT
    )]
    TorqueLimit {
        /// Value found, as a share of the robot's limits.
        found: f64,
    },
    /// The override is out of range.
    #[error("an override of {} %; it must be from {} to 100 %", 1e2 * .found, 1e2 * MIN_OVERRIDE)]
    Override {
        /// Value found, as a share.
        found: f64,
    },
    /// The flange length is out of range.
    #[error(
        "a flange of {} mm; it must be above 0 and at most {} mm",
        1e3 * .found_m,
        1e3 * MAX_FLANGE_M
    )]
    Flange {
        /// Length found, in m.
        found_m: f64,
    },
    /// The program names a robot other than the given one.
    #[error("the program is for the robot `{named}`; `{given}` was given")]
    OtherRobot {
        /// Robot named in the program.
        named: String,
        /// Robot given.
        given: String,
    },
    /// The program states a flange length other than that of the given robot.
    #[error(
        "the program is for a flange of {} mm; a robot with one of {} mm was given",
        1e3 * .stated_m,
        1e3 * .given_m
    )]
    OtherFlange {
        /// Length stated in the program, in m.
        stated_m: f64,
        /// Flange length of the robot, in m.
        given_m: f64,
    },
    /// A blocking motion, whose end the program waits for, has a blend.
    #[error("motion {motion} is blocking and cannot be blended: remove its blend, or `blocking`")]
    BlockingBlend {
        /// Motion index.
        motion: MotionIndex,
    },
    /// A motion to a frame, or a start at a frame, cannot be planned.
    #[error("{}: {fault}", place_name(*.motion))]
    Cartesian {
        /// Motion index; `None` for the start pose.
        motion: Option<MotionIndex>,
        /// Key of the motion at which the fault is.
        key: &'static str,
        /// Fault of the motion.
        fault: Box<CartesianFault>,
    },
    /// A blend carries the path outside the joint ranges.
    #[error("motion {motion}: on its blend, {outside}; choose a smaller blend or move the target")]
    BlendOutside {
        /// Motion that has the blend.
        motion: MotionIndex,
        /// Joint farthest outside, and its range.
        outside: OutsideRange,
    },
}

impl Fault {
    /// Returns true if the motions are well formed but infeasible for the robot: joints out of
    /// range, frames out of reach, singular poses. All other faults are in the text of the program.
    #[must_use]
    pub fn is_of_the_arm(&self) -> bool {
        match self {
            Self::JointOutside { .. } | Self::BlendOutside { .. } => true,
            Self::Cartesian { fault, .. } => fault.is_of_the_arm(),
            Self::NoMotions
            | Self::Share { .. }
            | Self::Wait { .. }
            | Self::Overlap { .. }
            | Self::NothingToOverlap { .. }
            | Self::Blend { .. }
            | Self::BlendBeforeWait { .. }
            | Self::BlendBeforeLoad { .. }
            | Self::Load { .. }
            | Self::TorqueLimit { .. }
            | Self::Override { .. }
            | Self::Flange { .. }
            | Self::OtherRobot { .. }
            | Self::OtherFlange { .. }
            | Self::BlockingBlend { .. } => false,
        }
    }

    /// Motion at fault, if any.
    #[must_use]
    pub fn motion(&self) -> Option<MotionIndex> {
        match self {
            Self::NoMotions
            | Self::TorqueLimit { .. }
            | Self::Override { .. }
            | Self::Flange { .. }
            | Self::OtherRobot { .. }
            | Self::OtherFlange { .. } => None,
            Self::JointOutside { motion, .. } | Self::Cartesian { motion, .. } => *motion,
            Self::Share { motion, .. }
            | Self::Wait { motion, .. }
            | Self::Overlap { motion, .. }
            | Self::NothingToOverlap { motion, .. }
            | Self::Blend { motion, .. }
            | Self::BlendBeforeWait { motion }
            | Self::BlendBeforeLoad { motion }
            | Self::Load { motion }
            | Self::BlockingBlend { motion }
            | Self::BlendOutside { motion, .. } => Some(*motion),
        }
    }

    /// Place of the fault in the program's JSON text.
    #[must_use]
    pub fn place_in(&self, text: &str) -> JsonPlace {
        use JsonStep::{Index, Key};
        let motions = Key("motions");
        match self {
            Self::NoMotions => locate(text, &[motions]),
            Self::TorqueLimit { .. } => locate(text, &[Key("limit_torque_percent")]),
            Self::Override { .. } => locate(text, &[Key("override_percent")]),
            Self::OtherRobot { .. } => locate(text, &[Key("robot")]),
            Self::Flange { .. } | Self::OtherFlange { .. } => locate(text, &[Key("flange_mm")]),
            Self::Cartesian { motion, key, fault } => {
                let mut path = match motion {
                    Some(motion) => vec![motions, Index(motion.index()), Key(key)],
                    None => vec![Key("start"), Key(key)],
                };
                if let CartesianFault::Segment { index, key, .. } = fault.as_ref() {
                    path.extend([Index(*index), Key(key)]);
                }
                locate(text, &path)
            }
            Self::JointOutside { motion, outside } => {
                let owner = match motion {
                    None => vec![Key("start")],
                    Some(motion) => vec![motions, Index(motion.index())],
                };
                // The joints are under one of two keys: the deeper match is the right one.
                ["joints_rad", "joints_deg"]
                    .map(|key| {
                        [owner.as_slice(), &[Key(key), Index(outside.joint.index())]].concat()
                    })
                    .map(|path| locate(text, &path))
                    .into_iter()
                    .min_by_key(|place| place.span.len())
                    .unwrap_or_else(|| locate(text, &owner))
            }
            Self::Share { motion, kind, joint, .. } => {
                let mut path = vec![motions, Index(motion.index()), Key(kind.share_key())];
                path.extend(joint.map(|joint| Index(joint.index())));
                locate(text, &path)
            }
            Self::Wait { motion, .. } => {
                locate(text, &[motions, Index(motion.index()), Key("seconds")])
            }
            Self::Overlap { motion, .. } | Self::NothingToOverlap { motion, .. } => {
                let owner = [motions, Index(motion.index())];
                // The number is under one of two keys: the deeper match is the right one.
                ["overlap", "overlap_motions"]
                    .map(|key| locate(text, &[owner.as_slice(), &[Key(key)]].concat()))
                    .into_iter()
                    .min_by_key(|place| place.span.len())
                    .unwrap_or_else(|| locate(text, &owner))
            }
            Self::Load { motion } => locate(text, &[motions, Index(motion.index()), Key("load")]),
            Self::Blend { motion, .. }
            | Self::BlockingBlend { motion }
            | Self::BlendBeforeWait { motion }
            | Self::BlendBeforeLoad { motion }
            | Self::BlendOutside { motion, .. } => {
                locate(text, &[motions, Index(motion.index()), Key("blend")])
            }
        }
    }
}

fn place_name(motion: Option<MotionIndex>) -> String {
    motion.map_or_else(|| "the start pose".to_owned(), |motion| format!("motion {motion}"))
}

fn motions(count: usize) -> String {
    if count == 1 { "a motion".to_owned() } else { format!("{count} motions") }
}

fn there_are(count: usize) -> String {
    match count {
        0 => "there is none".to_owned(),
        1 => "there is one".to_owned(),
        _ => format!("there are {count}"),
    }
}

fn blend_range(blend: Blend) -> String {
    match blend {
        Blend::Fraction(b) => format!("the blend's fraction is {b}; it must be from 0 to 0.5"),
        Blend::SunriseRel(x) => format!("the blend's sunrise_rel is {x}; it must be from 0 to 1"),
        Blend::CartMm(r) => format!("the blend's cart_mm is {r}; it must be 0 or more"),
    }
}
