//! Motions as a program creates them, before they are sent.

use std::{cell::RefCell, rc::Rc};

use iiwa_java::Unknown;
use iiwa_kin::Joints;
use iiwa_program::{AuxOrientation, ByKind, Frame, OrientationType, ToolLimits};

use crate::application::{frame_value::FrameValue, spot::Spot};

/// Motion that a program has created. Its setters change it, as in Java.
#[derive(Clone, Debug)]
pub(crate) struct MotionValue {
    pub(crate) way: MotionPath,
    pub(crate) settings: MotionSettings,
    /// Reason why the motion cannot be planned when it is sent, if any.
    pub(crate) obstacle: Option<PlanningObstacle>,
}

/// Reason why a motion cannot be planned.
#[derive(Clone, Debug)]
pub(crate) enum PlanningObstacle {
    /// Name of an unknown property, such as "the joint velocity of this motion", with its unknown
    /// value.
    Unknown(String, Rc<Unknown>),
    /// Message with the motion, and the reason why it cannot be planned.
    Refused(String),
}

/// Path type and target of a motion.
#[derive(Clone, Debug)]
pub(crate) enum MotionPath {
    Joints(Joints),
    Home,
    Ptp(TargetFrame),
    Lin(TargetFrame),
    LinRel {
        offset: Frame,
        within: Option<TargetFrame>,
    },
    Circ {
        aux: TargetFrame,
        to: TargetFrame,
    },
    Spl(TargetFrame),
    Spline(Vec<Rc<RefCell<MotionValue>>>),
    Batch(Vec<Rc<RefCell<MotionValue>>>),
    Hold(HoldTime),
    /// Motion that cannot be planned.
    Refused,
}

/// Duration of a hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum HoldTime {
    Seconds(f64),
    /// Hold until the operator or the program ends it.
    UntilEnded,
}

/// Target frame, evaluated when the motion is sent.
#[derive(Clone, Debug)]
pub(crate) enum TargetFrame {
    Spot(Spot),
    Frame(Rc<RefCell<FrameValue>>),
}

/// Values that the setters of a motion have set.
#[derive(Clone, Debug, Default)]
pub(crate) struct MotionSettings {
    pub(crate) shares: ByKind<Option<Joints>>,
    pub(crate) tool: ToolLimits,
    pub(crate) blending: Blending,
    pub(crate) orientation: Option<OrientationType>,
    pub(crate) turns_with_path: Option<bool>,
    pub(crate) aux_orientation: Option<AuxOrientation>,
    pub(crate) circ_angle_rad: Option<f64>,
    /// `true` if a condition may end the motion.
    pub(crate) has_break: bool,
}

/// Blend sizes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Blending {
    pub(crate) cart_mm: Option<f64>,
    pub(crate) rel: Option<f64>,
    pub(crate) orientation_rad: Option<f64>,
}

impl MotionPath {
    /// Returns the nesting depth of batches, and the total number of motions.
    pub(crate) fn extent(&self) -> (usize, usize) {
        match self {
            Self::Batch(motions) | Self::Spline(motions) => {
                let extents = motions.iter().map(|motion| motion.borrow().way.extent());
                extents.fold((1, 0), |(depth, count), (inner, motions)| {
                    (depth.max(inner + 1), count + motions)
                })
            }
            _ => (0, 1),
        }
    }
}

impl MotionValue {
    pub(crate) fn new(way: MotionPath) -> Self {
        Self { way, settings: MotionSettings::default(), obstacle: None }
    }

    /// Creates a motion that cannot be planned, with the reason.
    pub(crate) fn refused(reason: impl Into<String>) -> Self {
        let obstacle = Some(PlanningObstacle::Refused(reason.into()));
        Self { way: MotionPath::Refused, settings: MotionSettings::default(), obstacle }
    }

    /// Records the reason why the motion cannot be planned; the first reason is kept.
    pub(crate) fn obstruct(&mut self, obstacle: PlanningObstacle) {
        self.obstacle.get_or_insert(obstacle);
    }
}

impl MotionSettings {
    /// Fills unset values from a batch or a robot.
    pub(crate) fn or(&self, defaults: &Self) -> Self {
        let or = |by_kind: &ByKind<f64>, other: &ByKind<f64>| {
            ByKind::from_fn(
                |kind| if by_kind[kind].is_finite() { by_kind[kind] } else { other[kind] },
            )
        };
        let is_blended = self.blending != Blending::default();
        Self {
            shares: ByKind::from_fn(|kind| self.shares[kind].or(defaults.shares[kind])),
            tool: ToolLimits {
                way: or(&self.tool.way, &defaults.tool.way),
                turn: or(&self.tool.turn, &defaults.tool.turn),
            },
            blending: if is_blended { self.blending } else { defaults.blending },
            orientation: self.orientation.or(defaults.orientation),
            turns_with_path: self.turns_with_path.or(defaults.turns_with_path),
            aux_orientation: self.aux_orientation.or(defaults.aux_orientation),
            circ_angle_rad: self.circ_angle_rad,
            has_break: self.has_break || defaults.has_break,
        }
    }
}
