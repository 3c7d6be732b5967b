//! A path of the TCP, and what is wrong where the arm cannot follow it.

use std::sync::Arc;

use iiwa_kin::{Joints, Number, Taylor};

use super::{
    joint_curve::{CurveFault, JointCurve, TcpCurve},
    quintic::Linked,
};
use crate::joint_spline::{CurveFaultAt, JointSpline};
use iiwa_program::{CartesianFault, MotionLimits};

/// A path of the TCP, and its image.
#[derive(Clone, Debug)]
pub(crate) struct TcpPath {
    pub(crate) curve: Arc<TcpCurve>,
    pub(crate) image: Arc<JointSpline>,
    /// dsigma/ds, in rad.
    pub(crate) rate_rad: f64,
    /// Whether the TCP stops at its end, though the motion goes on.
    pub(crate) stops: bool,
    /// Limits of its own.
    pub(crate) limits: Option<Arc<MotionLimits>>,
}

impl TcpPath {
    /// That of a curve, with the mean rate of the joints as its own.
    pub(crate) fn of(curve: TcpCurve) -> Result<Self, CartesianFault> {
        let curve = Arc::new(curve);
        let image = JointSpline::of(Arc::clone(&curve) as Arc<dyn JointCurve>)
            .map_err(|found| curve.fault(found))?;
        if let Some((joint, s, found_rad)) = image.outside(curve.robot.limits()) {
            return Err(CartesianFault::OutsideOnTheWay {
                s,
                outside: curve.robot.limits().outside(joint, found_rad),
                other_e1_deg: curve.other_e1_deg(),
            });
        }
        let rate_rad = image.mean_rate_rad();
        Ok(Self { curve, image: Arc::new(image), rate_rad, stops: false, limits: None })
    }

    /// The joints where it ends, in rad.
    pub(crate) fn end_rad(&self) -> Result<Joints, CartesianFault> {
        let end = self.curve.at(Taylor::constant(1.0)).map(|joints| joints.map(Number::value));
        end.map_err(|fault| self.curve.fault(CurveFaultAt { s: 1.0, fault }))
    }
}

/// Farther than this from singular poses another E1 has to keep the arm, to be worth a mention.
const CLEAR: f64 = 0.1;

impl TcpCurve {
    /// Whether a blend into `next` can go by the poses of one TCP.
    pub(crate) fn joins_in_space(&self, next: &Self) -> bool {
        self.flange == next.flange && self.wrist.is_none() && next.wrist.is_none()
    }

    /// What is wrong where the curve cannot be followed.
    pub(crate) fn fault(&self, CurveFaultAt { s, fault }: CurveFaultAt) -> CartesianFault {
        match fault {
            CurveFault::Unreachable(reason) if s == 1.0 => CartesianFault::Unreachable(reason),
            CurveFault::Unreachable(reason) => CartesianFault::UnreachableOnTheWay { s, reason },
            CurveFault::Singular(part) => {
                CartesianFault::Singular { s, part: Some(part), other_e1_deg: self.other_e1_deg() }
            }
            CurveFault::Abrupt => {
                let other_e1_deg = self.other_e1_deg();
                // Far outside its range, at half a turn, a joint jumps to the other side.
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

    /// Another E1 at the target, in degrees, with which the arm can follow the curve and stays away from singular
    /// poses: the nearest in steps of five degrees.
    fn other_e1_deg(&self) -> Option<f64> {
        const STEP_DEG: f64 = 5.0;
        const SAMPLES: u32 = 32;
        if self.wrist.is_some() {
            // Another E1 would change the joints of the wrist at the end, too.
            return None;
        }
        // On a segment of a spline, another E1 would change the other segments, too.
        let [[from], [by]] = self.e1_rad.linear()?;
        let nearest = ((from + by).to_degrees() / STEP_DEG).round();
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
                    let starts = i == 0;
                    (starts || self.robot.singularity(&joints).least().0 > CLEAR)
                        && self.robot.limits().check(&joints).is_ok()
                })
            })
        };
        tries.into_iter().find(is_clear)
    }
}

impl CurveFaultAt {
    /// What is wrong with a blend.
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
