//! URDF, the ROS robot description: export of a model, and comparison of a user's URDF with a
//! model.

mod chain;
mod check;
mod error;
mod joint;
mod meshes;
mod read;
mod ros_names;
mod tag;
mod write;

pub use check::{LimitDifference, UrdfReport};
pub use error::{Listed, UrdfError};
pub use meshes::{UrdfLink, UrdfMesh};
pub use ros_names::{BadRosPrefix, RosNames, RosPrefix, RosStack};

/// Attributes of a joint limit: rad, rad, Nm, rad/s.
const LIMITS: [&str; 4] = ["lower", "upper", "effort", "velocity"];

impl crate::Limits {
    /// Limits of joint `j` (from 0), in the order of [`LIMITS`].
    fn of_urdf(&self, j: usize) -> [f64; 4] {
        [self.lower_rad[j], self.upper_rad[j], self.torque_nm[j], self.velocity_rad_s[j]]
    }
}
