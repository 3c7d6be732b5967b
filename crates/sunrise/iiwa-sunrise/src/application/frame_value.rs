//! Frames that a program computes.

use std::{cell::RefCell, rc::Rc};

use iiwa_java::Unknown;
use iiwa_kin::{Pose, Status};
use iiwa_program::Frame;

use crate::application::spot::Spot;

/// What a frame is given in.
#[derive(Clone, Debug)]
pub(crate) enum Parent {
    Spot(Spot),
    Frame(Rc<RefCell<FrameValue>>),
}

/// A frame that a program has made: it stays where it is in its parent until it is set.
#[derive(Clone, Debug)]
pub(crate) struct FrameValue {
    pub(crate) frame: Frame,
    pub(crate) parent: Parent,
    pub(crate) redundancy: RedundancyValue,
    /// What it depends on, if it is not known.
    pub(crate) unknown: Option<Rc<Unknown>>,
}

/// How the arm is to reach a frame, as far as that is said.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct RedundancyValue {
    pub(crate) e1_rad: Option<f64>,
    pub(crate) status: Option<Status>,
    pub(crate) turn: Option<u8>,
}

impl FrameValue {
    /// A frame in a spot, without redundancy.
    pub(crate) fn within(parent: Spot, frame: Frame) -> Self {
        Self {
            frame,
            parent: Parent::Spot(parent),
            redundancy: RedundancyValue::default(),
            unknown: None,
        }
    }
}

/// The pose of a frame with lengths in mm, as they are written: those that only add up stay whole numbers.
fn pose_mm(frame: &Frame) -> Pose {
    Pose::from_xyz_abc(frame.xyz_mm, frame.abc_rad)
}

/// The frame that `frame` carries as `carried`.
pub(crate) fn then(frame: &Frame, carried: &Frame) -> Frame {
    let pose = pose_mm(frame).then(&pose_mm(carried));
    // Angles that nothing turns stay as they are written.
    let abc_rad = match (frame.abc_rad, carried.abc_rad) {
        ([0.0, 0.0, 0.0], abc_rad) | (abc_rad, [0.0, 0.0, 0.0]) => abc_rad,
        _ => pose.abc_rad(),
    };
    Frame { xyz_mm: pose.position_m, abc_rad }
}

/// What `frame` is given in, as seen from it.
pub(crate) fn inverse(frame: &Frame) -> Frame {
    let pose = pose_mm(frame).inverse();
    let abc_rad = match frame.abc_rad {
        [0.0, 0.0, 0.0] => [0.0; 3],
        [a, 0.0, 0.0] => [-a, 0.0, 0.0],
        [0.0, b, 0.0] => [0.0, -b, 0.0],
        [0.0, 0.0, c] => [0.0, 0.0, -c],
        _ => pose.abc_rad(),
    };
    Frame { xyz_mm: pose.position_m, abc_rad }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_that_add_up_stay_whole() {
        let table = Frame { xyz_mm: [400.0, -200.1, 50.0], abc_rad: [0.0; 3] };
        let part = Frame { xyz_mm: [0.3, 0.0, 7.0], abc_rad: [0.1, 0.2, 0.3] };
        let found = then(&table, &part);
        assert_eq!(found.xyz_mm, [400.3, -200.1, 57.0]);
        assert_eq!(found.abc_rad, part.abc_rad);
    }

    #[test]
    fn a_frame_and_its_inverse_are_none() {
        let frame = Frame { xyz_mm: [10.0, -20.0, 30.0], abc_rad: [0.4, -0.5, 0.6] };
        let none = then(&frame, &inverse(&frame));
        assert!(
            none.xyz_mm.iter().chain(&none.abc_rad).all(|value| value.abs() < 1e-12),
            "{none:?}"
        );
    }
}
