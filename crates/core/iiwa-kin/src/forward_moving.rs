//! Forward kinematics of moving joints.

use crate::{MovingPose, Pose, Robot, Taylor, number::Number};

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
