//! How large the file of a plan becomes, before it is written.

use std::iter::zip;

use iiwa_traj::{Section, Trajectory};

/// An estimate of the file that [`PlanWriter`](crate::PlanWriter) makes of a trajectory, from its duration
/// and its nodes: nothing is sampled for it, however long the trajectory takes.
///
/// The bytes are those in the file, after compression with [`Compression::Fast`](crate::Compression::Fast).
/// What a sample and a node take was fitted to the files of 28 programs at 50, 250 and 1000 Hz, with one to
/// seven joints in motion, at 0.5 to 100 % of their speed, with blends, stops and waits: the estimate was 0.90
/// to 1.11 times the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanSize {
    rate_hz: f64,
    moving_s: f64,
    /// The same, times the number of joints that move.
    turning_s: f64,
    resting_s: f64,
    /// The part of the moving time in which there is a tool.
    with_tool_s: f64,
    /// Nodes, times the number of joints that move.
    turning_nodes: f64,
}

/// Bytes of a sample on `/joint_states`, `/tf` and `/tcp_pose` while the arm moves, and more of it for each
/// joint that does. Before compression it is 1.3 kB. Of these, 56 are seven torques: they change where any joint does.
const MOVING_SAMPLE: [f64; 2] = [177.0, 58.0];

/// More of a sample on `/flange_pose` while the arm moves, where the program has a tool.
const FLANGE_SAMPLE: f64 = 70.0;

/// Of one while the arm stands: only the stamps differ from those before.
const RESTING_SAMPLE: f64 = 122.0;

/// Of a node on `/joint_trajectory`, for each joint that moves.
const TURNING_NODE: f64 = 28.3;

/// Of all that is in the file once: schemas, the URDF, the index.
const ONCE: f64 = 29_000.0;

/// A joint that turns by less along a segment stands.
const NO_MOTION_RAD: f64 = 1e-9;

impl PlanSize {
    /// Of a file without any section yet, with `rate_hz` joint states a second.
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

    /// Of a whole trajectory.
    #[must_use]
    pub fn of(trajectory: &Trajectory, rate_hz: f64) -> Self {
        let mut size = Self::new(rate_hz);
        trajectory.sections().iter().for_each(|section| size.add(section));
        size
    }

    /// Takes in the next section of the trajectory.
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

    /// How long the trajectory takes, in s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.moving_s + self.resting_s
    }

    /// Joint states in the file.
    #[must_use]
    pub fn samples(&self) -> u64 {
        count(self.rate_hz * self.duration_s() + 1.0)
    }

    /// Bytes of the file, without those of its attachments.
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

/// A count as an integer; what is too large for one is as large as that can be.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it saturates")]
fn count(value: f64) -> u64 {
    value.ceil() as u64
}
