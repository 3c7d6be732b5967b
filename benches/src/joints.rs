//! Pseudo-random numbers that are the same on every machine.

use iiwa_kin::{Joints, Robot, vector};
use iiwa_path::JointPath;
use iiwa_program::Program;

use super::Result;

/// Generator of pseudo-random numbers (`splitmix64`, Steele et al. 2014).
#[derive(Debug)]
pub struct Numbers(u64);

impl Numbers {
    /// Creates a generator; each `seed` gives other numbers.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Returns the next number, uniformly distributed over -1 to 1.
    pub fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Returns the next joint positions in rad, uniformly distributed over `share` of the robot's
    /// joint ranges.
    pub fn joints(&mut self, robot: &Robot, share: f64) -> Joints {
        robot.limits().upper_rad.map(|limit| share * limit * self.signed())
    }
}

/// Returns `count` joint positions in rad, over the whole joint ranges.
#[must_use]
pub fn poses(robot: &Robot, count: usize) -> Vec<Joints> {
    let mut numbers = Numbers::new(1);
    (0..count).map(|_| numbers.joints(robot, 1.0)).collect()
}

/// Returns paths of `count` single PTP motions with one length in joint space, from poses in the
/// middle of the ranges; every third motion moves a single joint.
///
/// # Errors
///
/// An error if a motion leaves the ranges.
pub fn ptp_paths(robot: &Robot, count: usize, length_rad: f64) -> Result<Vec<JointPath>> {
    let mut numbers = Numbers::new(2);
    let path = |i: usize| {
        let middle = numbers.joints(robot, 0.4);
        let mut direction = numbers.joints(robot, 1.0);
        if i.is_multiple_of(3) {
            direction = std::array::from_fn(|j| if j == i / 3 % 7 { 1.0 } else { 0.0 });
        }
        let half = 0.5 * length_rad / vector::norm(&direction);
        let [from, to] = [-half, half]
            .map(|k| std::array::from_fn(|j| (middle[j] + k * direction[j]).to_degrees()));
        Ok(JointPath::new(&Program::from_deg(from).ptp_deg(to).build(), robot)?)
    };
    (0..count).map(path).collect()
}
