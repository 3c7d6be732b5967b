//! Frames that a program computes.

use std::{cell::RefCell, rc::Rc};

use iiwa_java::Unknown;
use iiwa_kin::{Pose, Status};
use iiwa_program::Frame;

use crate::application::spot::Spot;

/// Parent of a frame.
#[derive(Clone, Debug)]
pub(crate) enum Parent {
    Spot(Spot),
    Frame(Rc<RefCell<FrameValue>>),
}

/// Frame that a program has created: its pose in its parent changes only by its setters.
#[derive(Clone, Debug)]
pub(crate) struct FrameValue {
    pub(crate) frame: Frame,
    pub(crate) parent: Parent,
    pub(crate) redundancy: RedundancyValue,
    /// Unknown value on which the frame depends, if any.
    pub(crate) unknown: Option<Rc<Unknown>>,
}

/// Redundancy of a frame, as far as it is stated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct RedundancyValue {
    pub(crate) e1_rad: Option<f64>,
    pub(crate) status: Option<Status>,
    pub(crate) turn: Option<u8>,
}

impl FrameValue {
    /// Creates a frame in a parent, without redundancy.
    pub(crate) fn within(parent: Spot, frame: Frame) -> Self {
        Self {
            frame,
            parent: Parent::Spot(parent),
            redundancy: RedundancyValue::default(),
            unknown: None,
        }
    }
}

/// Returns the pose of a frame with lengths in mm, as written: sums of whole millimetres stay
/// exact.
fn pose_mm(frame: &Frame) -> Pose {
    Pose::from_xyz_abc(frame.xyz_mm, frame.abc_rad)
}

/// Composes two frames: `carried` is given in `frame`.
pub(crate) fn then(frame: &Frame, carried: &Frame) -> Frame {
    let pose = pose_mm(frame).then(&pose_mm(carried));
    // Angles that are not rotated keep their numbers as written.
    let abc_rad = match (frame.abc_rad, carried.abc_rad) {
        ([0.0, 0.0, 0.0], abc_rad) | (abc_rad, [0.0, 0.0, 0.0]) => abc_rad,
        _ => pose.abc_rad(),
    };
    Frame { xyz_mm: pose.position_m, abc_rad }
}

/// Inverts a frame.
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
        let actual = then(&table, &part);
        assert_eq!(actual.xyz_mm, [400.3, -200.1, 57.0]);
        assert_eq!(actual.abc_rad, part.abc_rad);
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
