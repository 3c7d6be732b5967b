//! Motions as a program makes them, before they are sent.

use std::{cell::RefCell, rc::Rc};

use iiwa_java::Unknown;
use iiwa_kin::Joints;
use iiwa_program::{AuxOrientation, ByKind, Frame, OrientationType, ToolLimits};

use crate::application::{frame_value::FrameValue, spot::Spot};

/// A motion that a program has made. Its setters change it, as in Java.
#[derive(Clone, Debug)]
pub(crate) struct MotionValue {
    pub(crate) way: Way,
    pub(crate) settings: Settings,
    /// Why it cannot be planned when it is sent, if it cannot.
    pub(crate) obstacle: Option<Obstacle>,
}

/// Why a motion cannot be planned.
#[derive(Clone, Debug)]
pub(crate) enum Obstacle {
    /// Something of it, as "the joint velocity of this motion", is not known.
    Unknown(String, Rc<Unknown>),
    /// What it is, and why that cannot be planned.
    Refused(String),
}

/// Where a motion goes, and how.
#[derive(Clone, Debug)]
pub(crate) enum Way {
    Joints(Joints),
    Home,
    Ptp(Goal),
    Lin(Goal),
    LinRel {
        offset: Frame,
        within: Option<Goal>,
    },
    Circ {
        aux: Goal,
        to: Goal,
    },
    Spl(Goal),
    Spline(Vec<Rc<RefCell<MotionValue>>>),
    Batch(Vec<Rc<RefCell<MotionValue>>>),
    Hold(HoldTime),
    /// One that cannot be planned.
    Refused,
}

/// The duration of a hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum HoldTime {
    Seconds(f64),
    /// Until the operator or the program ends it.
    UntilEnded,
}

/// A frame to go to: as it is when the motion is sent.
#[derive(Clone, Debug)]
pub(crate) enum Goal {
    Spot(Spot),
    Frame(Rc<RefCell<FrameValue>>),
}

/// What the setters of a motion have set.
#[derive(Clone, Debug, Default)]
pub(crate) struct Settings {
    pub(crate) shares: ByKind<Option<Joints>>,
    pub(crate) tool: ToolLimits,
    pub(crate) blending: Blending,
    pub(crate) orientation: Option<OrientationType>,
    pub(crate) turns_with_path: Option<bool>,
    pub(crate) aux_orientation: Option<AuxOrientation>,
    pub(crate) circ_angle_rad: Option<f64>,
    /// True if a condition may end the motion.
    pub(crate) has_break: bool,
}

/// The sizes of a blend.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Blending {
    pub(crate) cart_mm: Option<f64>,
    pub(crate) rel: Option<f64>,
    pub(crate) orientation_rad: Option<f64>,
}

impl Way {
    /// How deep batches are within each other, and how many motions they have in all.
    pub(crate) fn extent(&self) -> (usize, usize) {
        match self {
            Self::Batch(motions) | Self::Spline(motions) => {
                let own = motions.iter().map(|motion| motion.borrow().way.extent());
                own.fold((1, 0), |(depth, count), (inner, motions)| {
                    (depth.max(inner + 1), count + motions)
                })
            }
            _ => (0, 1),
        }
    }
}

impl MotionValue {
    pub(crate) fn new(way: Way) -> Self {
        Self { way, settings: Settings::default(), obstacle: None }
    }

    /// One that cannot be planned, for this reason.
    pub(crate) fn refused(reason: impl Into<String>) -> Self {
        let obstacle = Some(Obstacle::Refused(reason.into()));
        Self { way: Way::Refused, settings: Settings::default(), obstacle }
    }

    /// Remembers why it cannot be planned; the first reason counts.
    pub(crate) fn obstruct(&mut self, obstacle: Obstacle) {
        self.obstacle.get_or_insert(obstacle);
    }
}

impl Settings {
    /// These, and those of a batch or a robot where there are none.
    pub(crate) fn or(&self, defaults: &Self) -> Self {
        let or = |own: &ByKind<f64>, other: &ByKind<f64>| {
            ByKind::from_fn(|kind| if own[kind].is_finite() { own[kind] } else { other[kind] })
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
