//! Groups of motions whose elbow angles change together.

use iiwa_program::{Course, Motion, MotionIndex, Program};

use crate::change::{Change, ChangeKind, given};

/// Largest difference from the E1 of the program, in degrees, and the steps of the search.
pub(crate) const RANGE_DEG: f64 = 90.0;
pub(crate) const STEPS_DEG: [f64; 4] = [15.0, 5.0, 2.0, 1.0];

/// Motions to frames that follow each other, from a point-to-point motion or the first of them to
/// the motion before the next point-to-point motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ElbowGroup {
    first: MotionIndex,
    last: MotionIndex,
}

impl ElbowGroup {
    /// Returns the groups of a program, without those whose first motion states no E1, or that
    /// contain a spline, whose segments have E1 of their own.
    pub(crate) fn all(program: &Program) -> Vec<(Self, f64)> {
        let mut groups: Vec<(Self, f64)> = Vec::new();
        let mut open = false;
        for (index, entry) in program.entries() {
            match entry {
                Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => {}
                Motion::Ptp(_) => open = false,
                Motion::Cartesian(cartesian) => {
                    let is_spline = matches!(cartesian.course, Course::Spline(_));
                    match groups.last_mut().filter(|_| open && !cartesian.is_ptp()) {
                        Some(_) if is_spline => {
                            groups.pop();
                            open = false;
                        }
                        Some((group, _)) => group.last = index,
                        None => {
                            let target = cartesian.target().filter(|_| !is_spline);
                            let target = target.and_then(|to| given(to, &program.workcell));
                            let e1_rad = target.and_then(|target| target.e1_rad);
                            groups.extend(
                                e1_rad.map(|e1_rad| (Self { first: index, last: index }, e1_rad)),
                            );
                            open = e1_rad.is_some();
                        }
                    }
                }
            }
        }
        groups
    }

    /// Returns the change by an angle in degrees, where the first target has `e1_rad`.
    pub(crate) fn turned_by(self, e1_rad: f64, by_deg: f64) -> Change {
        let to_rad = (e1_rad.to_degrees() + by_deg).to_radians();
        let kind = ChangeKind::Elbow { from_rad: e1_rad, to_rad, last: self.last };
        Change { motion: self.first, kind }
    }

    pub(crate) fn first(self) -> MotionIndex {
        self.first
    }

    pub(crate) fn last(self) -> MotionIndex {
        self.last
    }
}
