//! Figures of a trajectory: duration and active limits of each motion; for motions to frames also
//! TCP speed and distance from singularities.

use iiwa_kin::{Joints, SingularPart, Status};
use iiwa_path::{ShortenedBlend, Step};
use iiwa_program::{IoEntry, MotionIndex, MotionType};

use crate::{
    limit::{Limit, LimitShare},
    limit_usage::LimitUsage,
    section::{Piece, PieceKind, Section},
};

/// Total times by kind of piece.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Time in motion, in s.
    pub motion_time_s: f64,
    /// Time at rest until settled, in s.
    pub settle_time_s: f64,
    /// Waiting time, in s.
    pub wait_time_s: f64,
}

impl Totals {
    /// Returns the total time, in s.
    #[must_use]
    pub fn cycle_time_s(&self) -> f64 {
        self.motion_time_s + self.settle_time_s + self.wait_time_s
    }

    /// Adds the times of a section.
    pub fn add(&mut self, section: &Section) {
        for piece in section.pieces() {
            let time_s = match piece.kind {
                PieceKind::Settle => &mut self.settle_time_s,
                PieceKind::Wait => &mut self.wait_time_s,
                PieceKind::Line
                | PieceKind::Lin
                | PieceKind::Circ
                | PieceKind::Spline
                | PieceKind::Blend => &mut self.motion_time_s,
            };
            *time_s += piece.duration_s;
        }
    }
}

/// Figures of one entry of the program's list of motions.
///
/// A motion lasts as long as its limits apply: from the start of the blend into it to the start of
/// the blend out of it, or to its stop, without the settle time after the stop. A motion without
/// duration, such as a wait of 0 s, has no figures.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionFigures {
    /// Index in the program.
    pub motion: MotionIndex,
    /// Type of the motion.
    pub kind: MotionType,
    /// Start time, in s.
    pub start_s: f64,
    /// End time, in s.
    pub end_s: f64,
    /// Top speed: the largest share of a joint's velocity limit (the robot's limit, not the
    /// motion's).
    pub peak_velocity_rel: f64,
    /// Limit that is active for the longest time or, if none is active, the one with the largest
    /// ratio of value to limit; `None` without motion.
    pub limited_by: Option<Limit>,
    /// All active limits, the longest active first.
    pub limits: Vec<LimitShare>,
    /// TCP figures, if the motion's target is a frame or the program has a tool.
    pub cartesian: Option<CartesianFigures>,
}

/// Samples per interval between two nodes of a trajectory. Nodes are dense where the path bends, so
/// that the speed hardly has a peak in between.
const TCP_SAMPLES: u32 = 4;

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

/// Figures of one blend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlendFigures {
    /// Motion whose target is blended away.
    pub motion: MotionIndex,
    /// Angle of the corner, in degrees: 0 straight on, 180 turned back.
    pub gamma_deg: f64,
    /// Start, in rad.
    pub start_rad: Joints,
    /// Middle, at s = 1/2, in rad.
    pub mid_rad: Joints,
    /// End, in rad.
    pub end_rad: Joints,
    /// Position of the flange centre in the middle, in m.
    pub mid_tcp_m: [f64; 3],
    /// Start time, in s.
    pub start_s: f64,
    /// End time, in s.
    pub end_s: f64,
    /// Difference from the radius in the program, if the blend is smaller.
    pub shortened: Option<ShortenedBlend>,
}

impl Section {
    /// Returns the figures of the motions of this section, in order.
    #[must_use]
    pub fn motions(&self) -> Vec<MotionFigures> {
        self.pieces
            .chunk_by(|a, b| a.motion == b.motion)
            .map(|pieces| {
                let mut usage = LimitUsage::default();
                let mut peak_velocity_rel = 0.0_f64;
                let mut moving_s = 0.0;
                for piece in pieces {
                    if piece.kind.moves() {
                        moving_s += piece.duration_s;
                    }
                    usage.merge(&piece.usage);
                    peak_velocity_rel = peak_velocity_rel.max(piece.peak_velocity_rel);
                }
                let (first, last) = (&pieces[0], &pieces[pieces.len() - 1]);
                let motion_type = match first.kind {
                    PieceKind::Wait => {
                        self.path.io(first.motion).map_or(MotionType::Wait, IoEntry::motion_type)
                    }
                    // A program without tools and frames has PTP motions only.
                    _ => self.path.motion_type(first.motion).unwrap_or_default(),
                };
                let settles = last.kind == PieceKind::Settle;
                MotionFigures {
                    motion: first.motion,
                    kind: motion_type,
                    start_s: first.start_s,
                    end_s: if settles { last.start_s } else { last.end_s },
                    peak_velocity_rel,
                    limited_by: first.kind.moves().then(|| usage.limit()),
                    limits: usage.shares(moving_s),
                    cartesian: (motion_type.is_cartesian() || self.path.has_tools())
                        .then(|| self.cartesian_figures(pieces))
                        .flatten(),
                }
            })
            .collect()
    }

    /// Returns the figures of consecutive pieces, one motion of this section; none without motion.
    fn cartesian_figures(&self, pieces: &[Piece]) -> Option<CartesianFigures> {
        let robot = self.path.robot();
        let mut moving = pieces.iter().filter(|piece| piece.kind.moves()).peekable();
        let start = self.at(moving.peek()?.start_s);
        let mut end = start;
        let (distance, part) = robot.singularity(&start.q).nearest();
        let mut nearest = NearestSingularity { distance, at_s: start.t_s, part };
        let mut peak_m_s = 0.0_f64;
        for piece in moving {
            let tcp = self.path.tcp(piece.motion);
            for state in self.samples_of(piece, TCP_SAMPLES) {
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

    /// Returns the figures of the blends of this section, in order.
    #[must_use]
    pub fn blends(&self) -> Vec<BlendFigures> {
        self.pieces
            .iter()
            .filter(|piece| piece.kind == PieceKind::Blend)
            .filter_map(|piece| match &self.path.steps()[piece.step] {
                Step::Move { segment, blend: Some(corner), .. } => {
                    let mid_rad = segment.at(0.5).q;
                    Some(BlendFigures {
                        motion: corner.motion,
                        gamma_deg: corner.gamma_deg,
                        start_rad: segment.at(0.0).q,
                        mid_rad,
                        end_rad: segment.at(1.0).q,
                        mid_tcp_m: self.path.robot().flange_position(&mid_rad),
                        start_s: piece.start_s,
                        end_s: piece.end_s,
                        shortened: corner.shortened,
                    })
                }
                _ => None,
            })
            .collect()
    }
}
