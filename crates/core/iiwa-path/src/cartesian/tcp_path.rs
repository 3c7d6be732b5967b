//! TCP paths, and faults where the robot cannot follow them.

use std::sync::Arc;

use iiwa_kin::{Joints, Number, Taylor};

use super::{
    joint_curve::{CurveFault, JointCurve, TcpCurve},
    quintic::Linked,
};
use crate::joint_spline::{CurveFaultAt, JointSpline};
use iiwa_program::{CartesianFault, MotionLimits};

/// A TCP path and its image in joint space.
#[derive(Clone, Debug)]
pub(crate) struct TcpPath {
    pub(crate) curve: Arc<TcpCurve>,
    /// The path as a curve in joint space.
    pub(crate) image: Arc<JointSpline>,
    /// dsigma/ds, in rad.
    pub(crate) rate_rad: f64,
    /// `true` if the TCP stops at the end of the path within a motion.
    pub(crate) stops: bool,
    /// Index of the segment of a spline.
    pub(crate) segment: usize,
    /// Limits in place of those of the motion.
    pub(crate) limits: Option<Arc<MotionLimits>>,
}

impl TcpPath {
    /// Builds the path of a curve, with the mean rate of the joints as its rate.
    pub(crate) fn of(curve: TcpCurve) -> Result<Self, CartesianFault> {
        let curve = Arc::new(curve);
        let image = JointSpline::of(Arc::clone(&curve) as Arc<dyn JointCurve>)
            .map_err(|fault| curve.fault(fault))?;
        if let Some((joint, s, found_rad)) = image.outside(curve.robot.limits()) {
            return Err(CartesianFault::OutsideOnTheWay {
                s,
                outside: curve.robot.limits().outside(joint, found_rad),
                other_e1_deg: curve.other_e1_deg(),
            });
        }
        let rate_rad = image.mean_rate_rad();
        Ok(Self { curve, image: Arc::new(image), rate_rad, stops: false, segment: 0, limits: None })
    }

    /// Joints at the end, in rad.
    pub(crate) fn end_rad(&self) -> Result<Joints, CartesianFault> {
        let end = self.curve.at(Taylor::constant(1.0)).map(|joints| joints.map(Number::value));
        end.map_err(|fault| self.curve.fault(CurveFaultAt { s: 1.0, fault }))
    }
}

/// Least distance from singular poses, as a measure of singularity, at which another E1 is
/// suggested.
const CLEAR: f64 = 0.1;

impl TcpCurve {
    /// True if a blend into `next` can interpolate the poses of one TCP.
    pub(crate) fn joins_in_space(&self, next: &Self) -> bool {
        self.flange == next.flange && self.wrist.is_none() && next.wrist.is_none()
    }

    /// Converts a failure to follow the curve into a fault.
    pub(crate) fn fault(&self, CurveFaultAt { s, fault }: CurveFaultAt) -> CartesianFault {
        match fault {
            // The frame itself is out of reach, not the path to it.
            CurveFault::Unreachable(reason) if s == 1.0 => CartesianFault::Unreachable(reason),
            CurveFault::Unreachable(reason) => CartesianFault::UnreachableOnTheWay { s, reason },
            CurveFault::Singular(part) => {
                CartesianFault::Singular { s, part: Some(part), other_e1_deg: self.other_e1_deg() }
            }
            CurveFault::Abrupt => {
                let other_e1_deg = self.other_e1_deg();
                // At half a turn, far outside its range, a joint jumps to the other side.
                let joints = self.at(Taylor::constant(s)).map(|joints| joints.map(Number::value));
                match joints.map(|joints| self.robot.limits().check(&joints)) {
                    Ok(Err(outside)) => {
                        CartesianFault::OutsideOnTheWay { s, outside, other_e1_deg }
                    }
                    _ => CartesianFault::Singular { s, part: None, other_e1_deg },
                }
            }
        }
    }

    /// Suggests another E1 at the target, in degrees, with which the robot can follow the curve and
    /// stays away from singular poses: the nearest in steps of five degrees.
    fn other_e1_deg(&self) -> Option<f64> {
        const STEP_DEG: f64 = 5.0;
        const SAMPLES: u32 = 32;
        if self.wrist.is_some() {
            // Another E1 would also change the wrist joints at the end.
            return None;
        }
        // On a spline segment, another E1 would also change the other segments.
        let [[from], [by]] = self.e1_rad.linear()?;
        let nearest = ((from + by).to_degrees() / STEP_DEG).round();
        // Alternately above and below, the nearest first, up to 170 deg away.
        let tries = (1..=68).map(|k| {
            let away = f64::from((k + 1) / 2);
            STEP_DEG * if k % 2 == 0 { nearest - away } else { nearest + away }
        });
        let is_clear = |e1_deg: &f64| {
            let e1_rad = Linked::even([from], [e1_deg.to_radians()]);
            let other = Self { e1_rad, ..self.clone() };
            (0..=SAMPLES).all(|i| {
                let s = f64::from(i) / f64::from(SAMPLES);
                other.at(Taylor::constant(s)).is_ok_and(|joints| {
                    let joints = joints.map(Number::value);
                    // The start does not depend on the E1 at the target.
                    let starts = i == 0;
                    (starts || self.robot.singularity(&joints).nearest().0 > CLEAR)
                        && self.robot.limits().check(&joints).is_ok()
                })
            })
        };
        tries.into_iter().find(is_clear)
    }
}

impl CurveFaultAt {
    /// Converts a failure in a blend into a fault.
    pub(crate) fn in_blend(self) -> CartesianFault {
        let Self { s, fault } = self;
        match fault {
            CurveFault::Unreachable(reason) => CartesianFault::UnreachableOnTheWay { s, reason },
            CurveFault::Singular(part) => {
                CartesianFault::Singular { s, part: Some(part), other_e1_deg: None }
            }
            CurveFault::Abrupt => CartesianFault::Singular { s, part: None, other_e1_deg: None },
        }
    }
}
