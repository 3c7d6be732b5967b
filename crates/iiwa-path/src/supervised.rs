//! Segments on which the speed of the flange is supervised, too.

use std::sync::Arc;

use iiwa_kin::{Joints, Pose, Robot, Taylor};

use crate::{
    cartesian::tcp_course::tool_way,
    segment::{Derivatives, Segment},
    tool_way::ToolWay,
};

/// A segment whose way, where limits of the TCP hold, is that of the TCP or that of the flange, whichever goes faster: so
/// the controller supervises speed in the operating mode T1.
#[derive(Clone, Debug)]
pub(crate) struct Supervised {
    pub(crate) inner: Arc<dyn Segment>,
    pub(crate) robot: Arc<Robot>,
    /// The TCP in the flange's frame.
    pub(crate) tcp: Pose,
}

impl Segment for Supervised {
    fn at(&self, s: f64) -> Derivatives {
        self.inner.at(s)
    }

    fn bend_bound_rad(&self) -> Joints {
        self.inner.bend_bound_rad()
    }

    fn tangent_lengths_rad(&self) -> [f64; 2] {
        self.inner.tangent_lengths_rad()
    }

    /// Never: the limit of the TCP changes along it.
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
        let joints = std::array::from_fn(|j| Taylor([q[j], dq[j], ddq[j] / 2.0, dddq[j] / 6.0]));
        let flange = self.robot.flange_moving(&joints);
        let [flange, tcp] = [tool_way(&flange), tool_way(&flange.then_fixed(&self.tcp))];
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
