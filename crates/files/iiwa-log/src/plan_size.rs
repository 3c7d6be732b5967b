//! Estimate of the size of a plan file, before it is written.

use std::iter::zip;

use iiwa_traj::{Section, Trajectory};

/// Estimated size of the file that [`PlanWriter`](crate::PlanWriter) makes of a trajectory, from
/// its duration and its nodes: nothing is sampled, however long the trajectory is.
///
/// The size is that after compression. The bytes per sample and per node were fitted to the files
/// of 61 programs at 50, 250 and 1000 Hz, with one to seven joints in motion, at 1 to 100 % of
/// their speed, with blends, stops and waits: the estimate was 0.92 to 1.10 times the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanSize {
    rate_hz: f64,
    moving_s: f64,
    /// Moving time, times the number of moving joints.
    turning_s: f64,
    resting_s: f64,
    /// Moving time with a tool.
    with_tool_s: f64,
    /// Number of nodes, times the number of moving joints.
    turning_nodes: f64,
}

/// Bytes per sample on `/joint_states`, `/tf` and `/tcp_pose` in motion: constant part, and part
/// per moving joint. A sample is 1.3 kB before compression. Of these, 56 bytes are the seven
/// torques, which all change if any joint moves.
const MOVING_SAMPLE: [f64; 2] = [268.0, 53.6];

/// Additional bytes per sample on `/flange_pose` in motion, if the program has a tool.
const FLANGE_SAMPLE: f64 = 151.0;

/// Bytes per sample at standstill: only the stamps change.
const RESTING_SAMPLE: f64 = 198.0;

/// Bytes per node on `/joint_trajectory`, for each moving joint.
const TURNING_NODE: f64 = 28.4;

/// Bytes of the content that is written once: schemas, the URDF, the index.
const ONCE: f64 = 29_100.0;

/// A joint that turns by less along a segment counts as at rest.
const NO_MOTION_RAD: f64 = 1e-9;

impl PlanSize {
    /// Starts the estimate of a file without sections, with `rate_hz` joint states per second.
    #[must_use]
    pub fn new(rate_hz: f64) -> Self {
        Self {
            rate_hz,
            moving_s: 0.0,
            turning_s: 0.0,
            resting_s: 0.0,
            with_tool_s: 0.0,
            turning_nodes: 0.0,
        }
    }

    /// Estimates the file of a whole trajectory.
    #[must_use]
    pub fn of(trajectory: &Trajectory, rate_hz: f64) -> Self {
        let mut size = Self::new(rate_hz);
        trajectory.sections().iter().for_each(|section| size.add(section));
        size
    }

    /// Adds the next section of the trajectory.
    pub fn add(&mut self, section: &Section) {
        for piece in section.pieces() {
            let Some(segment) = section.segment(piece) else {
                self.resting_s += piece.duration_s;
                continue;
            };
            let [from, to] = [0.0, 1.0].map(|s| segment.at(s).dq);
            let turns = |(from, to): &(f64, f64)| from.abs().max(to.abs()) > NO_MOTION_RAD;
            let turning = zip(from, to).filter(turns).count() as f64;
            self.moving_s += piece.duration_s;
            if section.path().has_tools() {
                self.with_tool_s += piece.duration_s;
            }
            self.turning_s += turning * piece.duration_s;
            self.turning_nodes += turning * section.nodes(piece).len() as f64;
        }
    }

    /// Duration of the trajectory, in s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.moving_s + self.resting_s
    }

    /// Number of joint states in the file.
    #[must_use]
    pub fn samples(&self) -> u64 {
        count(self.rate_hz * self.duration_s() + 1.0)
    }

    /// Bytes of the file, without its attachments.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let [each, more] = MOVING_SAMPLE;
        let samples = each * self.moving_s
            + more * self.turning_s
            + FLANGE_SAMPLE * self.with_tool_s
            + RESTING_SAMPLE * self.resting_s;
        count(ONCE + self.rate_hz * samples + TURNING_NODE * self.turning_nodes)
    }
}

/// Rounds up to an integer; saturates if the value is too large.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it saturates")]
fn count(value: f64) -> u64 {
    value.ceil() as u64
}
