//! Comparison of a URDF with a model.

use nalgebra::Vector3;

use super::{LIMITS, UrdfError, chain::Chain, read::Description};
use crate::{Joints, Robot};

/// Result of comparing a URDF with a model by [`Robot::check_urdf`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct UrdfReport {
    /// Link that joint 1 is mounted on; taken as the model's base.
    pub base: String,
    /// Link taken as the model's flange.
    pub tip: String,
    /// Names of the seven joints, from the base on.
    pub joints: [String; 7],
    /// Number of poses compared.
    pub poses: usize,
    /// Largest distance between the two flanges, in m.
    pub position_deviation_m: f64,
    /// Largest angle between the two flanges, in rad.
    pub rotation_deviation_rad: f64,
    /// Limits that differ by more than a thousandth.
    pub limits: Vec<LimitDifference>,
}

impl UrdfReport {
    /// Accepted distance between the flanges, in m: the iiwa's repeatability (KUKA data sheet). A
    /// URDF with quarter turns written as 1.5708 stays below it.
    pub const TOLERANCE_M: f64 = 1e-4;

    /// Accepted angle between the flanges, in rad.
    pub const TOLERANCE_RAD: f64 = 1e-4;
}

/// A joint limit that differs between a URDF and the model.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LimitDifference {
    /// The joint.
    pub joint: crate::Joint,
    /// Limit name as in the URDF: `lower` (rad), `upper` (rad), `effort` (Nm) or `velocity`
    /// (rad/s).
    pub limit: &'static str,
    /// Value in the URDF, if present.
    pub urdf: Option<f64>,
    /// Value in the model.
    pub model: f64,
}

impl Robot {
    /// Compares a URDF with this model: axes, flange and limits.
    ///
    /// The chain runs from the link that joint 1 is mounted on (links below it are the mounting) to
    /// `tip`, or by default to the end of the fixed joints after joint 7. Its frames may be
    /// anywhere along their axes. Base and tip must be the model's base and flange.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    ///
    /// let robot = Robot::lbr_iiwa_7_r800();
    /// let report = robot.check_urdf(&robot.to_urdf(), None)?;
    /// assert_eq!(report.tip, "iiwa_link_ee");
    /// assert!(report.position_deviation_m < 1e-12);
    /// # Ok::<(), iiwa_kin::UrdfError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the text is not a URDF, has no such chain of seven revolute joints, or if the two flanges
    /// differ by more than [`UrdfReport::TOLERANCE_M`] or [`UrdfReport::TOLERANCE_RAD`]; the error
    /// then names the first joint that is off. Limits that differ are not an error.
    pub fn check_urdf(&self, urdf: &str, tip: Option<&str>) -> Result<UrdfReport, UrdfError> {
        let description = Description::read(urdf)?;
        let chain = description.chain(tip)?;
        let zero = [0.0; 7];
        let mut largest = self.deviation(&chain, &zero);
        for pose in 1..POSES {
            let deviation = self.deviation(&chain, &self.test_pose(pose));
            largest = (largest.0.max(deviation.0), largest.1.max(deviation.1));
        }
        let (position_m, rotation_rad) = largest;
        if position_m > UrdfReport::TOLERANCE_M || rotation_rad > UrdfReport::TOLERANCE_RAD {
            return Err(self.culprit(&description, &chain, position_m, rotation_rad));
        }
        Ok(UrdfReport {
            base: chain.base.to_owned(),
            tip: chain.tip.to_owned(),
            joints: chain.revolute().map(|joint| joint.name.clone()),
            poses: POSES,
            position_deviation_m: position_m,
            rotation_deviation_rad: rotation_rad,
            limits: self.limit_differences(&chain),
        })
    }

    /// Distance (m) and angle (rad) between the flanges of model and URDF.
    fn deviation(&self, chain: &Chain<'_>, joints_rad: &Joints) -> (f64, f64) {
        let model = self.flange_pose(joints_rad);
        let (_, tip) = chain.poses(joints_rad);
        let distance = (tip.translation.vector - Vector3::from(model.position_m)).norm();
        let apart = tip.rotation.to_rotation_matrix().into_inner() - model.rotation_matrix();
        // Unlike the arc cosine of a trace, this is exact for small angles.
        let angle = 2.0 * (apart.norm() / 8.0_f64.sqrt()).min(1.0).asin();
        (finite(distance), finite(angle))
    }

    /// Pose `index` of a fixed sequence that fills the joint ranges evenly.
    fn test_pose(&self, index: usize) -> Joints {
        // Multiples of the square roots of primes, modulo 1.
        const PRIMES: Joints = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0];
        let shares = PRIMES.map(|prime| 2.0 * (index as f64 * prime.sqrt()).fract() - 1.0);
        self.limits().at_shares(&shares)
    }

    /// The first axis that is off, or the tip.
    ///
    /// A chain is determined by its axes and its tip at the zero pose (product of exponentials),
    /// wherever its frames are.
    fn culprit(
        &self,
        description: &Description<'_>,
        chain: &Chain<'_>,
        position_m: f64,
        rotation_rad: f64,
    ) -> UrdfError {
        // Small deviations add up, so a single axis may be within the tolerance although the flange
        // is not.
        const SHARE: f64 = 0.1;
        let tip = || UrdfError::Tip {
            place: chain.joints.last().map_or(description.span, |last| last.span).place(),
            tip: chain.tip.to_owned(),
            position_m,
            rotation_rad,
        };
        self.misplaced_axis(chain, SHARE).unwrap_or_else(tip)
    }

    /// The first axis that is off by more than this share of the tolerance, if any.
    pub(super) fn misplaced_axis(&self, chain: &Chain<'_>, share: f64) -> Option<UrdfError> {
        let model = self.link_poses(&[0.0; 7]);
        let (axes, _) = chain.poses(&[0.0; 7]);
        for (j, joint) in chain.revolute().into_iter().enumerate() {
            let rotation = model[j + 1].rotation_matrix();
            let expected = rotation.column(2).into_owned();
            let axis = axes[j].rotation * joint.axis;
            let shift = axes[j].translation.vector - Vector3::from(model[j + 1].position_m);
            let distance = finite((shift - expected * shift.dot(&expected)).norm());
            let angle = finite(axis.cross(&expected).norm().atan2(axis.dot(&expected)));
            if distance > share * UrdfReport::TOLERANCE_M
                || angle > share * UrdfReport::TOLERANCE_RAD
            {
                return Some(UrdfError::Axis {
                    place: joint.span.place(),
                    number: j + 1,
                    joint: joint.name.clone(),
                    position_m: distance,
                    rotation_rad: angle,
                });
            }
        }
        None
    }

    fn limit_differences(&self, chain: &Chain<'_>) -> Vec<LimitDifference> {
        let mut differences = Vec::new();
        for (joint, urdf_joint) in crate::Joint::ALL.into_iter().zip(chain.revolute()) {
            let model = self.limits().of_urdf(joint.index());
            for ((limit, urdf), model) in LIMITS.into_iter().zip(urdf_joint.limits).zip(model) {
                let same = urdf.is_some_and(|urdf| (urdf - model).abs() <= 1e-3 * model.abs());
                if !same {
                    differences.push(LimitDifference { joint, limit, urdf, model });
                }
            }
        }
        differences
    }
}

/// Number of poses on which two chains are compared.
const POSES: usize = 128;

/// Treats a deviation that overflowed to NaN as infinite.
fn finite(deviation: f64) -> f64 {
    if deviation.is_nan() { f64::INFINITY } else { deviation }
}
