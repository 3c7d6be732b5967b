//! Figures of a motion to a frame: TCP speed and distance from singularities.

use iiwa_kin::{SingularPart, Status};

use crate::section::{Piece, Section};

/// Samples per interval between two nodes of a trajectory. Nodes are dense where the path bends, so
/// that the speed hardly has a peak in between.
const SAMPLES: u32 = 4;

/// Figures of a motion whose target is a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CartesianFigures {
    /// Top TCP speed, in m/s.
    pub tcp_speed_peak_m_s: f64,
    /// Point at which the robot is nearest to a singularity.
    pub nearest_singularity: NearestSingularity,
    /// Status at the end.
    pub status: Status,
    /// E1, the position of A3, at the start and at the end, in rad.
    pub e1_rad: [f64; 2],
}

/// Point at which the robot is nearest to a singularity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestSingularity {
    /// Distance measure: 0 in the singularity, 1 at most; see
    /// [`Singularity`](iiwa_kin::Singularity).
    pub distance: f64,
    /// Time, in s from the start of the program.
    pub at_s: f64,
    /// Kind of singularity.
    pub part: SingularPart,
}

impl Section {
    /// Returns the figures of consecutive pieces, one motion of this section; none without motion.
    pub(crate) fn cartesian_figures(&self, pieces: &[Piece]) -> Option<CartesianFigures> {
        let robot = self.path.robot();
        let mut moving = pieces.iter().filter(|piece| piece.kind.moves()).peekable();
        let start = self.at(moving.peek()?.start_s);
        let mut end = start;
        let (distance, part) = robot.singularity(&start.q).nearest();
        let mut nearest = NearestSingularity { distance, at_s: start.t_s, part };
        let mut peak_m_s = 0.0_f64;
        for piece in moving {
            let tcp = self.path.tcp(piece.motion);
            for state in self.samples_of(piece, SAMPLES) {
                peak_m_s = peak_m_s.max(robot.tcp_speed_m_s(tcp, &state.q, &state.dq));
                let (distance, part) = robot.singularity(&state.q).nearest();
                if distance < nearest.distance {
                    nearest = NearestSingularity { distance, at_s: state.t_s, part };
                }
                end = state;
            }
        }
        Some(CartesianFigures {
            tcp_speed_peak_m_s: peak_m_s,
            nearest_singularity: nearest,
            status: Status::of(robot, &end.q),
            e1_rad: [start.q[2], end.q[2]],
        })
    }
}
