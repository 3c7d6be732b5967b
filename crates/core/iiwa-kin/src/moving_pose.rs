//! Pose of a moving frame.

use crate::{Pose, taylor::Taylor};

/// A pose as a function of one parameter, with its first three derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingPose {
    /// Origin, in m.
    pub position_m: [Taylor; 3],
    /// Rotation matrix, row-major; its columns are the axes of the frame.
    pub rotation: [[Taylor; 3]; 3],
}

impl MovingPose {
    /// A pose at rest.
    #[must_use]
    pub fn constant(pose: &Pose) -> Self {
        Self {
            position_m: pose.position_m.map(Taylor::constant),
            rotation: pose.rotation.map(|row| row.map(Taylor::constant)),
        }
    }

    /// The pose without its derivatives.
    #[must_use]
    pub fn pose(&self) -> Pose {
        Pose {
            position_m: self.position_m.map(|number| number.0[0]),
            rotation: self.rotation.map(|row| row.map(|number| number.0[0])),
        }
    }

    /// Pose of a frame `carried` that is fixed to this frame and given in it.
    ///
    /// For example the flange pose from the TCP pose, with the inverse of the tool.
    #[must_use]
    #[inline]
    pub fn then_fixed(&self, carried: &Pose) -> Self {
        let along =
            |row: &[Taylor; 3], x: f64, y: f64, z: f64| row[0] * x + row[1] * y + row[2] * z;
        let ([x, y, z], r) = (carried.position_m, &carried.rotation);
        Self {
            position_m: std::array::from_fn(|i| {
                self.position_m[i] + along(&self.rotation[i], x, y, z)
            }),
            rotation: self
                .rotation
                .map(|row| std::array::from_fn(|k| along(&row, r[0][k], r[1][k], r[2][k]))),
        }
    }

    /// This pose expressed in the frame in which `carrier` is given; `carrier` is the pose of the
    /// frame in which this pose is given.
    ///
    /// For example a motion given in a fixed base, expressed in the robot base.
    #[must_use]
    #[inline]
    pub fn carried_by(&self, carrier: &Pose) -> Self {
        let along = |row: &[f64; 3], v: &[Taylor; 3]| v[0] * row[0] + v[1] * row[1] + v[2] * row[2];
        let axis = |k: usize| self.rotation.map(|row| row[k]);
        let axes = [axis(0), axis(1), axis(2)];
        Self {
            position_m: std::array::from_fn(|i| {
                along(&carrier.rotation[i], &self.position_m) + carrier.position_m[i]
            }),
            rotation: carrier.rotation.map(|row| axes.each_ref().map(|axis| along(&row, axis))),
        }
    }
}
