//! Numbers that look random and are the same on every machine.

use iiwa_kin::{Joints, Robot};

/// A generator of numbers (`splitmix64`, Steele et al. 2014).
#[derive(Debug)]
pub struct Numbers(u64);

impl Numbers {
    /// A generator; each `seed` gives other numbers.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next number, evenly spread over -1 to 1.
    pub fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// The next joint positions in rad, evenly spread over `share` of the robot's ranges.
    pub fn joints(&mut self, robot: &Robot, share: f64) -> Joints {
        robot.limits().upper_rad.map(|limit| share * limit * self.signed())
    }
}

/// `count` joint positions in rad, all over the robot's ranges.
#[must_use]
pub fn poses(robot: &Robot, count: usize) -> Vec<Joints> {
    let mut numbers = Numbers::new(1);
    (0..count).map(|_| numbers.joints(robot, 1.0)).collect()
}
