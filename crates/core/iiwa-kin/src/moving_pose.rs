//! Pose of a moving frame, such as that of the flange.

use crate::{Pose, Robot, number::Number, taylor::Taylor};

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

impl Robot {
    /// Flange pose in the base frame, with its first three derivatives, for moving joints.
    ///
    /// ```
    /// use iiwa_kin::{Robot, Taylor};
    ///
    /// let robot = Robot::lbr_iiwa_7_r800();
    /// // A1 rotates by 1 rad per unit, with the arm stretched sideways.
    /// let mut joints = [Taylor::constant(0.0); 7];
    /// joints[0] = Taylor::variable(0.0);
    /// joints[1] = Taylor::constant(std::f64::consts::FRAC_PI_2);
    /// let [_, speed, ..] = robot.flange_moving(&joints).position_m[1].derivatives();
    /// assert!((speed - 0.952).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn flange_moving(&self, joints: &[Taylor; 7]) -> MovingPose {
        let [base, upper_arm, forearm, flange] = self.offsets();
        let [a1, a2, a3, a4, a5, a6, a7] = *joints;
        let mut frame = MovingPose::constant(&Pose::IDENTITY);
        advance(&mut frame, base);
        turn(&mut frame, Z, a1);
        turn(&mut frame, Y, a2);
        advance(&mut frame, upper_arm);
        turn(&mut frame, Z, a3);
        turn(&mut frame, Y, -a4);
        advance(&mut frame, forearm);
        turn(&mut frame, Z, a5);
        turn(&mut frame, Y, a6);
        turn(&mut frame, Z, a7);
        advance(&mut frame, flange);
        frame
    }
}

/// Pairs of axes that a rotation about z or y turns into each other, in order of rotation.
const Z: [usize; 2] = [0, 1];
const Y: [usize; 2] = [2, 0];

/// Rotates a frame about one of its own axes.
fn turn(frame: &mut MovingPose, [first, second]: [usize; 2], angle: Taylor) {
    let (sin, cos) = angle.sin_cos();
    for row in &mut frame.rotation {
        let (a, b) = (row[first], row[second]);
        (row[first], row[second]) = (a * cos + b * sin, b * cos - a * sin);
    }
}

/// Translates a frame along its own z axis.
fn advance(frame: &mut MovingPose, by_m: f64) {
    for (position, row) in std::iter::zip(&mut frame.position_m, &frame.rotation) {
        *position = *position + row[2] * by_m;
    }
}
