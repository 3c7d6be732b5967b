//! Changes of a program.

use std::fmt;

use iiwa_program::{
    Course, LimitKind, Motion, MotionIndex, PathBlend, Program, ROBOT, Target, TargetRef, Workcell,
};

/// A change of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Motion that changes; of several motions the first.
    pub motion: MotionIndex,
    /// Kind of the change, with its values.
    pub kind: ChangeKind,
}

/// Kind of a change, with its values.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ChangeKind {
    /// Another E1 (position of A3) at the target of the motion, and at those of the motions to
    /// frames that follow it, up to `last`: the difference is the same for all of them.
    Elbow {
        /// E1 at the target of the first motion, in rad.
        from_rad: f64,
        /// New E1 there, in rad.
        to_rad: f64,
        /// Last motion that changes.
        last: MotionIndex,
    },
    /// A blend of this radius about the target, in place of another blend or of a stop. The program
    /// does not wait for the end of the motion any more.
    Blend {
        /// Blend before; `None` for a stop.
        from: Option<PathBlend>,
        /// Radius, in mm.
        to_mm: f64,
    },
    /// Full speed of a point-to-point motion.
    FullSpeed {
        /// Smallest share of a joint's velocity limit before.
        from_rel: f64,
    },
    /// A motion without a blend whose end the program does not wait for: the standstill is shorter.
    NoWaitForEnd,
    /// A wait whose time runs from the start of the motion before it, for whose end the program
    /// does not wait.
    OverlapWait {
        /// Duration, in s.
        seconds: f64,
        /// `true` if the program waited for the end of the motion before.
        was_blocking: bool,
    },
}

impl Change {
    /// Returns the property of a motion that a change sets: at most one change of each is needed.
    pub(crate) fn property(&self) -> u8 {
        match self.kind {
            ChangeKind::Elbow { .. } => 0,
            ChangeKind::Blend { .. } | ChangeKind::NoWaitForEnd => 1,
            ChangeKind::FullSpeed { .. } => 2,
            ChangeKind::OverlapWait { .. } => 3,
        }
    }

    /// Returns one change in place of this one and a later one of the same property; `None` if
    /// nothing changes.
    pub(crate) fn followed_by(self, later: Self) -> Option<Self> {
        let kind = match (self.kind, later.kind) {
            (ChangeKind::Elbow { from_rad, .. }, ChangeKind::Elbow { to_rad, last, .. }) => {
                if (to_rad - from_rad).abs() < 1e-9 {
                    return None;
                }
                ChangeKind::Elbow { from_rad, to_rad, last }
            }
            (ChangeKind::Blend { from, .. }, ChangeKind::Blend { to_mm, .. }) => {
                if from == Some(PathBlend::cart_mm(to_mm)) {
                    return None;
                }
                ChangeKind::Blend { from, to_mm }
            }
            (_, later) => later,
        };
        Some(Self { motion: self.motion, kind })
    }

    /// First motion that changes.
    pub(crate) fn first(&self) -> MotionIndex {
        match self.kind {
            ChangeKind::OverlapWait { .. } => {
                MotionIndex::new(self.motion.index().saturating_sub(1))
            }
            _ => self.motion,
        }
    }

    /// Last motion that changes.
    #[must_use]
    pub fn last(&self) -> MotionIndex {
        match self.kind {
            ChangeKind::Elbow { last, .. } => last,
            _ => self.motion,
        }
    }

    /// Returns this change for a program that begins with its motion.
    pub(crate) fn at_start(self) -> Self {
        let first = self.motion.index();
        let kind = match self.kind {
            ChangeKind::Elbow { from_rad, to_rad, last } => {
                let last = MotionIndex::new(last.index() - first);
                ChangeKind::Elbow { from_rad, to_rad, last }
            }
            kind => kind,
        };
        Self { motion: MotionIndex::new(0), kind }
    }

    /// Returns the changed program; `None` if the program has no such motion.
    #[must_use]
    pub fn apply(&self, program: &Program) -> Option<Program> {
        let mut changed = program.clone();
        let entry = changed.motions.get_mut(self.motion.index())?;
        match &self.kind {
            ChangeKind::Elbow { from_rad, to_rad, last } => {
                let range = self.motion.index()..=last.index();
                let motions = changed.motions.get_mut(range)?;
                let by_rad = to_rad - from_rad;
                for motion in motions {
                    turn_elbow(motion, &changed.workcell, by_rad);
                }
            }
            ChangeKind::Blend { from, to_mm } => {
                let blend = PathBlend::cart_mm(*to_mm);
                // In Sunrise, the wait would overlap this motion, too.
                let wait = program.motions.get(self.motion.index() + 2);
                if from.is_none() && wait.is_some_and(|wait| wait.overlap() == 1) {
                    return None;
                }
                match entry {
                    Motion::Ptp(ptp) => {
                        ptp.blend = blend.in_joints();
                        ptp.blocking = false;
                    }
                    Motion::Cartesian(cartesian) => {
                        cartesian.blend = Some(blend);
                        cartesian.blocking = false;
                    }
                    Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => return None,
                }
            }
            ChangeKind::FullSpeed { .. } => match entry {
                Motion::Ptp(ptp) => ptp.velocity_rel = [1.0; 7],
                Motion::Cartesian(cartesian) => cartesian.shares[LimitKind::Velocity] = [1.0; 7],
                Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => return None,
            },
            ChangeKind::NoWaitForEnd => continue_after(entry)?,
            ChangeKind::OverlapWait { .. } => {
                let Motion::Wait { overlap, .. } = entry else { return None };
                *overlap = 1;
                // In Sunrise, the wait would overlap the motion before the blend, too.
                if program.blend_into(self.first()).is_some() {
                    return None;
                }
                continue_after(changed.motions.get_mut(self.first().index())?)?;
            }
        }
        Some(changed)
    }
}

/// Lets the program continue before the end of a motion; `None` for other entries.
fn continue_after(entry: &mut Motion) -> Option<()> {
    match entry {
        Motion::Ptp(ptp) => ptp.blocking = false,
        Motion::Cartesian(cartesian) => cartesian.blocking = false,
        Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => return None,
    }
    Some(())
}

/// Adds an angle to the E1 of a motion's target, if the motion states it.
fn turn_elbow(motion: &mut Motion, workcell: &Workcell, by_rad: f64) {
    let Motion::Cartesian(cartesian) = motion else { return };
    match &mut cartesian.course {
        Course::LinRel { e1_rad, .. } => *e1_rad = e1_rad.map(|e1_rad| e1_rad + by_rad),
        Course::Ptp { to } | Course::Lin { to } => turn_target(to, workcell, by_rad),
        Course::Circ(circ) => turn_target(&mut circ.to, workcell, by_rad),
        Course::Spline(_) => {}
    }
}

/// Adds an angle to the E1 of a target. A named frame becomes a target of this motion alone, since
/// other motions may use the frame as well. The signs of the joints (`turn`) are those of the old
/// elbow angle, and are left out.
fn turn_target(target: &mut TargetRef, workcell: &Workcell, by_rad: f64) {
    let Some(Target { e1_rad: Some(e1_rad), .. }) = given(target, workcell) else { return };
    let e1_rad = Some(e1_rad + by_rad);
    match target {
        TargetRef::Given(target) => (target.e1_rad, target.turn) = (e1_rad, None),
        TargetRef::Named(name) => {
            if let Some(frame) = workcell.frames.get(name) {
                // The base of the motion does not apply to named frames.
                let base = frame.base.clone().or_else(|| workcell.base.clone());
                let base = Some(base.unwrap_or_else(|| ROBOT.to_owned()));
                let turned = Target { base, e1_rad, turn: None, ..frame.clone() };
                *target = TargetRef::Given(turned);
            }
        }
    }
}

/// Returns the target behind a reference, if it is known.
pub(crate) fn given<'a>(target: &'a TargetRef, workcell: &'a Workcell) -> Option<&'a Target> {
    match target {
        TargetRef::Given(target) => Some(target),
        TargetRef::Named(name) => workcell.frames.get(name),
    }
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            ChangeKind::Elbow { from_rad, to_rad, last } => {
                let [from, to] = [from_rad, to_rad].map(|angle| tenths(angle.to_degrees()));
                write!(f, "E1 {from} -> {to} deg")?;
                if *last == self.motion { Ok(()) } else { write!(f, ", and on to motion {last}") }
            }
            ChangeKind::Blend { from: Some(from), to_mm } => {
                match (from.cart_mm, from.sunrise_rel, from.fraction) {
                    (Some(mm), ..) => write!(f, "blend {} ", tenths(mm)),
                    (_, Some(share), _) => write!(f, "blend sunrise_rel {share} "),
                    (_, _, Some(share)) => write!(f, "blend fraction {share} "),
                    _ => write!(f, "blend "),
                }?;
                write!(f, "-> {} mm", tenths(*to_mm))
            }
            ChangeKind::Blend { from: None, to_mm } => {
                write!(f, "stop -> blend {} mm", tenths(*to_mm))
            }
            ChangeKind::FullSpeed { from_rel } => write!(f, "velocity_rel {from_rel} -> 1"),
            ChangeKind::NoWaitForEnd => write!(f, "move -> moveAsync"),
            ChangeKind::OverlapWait { seconds, was_blocking } => {
                write!(f, "wait {seconds} s -> from the start of motion {}", self.first())?;
                if *was_blocking { write!(f, ", sent by moveAsync") } else { Ok(()) }
            }
        }
    }
}

/// Rounds to tenths, without a trailing zero.
fn tenths(value: f64) -> f64 {
    // Adding zero turns -0 into 0.
    (value * 10.0).round() / 10.0 + 0.0
}
