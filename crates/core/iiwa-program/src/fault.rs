//! Faults of programs.

use iiwa_json::{JsonPlace, JsonStep, locate};
use iiwa_kin::{ImpossibleLoad, Joint, OutsideRange};

use crate::{
    blend::Blend,
    cartesian_fault::CartesianFault,
    flange_load::ShapeFault,
    limit_kind::{LimitKind, percent},
    motion_index::MotionIndex,
    motion_path::motion_path,
    name_place::name_place,
    task::TaskFault,
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
    #[error("motion {motion} overlaps {found} motions; it may overlap at most {max}")]
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
        "motion {motion} overlaps {}, but {} it without a stop in between; payload changes, and \
         waits, inputs and outputs without `overlap` stop the robot",
        motions(*.found), preceding(*.before)
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
    /// A motion before an input or output at rest has a blend.
    #[error(
        "motion {motion} is followed by `{}`, for which the arm stops; remove its blend, or give \
         `{}` the key \"overlap\": true to keep the arm moving", .next, .next
    )]
    BlendBeforeIo {
        /// Motion index.
        motion: MotionIndex,
        /// Type of the next entry in programs: `set` or `wait_for`.
        next: &'static str,
    },
    /// The name or the value of an input or output is unsuitable.
    #[error("motion {motion}: {message}")]
    Io {
        /// Motion index.
        motion: MotionIndex,
        /// Key at which the fault is: `io` or `value`.
        key: &'static str,
        /// Reason, and remedy.
        message: String,
    },
    /// The mass, the centre or the inertia of a payload is out of range.
    #[error("motion {motion}: {}", ImpossibleLoad)]
    Load {
        /// Motion index.
        motion: MotionIndex,
    },
    /// A shape of a payload is out of range.
    #[error("motion {motion}: {fault}")]
    Shape {
        /// Motion index.
        motion: MotionIndex,
        /// Fault of the shape.
        fault: Box<ShapeFault>,
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
    /// The tasks of the program cannot be executed in another order.
    #[error(transparent)]
    Task(TaskFault),
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
            | Self::BlendBeforeIo { .. }
            | Self::Io { .. }
            | Self::Load { .. }
            | Self::Shape { .. }
            | Self::TorqueLimit { .. }
            | Self::Override { .. }
            | Self::Flange { .. }
            | Self::Task(_)
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
            Self::Task(fault) => fault.motion(),
            Self::Share { motion, .. }
            | Self::Wait { motion, .. }
            | Self::Overlap { motion, .. }
            | Self::NothingToOverlap { motion, .. }
            | Self::Blend { motion, .. }
            | Self::BlendBeforeWait { motion }
            | Self::BlendBeforeLoad { motion }
            | Self::BlendBeforeIo { motion, .. }
            | Self::Io { motion, .. }
            | Self::Load { motion }
            | Self::Shape { motion, .. }
            | Self::BlockingBlend { motion }
            | Self::BlendOutside { motion, .. } => Some(*motion),
        }
    }

    /// Place of the fault in the program's JSON text.
    #[must_use]
    pub fn place_in(&self, text: &str) -> JsonPlace {
        let motion = self.motion().map(|motion| motion_path(text, motion));
        self.place_at(text, &motion.unwrap_or_default())
    }

    /// Place of the fault in the program's JSON text; `owner` is the path to the motion at fault,
    /// empty without one.
    pub(crate) fn place_at(&self, text: &str, owner: &[JsonStep<'_>]) -> JsonPlace {
        use JsonStep::{Index, Key};
        let in_motion = |key| locate(text, &[owner, &[Key(key)]].concat());
        match self {
            Self::NoMotions => locate(text, &[Key("motions")]),
            Self::TorqueLimit { .. } => locate(text, &[Key("limit_torque_percent")]),
            Self::Override { .. } => locate(text, &[Key("override_percent")]),
            Self::Task(fault) => match fault.motion() {
                Some(_) => locate(text, owner),
                None => fault.place_in(text),
            },
            Self::OtherRobot { .. } => locate(text, &[Key("robot")]),
            Self::Flange { .. } | Self::OtherFlange { .. } => locate(text, &[Key("flange_mm")]),
            Self::Cartesian { motion, key, fault } => {
                let mut path = match motion {
                    Some(_) => [owner, &[Key(key)]].concat(),
                    None => vec![Key("start"), Key(key)],
                };
                let mut fault = fault.as_ref();
                if let CartesianFault::Segment { index, key, fault: of_segment } = fault {
                    path.extend([Index(*index), Key(key)]);
                    fault = of_segment;
                }
                match fault {
                    CartesianFault::Name(fault) => name_place(text, &path, fault),
                    _ => locate(text, &path),
                }
            }
            Self::JointOutside { motion, outside } => {
                let owner = if motion.is_none() { &[Key("start")] } else { owner };
                // The joints are under one of two keys: the deeper match is the right one.
                ["joints_rad", "joints_deg"]
                    .map(|key| [owner, &[Key(key), Index(outside.joint.index())]].concat())
                    .map(|path| locate(text, &path))
                    .into_iter()
                    .min_by_key(|place| place.span.len())
                    .unwrap_or_else(|| locate(text, owner))
            }
            Self::Share { kind, joint, .. } => {
                let mut path = [owner, &[Key(kind.share_key())]].concat();
                path.extend(joint.map(|joint| Index(joint.index())));
                locate(text, &path)
            }
            Self::Wait { .. } => in_motion("seconds"),
            Self::Overlap { .. } | Self::NothingToOverlap { .. } => {
                // The number is under one of two keys: the deeper match is the right one.
                ["overlap", "overlap_motions"]
                    .map(in_motion)
                    .into_iter()
                    .min_by_key(|place| place.span.len())
                    .unwrap_or_else(|| locate(text, owner))
            }
            Self::Load { .. } => in_motion("load"),
            Self::Shape { fault, .. } => {
                let mut path = [owner, &[Key("load"), Key("shapes")]].concat();
                path.extend(fault.shape.into_iter().flat_map(|it| [Index(it), Key(fault.key)]));
                locate(text, &path)
            }
            Self::Io { key, .. } => in_motion(key),
            Self::Blend { .. }
            | Self::BlockingBlend { .. }
            | Self::BlendBeforeWait { .. }
            | Self::BlendBeforeLoad { .. }
            | Self::BlendBeforeIo { .. }
            | Self::BlendOutside { .. } => in_motion("blend"),
        }
    }
}

fn place_name(motion: Option<MotionIndex>) -> String {
    motion.map_or_else(|| "the start pose".to_owned(), |motion| format!("motion {motion}"))
}

fn motions(count: usize) -> String {
    if count == 1 { "a motion".to_owned() } else { format!("{count} motions") }
}

fn preceding(count: usize) -> String {
    match count {
        0 => "no motion precedes".to_owned(),
        1 => "only one motion precedes".to_owned(),
        _ => format!("only {count} motions precede"),
    }
}

fn blend_range(blend: Blend) -> String {
    match blend {
        Blend::Fraction(b) => format!("the blend's fraction is {b}; it must be from 0 to 0.5"),
        Blend::SunriseRel(x) => format!("the blend's sunrise_rel is {x}; it must be from 0 to 1"),
        Blend::CartMm(r) => format!("the blend's cart_mm is {r}; it must be 0 or more"),
    }
}
