//! Tools and frames on the page.

use iiwa_kin::{Joints, Pose, Robot};
use iiwa_log::PlanPiece;
use iiwa_program::Program;
use serde::Serialize;

use super::curve::{CurveColumns, TimeSeries};

/// Maximum number of frames shown: more would hide each other.
const FRAMES: usize = 500;

/// Tools and frames of a program.
#[derive(Debug, Default, Serialize)]
pub(crate) struct PageWorkcell {
    /// TCPs in the flange frame, each from a motion on, up to the next.
    tcps: Vec<Tcp>,
    frames: Vec<ShownFrame>,
    /// TCP of each motion, in the flange frame.
    #[serde(skip)]
    poses: Vec<Pose>,
}

#[derive(Debug, Serialize)]
struct Tcp {
    /// Number of the first motion, from 1.
    motion: usize,
    offset_m: [f64; 3],
    /// Rotation matrix, row-major.
    rotation: [[f64; 3]; 3],
}

#[derive(Debug, Serialize)]
struct ShownFrame {
    name: Option<String>,
    position_m: [f64; 3],
    /// Rotation matrix, row-major.
    rotation: [[f64; 3]; 3],
}

impl PageWorkcell {
    /// Collects tools and frames of a program; empty if the program has neither, or refers to
    /// missing ones.
    pub(crate) fn new(program: Option<&Program>) -> Self {
        let Some(program) = program.filter(|it| it.has_frames() || !it.workcell.is_empty()) else {
            return Self::default();
        };
        let (Ok(poses), Ok(frames)) = (program.tcps(), program.placed_frames()) else {
            return Self::default();
        };
        let mut tcps: Vec<Tcp> = Vec::new();
        for (index, pose) in poses.iter().enumerate() {
            let Pose { position_m: offset_m, rotation } = *pose;
            let is_same = |last: &Tcp| last.offset_m == offset_m && last.rotation == rotation;
            if !tcps.last().is_some_and(is_same) {
                tcps.push(Tcp { motion: index + 1, offset_m, rotation });
            }
        }
        if poses.iter().all(|pose| *pose == Pose::IDENTITY) {
            tcps.clear();
        }
        let shown = frames.into_iter().take(FRAMES).map(|frame| ShownFrame {
            name: frame.name,
            position_m: frame.pose.position_m,
            rotation: frame.pose.rotation,
        });
        Self { tcps, frames: shown.collect(), poses }
    }

    /// Computes speeds in m/s over time: of the flange, and, with a tool, of the TCP that `pieces`
    /// determine at that time. States are times, positions and velocities of the joints, in the
    /// order of time; all times are shifted by `shift_s` in the curve.
    pub(crate) fn speeds<'a>(
        &self,
        robot: &Robot,
        pieces: &[PlanPiece],
        states: impl ExactSizeIterator<Item = (f64, Joints, &'a Joints)>,
        shift_s: f64,
    ) -> CurveColumns {
        let flange = |q: &Joints, dq: &Joints| robot.tcp_speed_m_s(&Pose::IDENTITY, q, dq);
        if self.tcps.is_empty() {
            let mut samples = TimeSeries::<1>::with_capacity(states.len());
            for (t_s, q, dq) in states {
                samples.push(t_s, [flange(&q, dq)]);
            }
            return CurveColumns::new(&samples, shift_s);
        }
        let mut samples = TimeSeries::<2>::with_capacity(states.len());
        let mut piece = 0;
        for (t_s, q, dq) in states {
            while pieces.get(piece + 1).is_some_and(|next| next.start_s <= t_s + shift_s) {
                piece += 1;
            }
            let motion = pieces.get(piece).map_or(0, |piece| piece.motion as usize);
            let tcp = self.poses.get(motion.saturating_sub(1)).unwrap_or(&Pose::IDENTITY);
            samples.push(t_s, [flange(&q, dq), robot.tcp_speed_m_s(tcp, &q, dq)]);
        }
        CurveColumns::new(&samples, shift_s)
    }
}
