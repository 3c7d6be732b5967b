//! The figures of a motion to a frame: how fast its TCP goes, and how near the arm comes to a singularity.

use iiwa_kin::{SingularPart, Status};

use crate::section::{Piece, Section};

/// Samples between two nodes of a trajectory. Nodes are close where the path bends: between them speed hardly has room
/// for a peak of its own.
const SAMPLES: u32 = 4;

/// The figures of a motion whose target is a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CartesianFigures {
    /// Top speed of its TCP, in m/s.
    pub tcp_speed_peak_m_s: f64,
    /// Where the arm is nearest to a singularity.
    pub nearest_singularity: NearestSingularity,
    /// The status at its end.
    pub status: Status,
    /// E1, the position of A3, at its start and at its end, in rad.
    pub e1_rad: [f64; 2],
}

/// Where the arm is nearest to a singularity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestSingularity {
    /// How near: 0 in the singularity, 1 at most; see [`Singularity`](iiwa_kin::Singularity).
    pub least: f64,
    /// When, in s from the start of the program.
    pub at_s: f64,
    /// Which singularity it is.
    pub part: SingularPart,
}

impl Section {
    /// The figures of some pieces in a row, one motion of this section; none if nothing moves.
    pub(crate) fn cartesian_figures(&self, pieces: &[Piece]) -> Option<CartesianFigures> {
        let robot = self.path.robot();
        let mut moving = pieces.iter().filter(|piece| piece.kind.moves()).peekable();
        let start = self.at(moving.peek()?.start_s);
        let mut end = start;
        let (least, part) = robot.singularity(&start.q).least();
        let mut nearest = NearestSingularity { least, at_s: start.t_s, part };
        let mut peak_m_s = 0.0_f64;
        for piece in moving {
            let tcp = self.path.tcp(piece.motion);
            for state in self.samples_of(piece, SAMPLES) {
                peak_m_s = peak_m_s.max(robot.tcp_speed_m_s(tcp, &state.q, &state.dq));
                let (least, part) = robot.singularity(&state.q).least();
                if least < nearest.least {
                    nearest = NearestSingularity { least, at_s: state.t_s, part };
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
