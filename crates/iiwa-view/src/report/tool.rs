//! What the page shows of tools and frames.

use iiwa_kin::{Pose, Robot};
use iiwa_log::PlanPiece;
use iiwa_program::Program;
use serde::Serialize;

use super::{
    curve::{Curve, Samples},
    planned::Planned,
};

/// Frames that are shown, at most: more of them hide each other.
const FRAMES: usize = 500;

/// Tools and frames of a program.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Workcell {
    /// The TCPs in the flange's frame: each from a motion on, up to the next.
    tcps: Vec<Tcp>,
    frames: Vec<ShownFrame>,
    /// The TCP's speed, in m/s; of plans whose program has frames.
    #[serde(skip_serializing_if = "Option::is_none")]
    speed: Option<Curve>,
    #[serde(skip)]
    poses: Vec<Pose>,
    #[serde(skip)]
    has_frames: bool,
}

#[derive(Debug, Serialize)]
struct Tcp {
    /// From 1.
    motion: usize,
    offset_m: [f64; 3],
}

#[derive(Debug, Serialize)]
struct ShownFrame {
    name: Option<String>,
    position_m: [f64; 3],
    /// Row-major.
    rotation: [[f64; 3]; 3],
}

impl Workcell {
    /// That of a program; nothing if it has neither tools nor frames, or not those that it names.
    pub(crate) fn new(program: Option<&Program>) -> Self {
        let Some(program) = program.filter(|it| it.has_frames() || !it.workcell.is_empty()) else {
            return Self::default();
        };
        let (Ok(poses), Ok(frames)) = (program.tcps(), program.placed_frames()) else {
            return Self::default();
        };
        let mut tcps: Vec<Tcp> = Vec::new();
        for (index, pose) in poses.iter().enumerate() {
            if tcps.last().is_none_or(|last| last.offset_m != pose.position_m) {
                tcps.push(Tcp { motion: index + 1, offset_m: pose.position_m });
            }
        }
        if tcps.iter().all(|tcp| tcp.offset_m == [0.0; 3]) {
            tcps.clear();
        }
        let shown = frames.into_iter().take(FRAMES).map(|frame| ShownFrame {
            name: frame.name,
            position_m: frame.pose.position_m,
            rotation: frame.pose.rotation,
        });
        Self { tcps, frames: shown.collect(), speed: None, poses, has_frames: program.has_frames() }
    }

    /// With the speed of the TCP on a plan, all times later by `shift_s`.
    pub(crate) fn with_speed(
        self,
        robot: &Robot,
        planned: &Planned,
        pieces: &[PlanPiece],
        shift_s: f64,
    ) -> Self {
        if !self.has_frames {
            return self;
        }
        let states = std::iter::zip(&planned.position.rows, &planned.velocity.rows);
        let mut samples = Samples::<1>::with_capacity(planned.position.rows.len());
        let mut piece = 0;
        for (t_s, (q, dq)) in std::iter::zip(&planned.position.t_s, states) {
            while pieces.get(piece + 1).is_some_and(|next| next.start_s <= *t_s) {
                piece += 1;
            }
            let motion = pieces.get(piece).map_or(0, |piece| piece.motion as usize);
            let tcp = self.poses.get(motion.saturating_sub(1)).unwrap_or(&Pose::IDENTITY);
            samples.push(*t_s, [robot.tcp_speed_m_s(tcp, q, dq)]);
        }
        Self { speed: Some(Curve::new(&samples, shift_s)), ..self }
    }
}
