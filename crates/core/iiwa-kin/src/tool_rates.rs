//! Velocity of a tool and its first two derivatives, for moving joints.

use crate::{
    Joints, Robot,
    forward::sin_cos_of_joints,
    rotation::{Vec3, cross},
};

/// Linear and angular velocity of a tool and their first two derivatives, in the base frame. Units
/// follow from those of the joints' derivatives: m/s and rad/s if these are by time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolRates {
    /// Velocity of the TCP, and its derivatives.
    pub linear: [[f64; 3]; 3],
    /// Angular velocity, and its derivatives.
    pub angular: [[f64; 3]; 3],
}

/// Rotating frame with its angular velocity and the first two derivatives of it, and the linear
/// rates of its origin.
struct RotatingFrame {
    /// Axes in the base frame.
    axes: [Vec3<f64>; 3],
    rates: ToolRates,
}

impl Robot {
    /// Rates of a tool whose TCP has the position `tcp_m` in the flange frame, for joints at
    /// `joints_rad` with the first three derivatives `rates`.
    ///
    /// ```
    /// let robot = iiwa_kin::Robot::lbr_iiwa_7_r800();
    /// // A1 rotates steadily, with the arm stretched sideways: the flange moves on a circle.
    /// let joints = [0.0, std::f64::consts::FRAC_PI_2, 0.0, 0.0, 0.0, 0.0, 0.0];
    /// let steady = [[2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0; 7], [0.0; 7]];
    /// let rates = robot.tool_rates(&[0.0; 3], &joints, &steady);
    /// assert!((rates.linear[0][1] - 2.0 * 0.952).abs() < 1e-12);
    /// assert!((rates.linear[1][0] + 4.0 * 0.952).abs() < 1e-12);
    /// assert_eq!(rates.angular[0], [0.0, 0.0, 2.0]);
    /// ```
    #[must_use]
    pub fn tool_rates(
        &self,
        tcp_m: &[f64; 3],
        joints_rad: &Joints,
        rates: &[Joints; 3],
    ) -> ToolRates {
        let (sin, cos) = sin_cos_of_joints(joints_rad);
        let [_, upper_arm, forearm, flange] = self.offsets();
        let still = ToolRates { linear: [[0.0; 3]; 3], angular: [[0.0; 3]; 3] };
        let mut frame = RotatingFrame {
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            rates: still,
        };
        let of = |j: usize| [rates[0][j], rates[1][j], rates[2][j]];
        let opposite = |j: usize| of(j).map(|rate| -rate);
        frame.turn_about_z(sin[0], cos[0], of(0));
        frame.turn_about_y(sin[1], cos[1], of(1));
        frame.carry(&[0.0, 0.0, upper_arm]);
        frame.turn_about_z(sin[2], cos[2], of(2));
        frame.turn_about_y(-sin[3], cos[3], opposite(3));
        frame.carry(&[0.0, 0.0, forearm]);
        frame.turn_about_z(sin[4], cos[4], of(4));
        frame.turn_about_y(sin[5], cos[5], of(5));
        frame.turn_about_z(sin[6], cos[6], of(6));
        let [x, y, z] = *tcp_m;
        frame.carry(&[x, y, flange + z]);
        frame.rates
    }
}

impl RotatingFrame {
    fn turn_about_z(&mut self, sin: f64, cos: f64, rates: [f64; 3]) {
        let [x, y, z] = self.axes;
        self.add_rates(&z, rates);
        self.axes = [combined(cos, &x, sin, &y), combined(-sin, &x, cos, &y), z];
    }

    fn turn_about_y(&mut self, sin: f64, cos: f64, rates: [f64; 3]) {
        let [x, y, z] = self.axes;
        self.add_rates(&y, rates);
        self.axes = [combined(cos, &x, -sin, &z), y, combined(sin, &x, cos, &z)];
    }

    /// Adds the rates of a joint that turns about `axis`, which is fixed to the frame before the
    /// joint and rotates with it.
    fn add_rates(&mut self, axis: &Vec3<f64>, [first, second, third]: [f64; 3]) {
        let [velocity, acceleration, _] = self.rates.angular;
        let turning = cross(&velocity, axis);
        let bending = sum(&cross(&acceleration, axis), &cross(&velocity, &turning));
        let [a, b, c] = &mut self.rates.angular;
        for i in 0..3 {
            a[i] += first * axis[i];
            b[i] += second * axis[i] + first * turning[i];
            c[i] += third * axis[i] + 2.0 * second * turning[i] + first * bending[i];
        }
    }

    /// Moves the origin by a vector that is fixed to the frame.
    fn carry(&mut self, [x, y, z]: &Vec3<f64>) {
        let along: Vec3<f64> = std::array::from_fn(|i| {
            x * self.axes[0][i] + y * self.axes[1][i] + z * self.axes[2][i]
        });
        let [velocity, acceleration, jerk] = &self.rates.angular;
        let first = cross(velocity, &along);
        let second = sum(&cross(acceleration, &along), &cross(velocity, &first));
        let third = sum(
            &sum(&cross(jerk, &along), &combined(2.0, &cross(acceleration, &first), 0.0, &first)),
            &cross(velocity, &second),
        );
        for (rate, by) in self.rates.linear.iter_mut().zip([first, second, third]) {
            *rate = sum(rate, &by);
        }
    }
}

fn sum(a: &Vec3<f64>, b: &Vec3<f64>) -> Vec3<f64> {
    std::array::from_fn(|i| a[i] + b[i])
}

fn combined(k: f64, a: &Vec3<f64>, m: f64, b: &Vec3<f64>) -> Vec3<f64> {
    std::array::from_fn(|i| k * a[i] + m * b[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Pose, Taylor};

    /// Compares with the derivatives of the moving pose, which are power series.
    #[test]
    fn rates_are_those_of_the_moving_pose() {
        let mut random = fastrand::Rng::with_seed(7);
        let robot = Robot::lbr_iiwa_14_r820();
        for _ in 0..200 {
            let mut joints = || std::array::from_fn(|_| 4.0 * random.f64() - 2.0);
            let (q, rates): (Joints, [Joints; 3]) = (joints(), [joints(), joints(), joints()]);
            let tcp_m = [random.f64(), random.f64() - 0.5, 0.3 * random.f64()];
            let moving = std::array::from_fn(|j| {
                Taylor([q[j], rates[0][j], rates[1][j] / 2.0, rates[2][j] / 6.0])
            });
            let tcp = Pose { position_m: tcp_m, ..Pose::IDENTITY };
            let pose = robot.flange_moving(&moving).then_fixed(&tcp);
            let actual = robot.tool_rates(&tcp_m, &q, &rates);
            for k in 0..3 {
                for i in 0..3 {
                    let expected = pose.position_m[i].derivatives()[k + 1];
                    let error = actual.linear[k][i] - expected;
                    assert!(error.abs() < 1e-11 * (1.0 + expected.abs()), "{k} {i}: {error}");
                }
            }
            // The rates of an axis follow from the angular ones, as from the moving pose.
            let axis = pose.rotation.map(|row| row[0].derivatives());
            let [w, dw, ddw] = actual.angular;
            let value = axis.map(|x| x[0]);
            let first = cross(&w, &value);
            let second = sum(&cross(&dw, &value), &cross(&w, &first));
            let third = sum(
                &sum(&cross(&ddw, &value), &cross(&w, &second)),
                &combined(2.0, &cross(&dw, &first), 0.0, &first),
            );
            for (k, expected) in [first, second, third].iter().enumerate() {
                for i in 0..3 {
                    let error = expected[i] - axis[i][k + 1];
                    assert!(error.abs() < 1e-10 * (1.0 + expected[i].abs()), "{k} {i}: {error}");
                }
            }
        }
    }
}
