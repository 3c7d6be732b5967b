//! Segments with supervised speed of both TCP and flange.

use std::sync::Arc;

use iiwa_kin::{Joints, Pose, Robot};

use crate::{
    cartesian::tcp_course::tool_way_of,
    segment::{Derivatives, Segment, ToolWay},
};

/// A segment whose TCP limits apply to the TCP or to the flange, whichever is faster, as the
/// controller supervises speed in the operating mode T1.
#[derive(Clone, Debug)]
pub(crate) struct SupervisedSegment {
    pub(crate) inner: Arc<dyn Segment>,
    pub(crate) robot: Arc<Robot>,
    /// TCP in the flange frame.
    pub(crate) tcp: Pose,
}

impl Segment for SupervisedSegment {
    fn at(&self, s: f64) -> Derivatives {
        self.inner.at(s)
    }

    fn bend_bound_rad(&self) -> Joints {
        self.inner.bend_bound_rad()
    }

    fn tangent_lengths_rad(&self) -> [f64; 2] {
        self.inner.tangent_lengths_rad()
    }

    /// Always `false`, because the TCP limit changes along the segment.
    fn is_straight(&self) -> bool {
        false
    }

    fn has_continuous_curvature(&self) -> bool {
        self.inner.has_continuous_curvature()
    }

    fn unsupervised(&self) -> Option<Arc<dyn Segment>> {
        Some(Arc::clone(&self.inner))
    }

    fn tool_way(&self, s: f64) -> ToolWay {
        let Derivatives { q, dq, ddq, dddq } = self.at(s);
        let rates = [dq, ddq, dddq];
        let [flange, tcp] = [[0.0; 3], self.tcp.position_m]
            .map(|point_m| tool_way_of(&self.robot.tool_rates(&point_m, &q, &rates)));
        if flange.way_m[0] > tcp.way_m[0] { flange } else { tcp }
    }

    fn sigma(&self, s: f64) -> [f64; 4] {
        self.inner.sigma(s)
    }

    fn sigma_unit_rad(&self) -> f64 {
        self.inner.sigma_unit_rad()
    }

    fn s_at(&self, sigma: f64) -> f64 {
        self.inner.s_at(sigma)
    }

    fn breaks(&self) -> &[f64] {
        self.inner.breaks()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Continuity, PolynomialBlend};

    #[test]
    fn the_way_of_tcp_and_flange_has_the_derivatives_of_differences() {
        let target = [0.1, 0.6, -0.2, -1.2, 0.3, 0.9, 0.0];
        let arrival = [0.3, -0.2, 0.1, 0.4, -0.3, 0.2, 0.6];
        let leaving = [-0.2, 0.3, 0.4, 0.1, 0.2, -0.3, -0.6];
        let blend = PolynomialBlend::new(&target, arrival, &leaving, 0.5, Continuity::Second);
        let robot = Arc::new(Robot::default());
        // The TCP is faster than the flange, or the same point.
        for tcp in [Pose::from_xyz_abc([0.3, 0.0, 0.2], [0.0; 3]), Pose::IDENTITY] {
            let inner = Arc::new(blend.clone());
            let supervised = SupervisedSegment { inner, robot: Arc::clone(&robot), tcp };
            for s in [0.15, 0.3, 0.55, 0.8] {
                const STEP: f64 = 1e-4;
                let way = |s: f64| supervised.tool_way(s);
                let [before, middle, after] = [s - STEP, s, s + STEP].map(way);
                let derivatives = supervised.at(s);
                let speed = [tcp, Pose::IDENTITY]
                    .iter()
                    .map(|tcp| robot.tcp_speed_m_s(tcp, &derivatives.q, &derivatives.dq))
                    .fold(0.0, f64::max);
                assert!((middle.way_m[0] - speed).abs() < 1e-12, "{middle:?} {speed}");
                for k in 0..2 {
                    let cases = [
                        (before.way_m[k], after.way_m[k], middle.way_m[k + 1]),
                        (before.turn_rad[k], after.turn_rad[k], middle.turn_rad[k + 1]),
                    ];
                    for (before, after, derivative) in cases {
                        let expected = (after - before) / (2.0 * STEP);
                        let error = (derivative - expected).abs();
                        assert!(
                            error < 1e-4 * (1.0 + expected.abs()),
                            "{s}: {derivative} {expected}"
                        );
                    }
                }
            }
        }
    }
}
