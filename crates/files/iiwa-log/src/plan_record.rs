//! Plan read back from the file of a [`PlanWriter`](crate::PlanWriter).

use std::collections::BTreeMap;
use std::io::Read;

use iiwa_kin::{Joints, Robot};
use iiwa_plan::PlanFigures;
use iiwa_traj::PieceKind;
use serde::{Serialize, Serializer};
use serde_json::Value;

use crate::recorded_robot::{PROFILE, RecordedRobotError, recorded_robot};
use crate::{Entry, ReadError, Reader, Topic};

/// Plan: its figures, trajectory nodes, path pieces, program and robot.
///
/// [`read`](Self::read) accepts complete plans only. [`read_part`](Self::read_part) also accepts
/// files that are cut off, and recordings, which have no nodes and no pieces.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct PlanRecord {
    /// The nodes of the trajectory, in the order of time.
    pub nodes: Vec<PlanNode>,
    /// Path pieces: lines, TCP paths, blends, settle times and waits, in the order of time.
    pub pieces: Vec<PlanPiece>,
    /// Program, JSON.
    pub program: Option<String>,
    /// Unknown piece kind found in the file.
    unknown_kind: Option<String>,
    metadata: BTreeMap<String, String>,
    profile: Option<String>,
}

/// Node of a trajectory.
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

/// Path piece of a plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanPiece {
    /// Number of the motion in the program, from 1.
    pub motion: u32,
    /// Kind of piece.
    #[serde(serialize_with = "name")]
    pub kind: PieceKind,
    /// Start time, in s.
    pub start_s: f64,
    /// End time, in s.
    pub end_s: f64,
    /// Joint of the active limit, 1 to 7; `None` if the active limit is a TCP limit.
    pub joint: Option<u8>,
    /// Active limit: `velocity`, `acceleration` or `jerk`, with the prefix `cart_` or
    /// `orientation_` for TCP limits; `torque`, `minimum_duration`, `t1_velocity`, or another name;
    /// empty at standstill.
    pub limit: String,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn name<S: Serializer>(kind: &PieceKind, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(kind.name())
}

/// Reason why a file is not a complete plan.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlanRecordError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The file lacks a part of a plan.
    #[error("not a plan: the file has no {part}")]
    Missing {
        /// Missing part.
        part: &'static str,
    },
    /// The parts are inconsistent, or contain values that no plan has.
    #[error("the plan is damaged: {message}")]
    Damaged {
        /// Inconsistency found.
        message: String,
    },
    /// The robot is unknown.
    #[error(transparent)]
    Robot(#[from] RecordedRobotError),
}

impl PlanRecord {
    /// Reads a complete plan.
    ///
    /// # Errors
    ///
    /// [`PlanRecordError::Read`] if the file is cut off or damaged, [`PlanRecordError::Missing`]
    /// and [`PlanRecordError::Damaged`] if its nodes and pieces are not those of a plan.
    pub fn read<R: Read>(stream: R) -> Result<Self, PlanRecordError> {
        match Self::read_part(stream) {
            (_, Some(error)) => Err(error.into()),
            (record, None) => record.check().map(|()| record),
        }
    }

    /// Reads the part of a plan before the first error in the file; returns that error as well.
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
                // Each further part of a long trajectory begins with the last point of the part
                // before.
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

    /// Checks that the plan is complete.
    ///
    /// # Errors
    ///
    /// [`PlanRecordError::Missing`] and [`PlanRecordError::Damaged`] if the nodes and pieces are
    /// not those of a plan.
    pub fn check(&self) -> Result<(), PlanRecordError> {
        if self.nodes.len() < 2 {
            return Err(PlanRecordError::Missing { part: "/joint_trajectory" });
        }
        let damaged = |message: String| Err(PlanRecordError::Damaged { message });
        let finite = |q: &Joints| q.iter().all(|v| v.is_finite());
        for PlanNode { t_s, q, dq, ddq } in &self.nodes {
            if !finite(q) || !finite(dq) || !finite(ddq) {
                return damaged(format!("a value that is not finite at {t_s:.3} s"));
            }
        }
        self.check_times()?;
        if let Some(kind) = &self.unknown_kind {
            return damaged(format!("a piece of the unknown kind `{kind}`"));
        }
        if self.pieces.is_empty() {
            return Err(PlanRecordError::Missing { part: "/motion" });
        }
        let ordered = |piece: &PlanPiece| piece.start_s.is_finite() && piece.end_s >= piece.start_s;
        if !self.pieces.iter().all(ordered) {
            return damaged("its pieces are not in the order of time".to_owned());
        }
        Ok(())
    }

    /// Checks that the times of the nodes increase, which damage to a file can change.
    ///
    /// # Errors
    ///
    /// [`PlanRecordError::Damaged`] if a time does not increase.
    pub fn check_times(&self) -> Result<(), PlanRecordError> {
        let disorder = self.nodes.windows(2).find(|pair| pair[1].t_s <= pair[0].t_s);
        disorder.map_or(Ok(()), |pair| {
            let message = format!("time does not increase after {:.3} s", pair[0].t_s);
            Err(PlanRecordError::Damaged { message })
        })
    }

    /// Figures of the plan; `None` if the file lacks them.
    #[must_use]
    pub fn figures(&self) -> Option<PlanFigures> {
        serde_json::from_value(self.to_json()).ok()
    }

    /// All entries of the metadata record `iiwasim` as a JSON object: the figures, if the file is a
    /// plan.
    #[must_use]
    pub fn to_json(&self) -> Value {
        // An entry that is valid JSON is parsed, any other entry is a text.
        let value = |text: &String| {
            serde_json::from_str(text).unwrap_or_else(|_| Value::String(text.clone()))
        };
        let entries = self.metadata.iter();
        Value::Object(entries.map(|(key, text)| (key.clone(), value(text))).collect())
    }

    /// Time parameterisation of the plan: `acceleration` or `jerk`.
    #[must_use]
    pub fn timing(&self) -> Option<&str> {
        self.metadata.get("timing").map(String::as_str)
    }

    /// Robot of the plan, with its own limits; `None` if the file contains neither name nor
    /// profile.
    ///
    /// # Errors
    ///
    /// [`RecordedRobotError`] if the file names a robot that is not built in and lacks its profile,
    /// or its profile cannot be read.
    pub fn robot(&self) -> Result<Option<Robot>, RecordedRobotError> {
        recorded_robot(self.metadata.get("robot").map(String::as_str), self.profile.as_deref())
    }
}
