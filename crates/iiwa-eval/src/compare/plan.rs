//! The plan that a recording is held against.

use std::collections::BTreeMap;
use std::io::Read;

use iiwa_kin::{Joints, Robot};
use iiwa_log::{Entry, ReadError, Reader, Topic};
use iiwa_traj::Trajectory;

use super::curve::{Curve, Knot};

/// A planned trajectory: where the arm is to be, when, and for which motion of the program.
#[derive(Clone, Debug)]
pub struct Plan {
    robot: Robot,
    pub(crate) curve: Curve,
    pub(crate) pieces: Vec<Piece>,
}

/// A line, a blend or a rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Piece {
    /// The motion, from 1.
    pub(crate) motion: usize,
    pub(crate) kind: PieceKind,
    pub(crate) start_s: f64,
    pub(crate) end_s: f64,
}

/// What the arm does in a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PieceKind {
    Moves,
    Settles,
    Waits,
}

impl PieceKind {
    fn from_name(name: &str) -> Option<Self> {
        match name {
            "line" | "blend" => Some(Self::Moves),
            "settle" => Some(Self::Settles),
            "wait" => Some(Self::Waits),
            _ => None,
        }
    }

    fn moves(self) -> bool {
        self == Self::Moves
    }
}

/// A part of a plan from one stop to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leg {
    pub(crate) start_s: f64,
    pub(crate) end_s: f64,
}

/// Why a file is no plan.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlanFileError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A part of a plan is not in the file.
    #[error("it has no {what}: it is not a plan as `iiwasim plan` writes it")]
    Missing {
        /// What is missing.
        what: &'static str,
    },
    /// The parts do not fit together, or hold numbers that no plan has.
    #[error("its trajectory is damaged: {what}")]
    Damaged {
        /// What is wrong.
        what: String,
    },
    /// The robot is not a built-in one, and none was given.
    #[error("it is a plan for the robot `{name}`, which is not built in: its profile is needed")]
    UnknownRobot {
        /// The robot's name in the file.
        name: String,
    },
}

impl Plan {
    /// A plan that was just made.
    #[must_use]
    pub fn from_trajectory(trajectory: &Trajectory) -> Self {
        let mut knots: Vec<Knot> = Vec::new();
        for state in trajectory.states() {
            let knot = Knot { t_s: state.t_s, q: state.q, dq: state.dq, ddq: state.ddq };
            if knots.last().is_none_or(|last| knot.t_s > last.t_s) {
                knots.push(knot);
            }
        }
        let pieces = trajectory.sections().iter().flat_map(iiwa_traj::Section::pieces);
        let pieces = pieces
            .filter(|piece| piece.end_s > piece.start_s)
            .filter_map(|piece| {
                Some(Piece {
                    motion: piece.motion + 1,
                    kind: PieceKind::from_name(piece.kind.name())?,
                    start_s: piece.start_s,
                    end_s: piece.end_s,
                })
            })
            .collect();
        Self::of(trajectory.path().robot().clone(), knots, pieces)
    }

    /// Reads a plan from an MCAP file as [`PlanWriter`](iiwa_log::PlanWriter) writes it. The robot is the
    /// built-in one that the file names, unless `robot` is another one.
    ///
    /// # Errors
    ///
    /// [`PlanFileError`] if the file is damaged or no plan, or its robot is unknown.
    pub fn read_mcap<R: Read>(stream: R, robot: Option<Robot>) -> Result<Self, PlanFileError> {
        let mut knots: Vec<Knot> = Vec::new();
        let mut starts: Vec<(f64, usize, PieceKind)> = Vec::new();
        let mut metadata = BTreeMap::new();
        let topics = [Topic::JointTrajectory, Topic::Motion];
        for entry in Reader::new(stream).only(&topics) {
            match entry? {
                Entry::Trajectory { t_s, points } => {
                    // A part of a long trajectory begins with the last point of the part before.
                    let last = knots.last().map_or(f64::NEG_INFINITY, |last| last.t_s);
                    let points = points.into_iter().map(|point| Knot {
                        t_s: t_s + point.time_from_start.as_secs_f64(),
                        q: point.positions,
                        dq: point.velocities,
                        ddq: point.accelerations,
                    });
                    knots.extend(points.filter(|knot| knot.t_s > last + 1e-10));
                }
                Entry::Motion(sample) => {
                    let name = &sample.motion.kind;
                    let kind = PieceKind::from_name(name).ok_or_else(|| {
                        let what = format!("a piece of the unknown kind `{name}`");
                        PlanFileError::Damaged { what }
                    })?;
                    starts.push((sample.t_s, sample.motion.index as usize, kind));
                }
                Entry::Metadata { name, entries } if name == "iiwasim" => metadata.extend(entries),
                _ => {}
            }
        }
        let Some(end_s) = knots.last().map(|last| last.t_s).filter(|_| knots.len() > 1) else {
            return Err(PlanFileError::Missing { what: "/joint_trajectory" });
        };
        check(&knots)?;
        if starts.is_empty() {
            return Err(PlanFileError::Missing { what: "/motion" });
        }
        let robot = match (robot, metadata.get("robot")) {
            (Some(robot), _) => robot,
            (None, None) => return Err(PlanFileError::Missing { what: "robot's name" }),
            (None, Some(name)) => Robot::built_in(name)
                .ok_or_else(|| PlanFileError::UnknownRobot { name: name.clone() })?,
        };
        let ends = starts.iter().skip(1).map(|next| next.0).chain([end_s]);
        let pieces: Vec<_> = starts
            .iter()
            .zip(ends)
            .map(|(&(start_s, motion, kind), end_s)| Piece { motion, kind, start_s, end_s })
            .collect();
        if pieces.iter().any(|piece| !piece.start_s.is_finite() || piece.end_s < piece.start_s) {
            let what = "its pieces are not in the order of time".to_owned();
            return Err(PlanFileError::Damaged { what });
        }
        Ok(Self::of(robot, knots, pieces))
    }

    fn of(robot: Robot, mut knots: Vec<Knot>, pieces: Vec<Piece>) -> Self {
        // A program without motions has a single state.
        if knots.is_empty() {
            knots.push(Knot { t_s: 0.0, q: [0.0; 7], dq: [0.0; 7], ddq: [0.0; 7] });
        }
        if let [only] = knots[..] {
            knots.push(Knot { t_s: only.t_s + 1e-9, ..only });
        }
        // With limits on jerk, the arm leaves its stops without acceleration.
        let leaves = |pair: &&[Knot]| pair[0].dq == [0.0; 7] && pair[1].dq != [0.0; 7];
        let smooth = knots
            .windows(2)
            .filter(leaves)
            .all(|pair| pair[0].ddq.iter().all(|ddq| ddq.abs() <= 1e-6));
        Self { robot, curve: Curve::new(knots, smooth), pieces }
    }

    /// The robot it is for.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// From the start to the end of the last settling, in s.
    #[must_use]
    pub fn cycle_time_s(&self) -> f64 {
        self.curve.knots()[self.curve.knots().len() - 1].t_s
    }

    /// Where the arm is to be at `t_s`, in rad.
    #[must_use]
    pub fn at(&self, t_s: f64) -> Joints {
        self.curve.at(t_s).0
    }

    /// The motion at `t_s`, from 1.
    #[must_use]
    pub fn motion_at(&self, t_s: f64) -> usize {
        let next = self.pieces.partition_point(|piece| piece.end_s <= t_s);
        self.pieces.get(next).or(self.pieces.last()).map_or(1, |piece| piece.motion)
    }

    /// The parts from stop to stop, in order.
    pub(crate) fn legs(&self) -> Vec<Leg> {
        self.pieces
            .chunk_by(|a, b| a.kind.moves() == b.kind.moves())
            .filter(|pieces| pieces[0].kind.moves())
            .map(|pieces| Leg { start_s: pieces[0].start_s, end_s: pieces[pieces.len() - 1].end_s })
            .collect()
    }
}

/// Whether these are nodes of a trajectory.
fn check(knots: &[Knot]) -> Result<(), PlanFileError> {
    let finite = |q: &Joints| q.iter().all(|v| v.is_finite());
    for knot in knots {
        if !finite(&knot.q) || !finite(&knot.dq) || !finite(&knot.ddq) {
            let what = format!("a number that is none at {:.3} s", knot.t_s);
            return Err(PlanFileError::Damaged { what });
        }
    }
    match knots.windows(2).find(|pair| pair[1].t_s <= pair[0].t_s) {
        Some(pair) => {
            let what = format!("time does not go on after {:.3} s", pair[0].t_s);
            Err(PlanFileError::Damaged { what })
        }
        None => Ok(()),
    }
}
