//! A plan, read back from the file that [`PlanWriter`](crate::PlanWriter) made of it.

use std::collections::BTreeMap;
use std::io::Read;

use iiwa_kin::{Joints, Robot};
use iiwa_plan::PlanFigures;
use iiwa_traj::PieceKind;
use serde::{Serialize, Serializer};
use serde_json::Value;

use crate::plan_metadata::to_json;
use crate::recorded_robot::{PROFILE, RecordedRobotError, recorded_robot};
use crate::{Entry, ReadError, Reader, Topic};

/// A plan: its figures, the nodes of its trajectory, the pieces of its path, its program and its robot.
///
/// [`read`](Self::read) takes whole plans only. [`read_part`](Self::read_part) also takes what is left of a
/// file that is cut off, and recordings, which have no nodes and no pieces.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct PlanRecord {
    /// The nodes of the trajectory, in the order of time.
    pub nodes: Vec<PlanNode>,
    /// Lines, paths of the TCP, blends, settles and waits, in the order of time.
    pub pieces: Vec<PlanPiece>,
    /// The program, JSON.
    pub program: Option<String>,
    /// A kind of pieces that is not known here.
    unknown_kind: Option<String>,
    metadata: BTreeMap<String, String>,
    profile: Option<String>,
}

/// A node of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanNode {
    /// Time since the start of the plan, in s.
    pub t_s: f64,
    /// Joint positions, in rad.
    pub q: Joints,
    /// Joint velocities, in rad/s.
    pub dq: Joints,
    /// Joint accelerations, in rad/s^2.
    pub ddq: Joints,
}

/// A piece of the path of a plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanPiece {
    /// The motion of the program, from 1.
    pub motion: u32,
    /// What the arm does.
    #[serde(serialize_with = "name")]
    pub kind: PieceKind,
    /// When it starts, in s.
    pub start_s: f64,
    /// When it ends, in s.
    pub end_s: f64,
    /// The joint whose limit binds, 1 to 7; none if it is one of the TCP.
    pub joint: Option<u8>,
    /// Which of its limits: `velocity`, `acceleration` or `jerk`, after `cart_` or `orientation_` if it is one of the
    /// TCP; empty where nothing moves.
    pub limit: String,
}

fn name<S: Serializer>(kind: &PieceKind, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(kind.name())
}

/// Why a file is not a whole plan.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlanRecordError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A part of a plan is not in the file.
    #[error("not a plan: the file has no {what}")]
    Missing {
        /// What is missing.
        what: &'static str,
    },
    /// The parts do not fit together, or contain values that no plan has.
    #[error("the plan is damaged: {what}")]
    Damaged {
        /// What is wrong.
        what: String,
    },
    /// The robot is unknown.
    #[error(transparent)]
    Robot(#[from] RecordedRobotError),
}

impl PlanRecord {
    /// Reads a whole plan.
    ///
    /// # Errors
    ///
    /// [`PlanRecordError::Read`] if the file is cut off or damaged, [`PlanRecordError::Missing`] and
    /// [`PlanRecordError::Damaged`] if its nodes and pieces are not those of a plan.
    pub fn read<R: Read>(stream: R) -> Result<Self, PlanRecordError> {
        match Self::read_part(stream) {
            (_, Some(error)) => Err(error.into()),
            (record, None) => record.check().map(|()| record),
        }
    }

    /// Reads what a file has of a plan, up to where it cannot be read any more; and why not.
    pub fn read_part<R: Read>(stream: R) -> (Self, Option<ReadError>) {
        let mut record = Self::default();
        let topics = [Topic::JointTrajectory, Topic::Motion];
        let mut end = None;
        for entry in Reader::new(stream).only(&topics) {
            match entry {
                Ok(entry) => record.take(entry),
                Err(error) => end = Some(error),
            }
        }
        if let (Some(last), Some(node)) = (record.pieces.last_mut(), record.nodes.last()) {
            last.end_s = last.start_s.max(node.t_s);
        }
        (record, end)
    }

    fn take(&mut self, entry: Entry) {
        match entry {
            Entry::Trajectory { t_s, points } => {
                // A part of a long trajectory begins with the last point of the part before.
                let last_s = self.nodes.last().map_or(f64::NEG_INFINITY, |last| last.t_s);
                let nodes = points.into_iter().map(|point| PlanNode {
                    t_s: t_s + point.time_from_start.as_secs_f64(),
                    q: point.positions,
                    dq: point.velocities,
                    ddq: point.accelerations,
                });
                self.nodes.extend(nodes.filter(|node| node.t_s > last_s + 1e-10));
            }
            Entry::Motion(sample) => {
                if let Some(before) = self.pieces.last_mut() {
                    before.end_s = sample.t_s;
                }
                let Some(kind) = PieceKind::named(&sample.motion.kind) else {
                    self.unknown_kind = Some(sample.motion.kind.into_owned());
                    return;
                };
                self.pieces.push(PlanPiece {
                    motion: sample.motion.index,
                    kind,
                    start_s: sample.t_s,
                    end_s: sample.t_s,
                    joint: sample.motion.limiting_joint,
                    limit: sample.motion.limiting_kind.into_owned(),
                });
            }
            Entry::Metadata { name, entries } if name == "iiwasim" => self.metadata.extend(entries),
            Entry::Attachment(attachment) if attachment.name == PROFILE => {
                self.profile = String::from_utf8(attachment.bytes).ok();
            }
            Entry::Attachment(attachment) if attachment.name == "program.json" => {
                self.program = String::from_utf8(attachment.bytes).ok();
            }
            _ => {}
        }
    }

    /// Refuses what is not a whole plan.
    ///
    /// # Errors
    ///
    /// [`PlanRecordError::Missing`] and [`PlanRecordError::Damaged`] if the nodes and pieces are not those
    /// of a plan.
    pub fn check(&self) -> Result<(), PlanRecordError> {
        if self.nodes.len() < 2 {
            return Err(PlanRecordError::Missing { what: "/joint_trajectory" });
        }
        let damaged = |what: String| Err(PlanRecordError::Damaged { what });
        let finite = |q: &Joints| q.iter().all(|v| v.is_finite());
        for PlanNode { t_s, q, dq, ddq } in &self.nodes {
            if !finite(q) || !finite(dq) || !finite(ddq) {
                return damaged(format!("a value that is not finite at {t_s:.3} s"));
            }
        }
        if let Some(pair) = self.nodes.windows(2).find(|pair| pair[1].t_s <= pair[0].t_s) {
            return damaged(format!("time does not increase after {:.3} s", pair[0].t_s));
        }
        if let Some(kind) = &self.unknown_kind {
            return damaged(format!("a piece of the unknown kind `{kind}`"));
        }
        if self.pieces.is_empty() {
            return Err(PlanRecordError::Missing { what: "/motion" });
        }
        let ordered = |piece: &PlanPiece| piece.start_s.is_finite() && piece.end_s >= piece.start_s;
        if !self.pieces.iter().all(ordered) {
            return damaged("its pieces are not in the order of time".to_owned());
        }
        Ok(())
    }

    /// The figures; none if the file has none of a plan.
    #[must_use]
    pub fn figures(&self) -> Option<PlanFigures> {
        serde_json::from_value(self.to_json()).ok()
    }

    /// All entries of the metadata record `iiwasim` as a JSON object: of a plan, the figures.
    #[must_use]
    pub fn to_json(&self) -> Value {
        to_json(&self.metadata)
    }

    /// How the plan was timed: `acceleration` or `jerk`.
    #[must_use]
    pub fn timing(&self) -> Option<&str> {
        self.metadata.get("timing").map(String::as_str)
    }

    /// The robot that the plan was made for, with its own limits; none if the file does not tell.
    ///
    /// # Errors
    ///
    /// [`RecordedRobotError`] if the file names a robot that is not built in and has no profile of it, or
    /// its profile cannot be read.
    pub fn robot(&self) -> Result<Option<Robot>, RecordedRobotError> {
        recorded_robot(self.metadata.get("robot").map(String::as_str), self.profile.as_deref())
    }
}
