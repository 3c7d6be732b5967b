//! The motions of a program on one robot, and those that a changed motion changes.

use std::{borrow::Cow, ops::Range, sync::Arc};

use iiwa_kin::{Joints, Robot, Status, vector};
use iiwa_program::{Fault, Motion, Program};

use crate::cartesian::leg::{self, Leg};

/// Difference of joint positions, in rad, that is rounding: a motion that starts as near as this to
/// its start before a change is not computed again. The end of a TCP path is computed from its
/// start, so that it moves by rounding with it.
const SAME_START_RAD: f64 = 1e-12;

/// Motions with their start and end in joint space; `None` for waits and loads.
pub(crate) type ListedLegs = Arc<Vec<Option<Arc<Leg>>>>;

/// The motions of a program on one robot. Without frames in the program, they are computed on
/// demand instead of listed.
pub(crate) enum Legs<'a> {
    InJoints { program: &'a Program, start_rad: Joints },
    Listed(ListedLegs),
}

impl<'a> Legs<'a> {
    pub(crate) fn new(program: &'a Program, robot: &Arc<Robot>) -> Result<Self, Fault> {
        match Self::in_joints(program) {
            Some(legs) => Ok(legs),
            None => listed(program, robot, |_, _| None).map(Self::Listed),
        }
    }

    /// Returns the motions after a change of those in `changed`, and the range of motions whose
    /// steps may change with them. Motions of `before` that start where they started are kept.
    pub(crate) fn changed(
        program: &'a Program,
        robot: &Arc<Robot>,
        before: Option<&ListedLegs>,
        changed: Range<usize>,
    ) -> Result<(Self, Range<usize>), Fault> {
        if let Some(legs) = Self::in_joints(program) {
            return Ok((legs, affected(&program.motions, changed)));
        }
        let Some(before) = before.filter(|legs| legs.len() == program.motions.len()) else {
            return Ok((Self::new(program, robot)?, 0..program.motions.len()));
        };
        let kept = |index: usize, from_rad: &Joints| {
            let leg = before[index].as_ref().filter(|_| !changed.contains(&index))?;
            let start_rad = &leg.ends_rad[0];
            // A sign of a joint at zero may decide on the configuration at the end.
            let is_same = vector::distance(start_rad, from_rad) <= SAME_START_RAD
                && Status::of(robot, start_rad) == Status::of(robot, from_rad);
            is_same.then(|| Arc::clone(leg))
        };
        let legs = listed(program, robot, kept)?;
        let is_other = |index: &usize| match (&before[*index], &legs[*index]) {
            (Some(old), Some(new)) => !Arc::ptr_eq(old, new),
            (None, None) => false,
            _ => true,
        };
        let last = (changed.start..legs.len()).rev().find(is_other);
        let last = last.unwrap_or(changed.start).max(changed.end - 1);
        let moves = |index: &usize| legs[*index].is_some();
        // The motion before is blended into the changed one, and the last one into the next.
        let first = (0..changed.start).rev().find(moves).unwrap_or(changed.start);
        let next = (last + 1..legs.len()).find(moves).unwrap_or(last);
        Ok((Self::Listed(legs), first..next + 1))
    }

    /// Returns the motions of a program without frames.
    fn in_joints(program: &'a Program) -> Option<Self> {
        let start_rad = *program.start.joints_rad().filter(|_| !program.has_frames())?;
        Some(Self::InJoints { program, start_rad })
    }

    /// Returns the list of motions; `None` if they are not listed.
    pub(crate) fn listed(&self) -> Option<&ListedLegs> {
        match self {
            Self::Listed(legs) => Some(legs),
            Self::InJoints { .. } => None,
        }
    }

    /// Returns the motion at `index`, or `None` for a wait, a load, or an index out of range.
    pub(crate) fn get(&self, index: usize) -> Option<Cow<'_, Leg>> {
        match self {
            Self::Listed(legs) => legs.get(index)?.as_deref().map(Cow::Borrowed),
            Self::InJoints { program, start_rad } => {
                let target = |entry: &Motion| match entry {
                    Motion::Ptp(ptp) => Some(ptp.target_rad),
                    _ => None,
                };
                let to_rad = target(program.motions.get(index)?)?;
                let from_rad = program.motions[..index].iter().rev().find_map(target);
                let ends_rad = [from_rad.unwrap_or(*start_rad), to_rad];
                Some(Cow::Owned(Leg { ends_rad, paths: Vec::new() }))
            }
        }
    }
}

/// Lists the motions in order, each from the end of the one before. `kept` returns a motion by its
/// index and its start if it need not be computed.
fn listed(
    program: &Program,
    robot: &Arc<Robot>,
    kept: impl Fn(usize, &Joints) -> Option<Arc<Leg>>,
) -> Result<ListedLegs, Fault> {
    let mut at_rad = program.start_rad(robot)?;
    let mut legs = Vec::with_capacity(program.motions.len());
    for (motion, entry) in program.entries() {
        let leg = match kept(motion.index(), &at_rad) {
            Some(leg) => Some(leg),
            None => leg::leg(program, robot, &at_rad, motion, entry)?.map(Arc::new),
        };
        if let Some(leg) = &leg {
            at_rad = leg.ends_rad[1];
        }
        legs.push(leg);
    }
    Ok(Arc::new(legs))
}

/// Motions in joint space whose steps may change with those in `changed`.
fn affected(motions: &[Motion], changed: Range<usize>) -> Range<usize> {
    let is_ptp = |place: &usize| matches!(motions[*place], Motion::Ptp(_));
    // The motion before is blended into this one.
    let first = (0..changed.start).rev().find(is_ptp).unwrap_or(changed.start);
    // The next motion is blended into the one after it.
    let last = (changed.end..motions.len()).filter(is_ptp).take(2).last();
    let last = last.unwrap_or(changed.end - 1);
    first..last + 1
}
