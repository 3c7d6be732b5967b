//! Peer: forward kinematics of the `k` crate, read from the robot's URDF.

use iiwa_kin::{Joints, Robot};
use k::{Chain, Isometry3, SerialChain};

use super::Result;

/// Chain of joints from the base to the flange.
pub struct UrdfChain {
    chain: SerialChain<f64>,
}

impl UrdfChain {
    /// Creates the chain of `robot`.
    ///
    /// # Errors
    ///
    /// An error if the crate cannot read the URDF.
    pub fn new(robot: &Robot) -> Result<Self> {
        let urdf = urdf_rs::read_from_string(&robot.to_urdf())?;
        let tree = Chain::<f64>::from(urdf);
        let end = tree
            .iter()
            .find(|node| node.link().as_ref().is_some_and(|link| link.name == "iiwa_link_ee"))
            .ok_or("no link iiwa_link_ee in the URDF")?;
        Ok(Self { chain: SerialChain::from_end(end) })
    }

    /// Flange pose in the base frame, positions in m.
    #[must_use]
    pub fn flange_pose(&self, joints_rad: &Joints) -> Isometry3<f64> {
        self.chain.set_joint_positions_unchecked(joints_rad);
        self.chain.end_transform()
    }
}

#[cfg(test)]
mod tests {
    use super::super::joints::poses;
    use super::*;

    #[test]
    fn is_the_same_robot() {
        let robot = Robot::lbr_iiwa_7_r800();
        let peer = UrdfChain::new(&robot).unwrap();
        for q in poses(&robot, 100) {
            let (ours, theirs) =
                (robot.flange_position(&q), peer.flange_pose(&q).translation.vector);
            for i in 0..3 {
                assert!((ours[i] - theirs[i]).abs() < 1e-6, "{ours:?} {theirs:?}");
            }
        }
    }
}
