//! Robot description and kinematics of a recording: link frames and flange pose.

use std::collections::BTreeMap;
use std::io::Write;
use std::time::Duration;

use iiwa_kin::{Joints, Pose, Robot, RosNames};

use crate::recorded_robot::PROFILE;
use crate::{FramePose, WriteError, Writer};

/// Robot with the data that its messages need: URDF, link frames and flange pose as functions of
/// the joint positions.
#[derive(Clone, Debug)]
pub struct Arm {
    robot: Robot,
    links: [FixedPart; 8],
    /// Names of the links and the flange.
    names: [String; 9],
    urdf: String,
}

/// Constant part of a link frame: the translation along the previous axis, and sine and cosine of
/// half the twist.
#[derive(Clone, Copy, Debug)]
struct FixedPart {
    d_m: f64,
    half_twist: (f64, f64),
}

impl Arm {
    /// Prepares the messages of `robot`, with default names.
    #[must_use]
    pub fn new(robot: &Robot) -> Self {
        Self::with_names(robot, &RosNames::default())
    }

    /// Prepares the messages of `robot`, with other joint and link names.
    #[must_use]
    pub fn with_names(robot: &Robot, names: &RosNames) -> Self {
        let dh = robot.dh();
        let links = std::array::from_fn(|link| {
            let before = link.checked_sub(1).map(|before| dh[before]);
            let (d_m, alpha) = before.map_or((0.0, 0.0), |row| (row.d_m, row.alpha_rad));
            FixedPart { d_m, half_twist: (0.5 * alpha).sin_cos() }
        });
        let urdf = robot.to_urdf_with_names(names);
        Self { robot: robot.clone(), links, names: names.links(), urdf }
    }

    /// URDF of the robot, for `/robot_description`.
    #[must_use]
    pub fn urdf(&self) -> &str {
        &self.urdf
    }

    /// Frame of each link in the previous link, as in the URDF, for `/tf`: the shift and the twist
    /// of the previous joint, then the rotation of the joint.
    #[must_use]
    pub fn links(&self, joints_rad: &Joints) -> [FramePose<'_>; 8] {
        std::array::from_fn(|link| {
            let FixedPart { d_m, half_twist: (sa, ca) } = self.links[link];
            let (st, ct) = joints_rad.get(link).map_or((0.0, 1.0), |theta| (0.5 * theta).sin_cos());
            FramePose {
                parent: &self.names[link],
                child: &self.names[link + 1],
                translation_m: [0.0, 0.0, d_m],
                rotation_xyzw: [sa * ct, -sa * st, ca * st, ca * ct],
            }
        })
    }

    /// Flange frame in the base frame, for `/tcp_pose` where the flange is the TCP.
    #[must_use]
    pub fn flange(&self, joints_rad: &Joints) -> FramePose<'_> {
        let pose = self.robot.flange_pose(joints_rad);
        FramePose {
            parent: &self.names[0],
            child: &self.names[8],
            translation_m: pose.position_m,
            rotation_xyzw: pose.quaternion_xyzw(),
        }
    }

    /// Writes `/robot_description`, at the epoch.
    pub(crate) fn description<W: Write>(&self, writer: &mut Writer<W>) -> Result<(), WriteError> {
        writer.robot_description(Duration::ZERO, &self.urdf)
    }

    /// Writes `/tf` and `/tcp_pose` for these joints.
    pub(crate) fn poses<W: Write>(
        &self,
        writer: &mut Writer<W>,
        t: Duration,
        joints_rad: &Joints,
    ) -> Result<(), WriteError> {
        writer.chain(t, &self.links(joints_rad))?;
        let FramePose { parent, translation_m, rotation_xyzw, .. } = self.flange(joints_rad);
        writer.tcp_pose(t, parent, translation_m, rotation_xyzw)
    }

    /// Writes `/tf`, `/tcp_pose` of a TCP given in the flange frame, and `/flange_pose` for these
    /// joints.
    pub(crate) fn poses_with_tool<W: Write>(
        &self,
        writer: &mut Writer<W>,
        t: Duration,
        joints_rad: &Joints,
        tcp: &Pose,
    ) -> Result<(), WriteError> {
        writer.chain(t, &self.links(joints_rad))?;
        let flange = self.robot.flange_pose(joints_rad);
        let (parent, tcp) = (&self.names[0], flange.then(tcp));
        writer.tcp_pose(t, parent, tcp.position_m, tcp.quaternion_xyzw())?;
        writer.flange_pose(t, parent, flange.position_m, flange.quaternion_xyzw())
    }

    /// Writes the `attachments` (name, media type, content), the robot's profile and URDF, and the
    /// `metadata` record `iiwasim`, and completes the file.
    pub(crate) fn finish<W: Write>(
        &self,
        mut writer: Writer<W>,
        metadata: &BTreeMap<String, String>,
        attachments: &[(&str, &str, &[u8])],
    ) -> Result<W, WriteError> {
        for (name, media_type, bytes) in attachments {
            writer.attach(name, media_type, bytes)?;
        }
        writer.attach(PROFILE, "application/json", self.robot.to_profile().as_bytes())?;
        writer.attach("robot.urdf", "application/xml", self.urdf.as_bytes())?;
        writer.metadata("iiwasim", metadata)?;
        writer.finish()
    }
}
