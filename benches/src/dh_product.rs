//! Peer: textbook forward kinematics, a product of seven 4x4 matrices.

use iiwa_kin::{DhRow, Joints, Robot};
use nalgebra::Matrix4;

/// Denavit-Hartenberg table with the sines and cosines of its twists.
#[derive(Debug)]
pub struct DhProduct {
    links: [Link; 7],
}

#[derive(Debug)]
struct Link {
    row: DhRow,
    sin_alpha: f64,
    cos_alpha: f64,
}

impl DhProduct {
    /// Creates the table of `robot`.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        let links = robot.dh().map(|row| {
            let (sin_alpha, cos_alpha) = row.alpha_rad.sin_cos();
            Link { row, sin_alpha, cos_alpha }
        });
        Self { links }
    }

    /// Flange pose in the base frame, positions in m.
    #[must_use]
    pub fn flange_pose(&self, joints_rad: &Joints) -> Matrix4<f64> {
        self.links.iter().zip(joints_rad).fold(Matrix4::identity(), |pose, (link, theta)| {
            let (st, ct) = theta.sin_cos();
            let Link { row, sin_alpha: sa, cos_alpha: ca } = link;
            #[rustfmt::skip]
            let transform = Matrix4::new(
                ct, -st * ca, st * sa, row.a_m * ct,
                st, ct * ca, -ct * sa, row.a_m * st,
                0.0, *sa, *ca, row.d_m,
                0.0, 0.0, 0.0, 1.0,
            );
            pose * transform
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::joints::poses;
    use super::*;

    #[test]
    fn is_the_same_robot() {
        let robot = Robot::lbr_iiwa_7_r800();
        let peer = DhProduct::new(&robot);
        for q in poses(&robot, 100) {
            let (ours, theirs) = (robot.flange_pose(&q), peer.flange_pose(&q));
            for i in 0..3 {
                assert!((ours.position_m[i] - theirs[(i, 3)]).abs() < 1e-12);
                for k in 0..3 {
                    assert!((ours.rotation[i][k] - theirs[(i, k)]).abs() < 1e-12);
                }
            }
        }
    }
}
