//! Plan that a recording is compared with.

use std::{collections::BTreeMap, io::Read};

use iiwa_kin::{Dynamics, Joints, Load, Mount, Robot};
use iiwa_log::{PlanNode, PlanPiece, PlanRecord, PlanRecordError};
use iiwa_program::{IoValue, MotionIndex, MotionType, Program};
use iiwa_traj::{PieceKind, Trajectory};

use super::curve::Curve;

/// Planned trajectory: joint positions over time, and the motion of the program at each time.
#[derive(Clone, Debug)]
pub struct PlannedTrajectory {
    robot: Robot,
    pub(crate) curve: Curve,
    pub(crate) pieces: Vec<PlannedPiece>,
    types: Vec<(MotionIndex, MotionType)>,
    /// Names of motions.
    names: BTreeMap<MotionIndex, String>,
    /// Inputs and outputs, with their values.
    io: BTreeMap<MotionIndex, (String, IoValue)>,
    /// Payload during each motion, and mounting of the robot.
    loads: Vec<Option<Load>>,
    mount: Mount,
}

/// Line, blend or rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlannedPiece {
    /// Motion of the program.
    pub(crate) motion: MotionIndex,
    pub(crate) kind: PieceKind,
    pub(crate) start_s: f64,
    pub(crate) end_s: f64,
}

/// Part of a plan from one stop to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlanLeg {
    pub(crate) start_s: f64,
    pub(crate) end_s: f64,
}

impl PlannedTrajectory {
    /// Creates a plan from a trajectory.
    #[must_use]
    pub fn from_trajectory(trajectory: &Trajectory) -> Self {
        let mut knots: Vec<PlanNode> = Vec::new();
        for state in trajectory.states() {
            let knot = PlanNode { t_s: state.t_s, q: state.q, dq: state.dq, ddq: state.ddq };
            if knots.last().is_none_or(|last| knot.t_s > last.t_s) {
                knots.push(knot);
            }
        }
        let pieces = trajectory.sections().iter().flat_map(iiwa_traj::Section::pieces);
        let pieces = pieces
            .filter(|piece| piece.end_s > piece.start_s)
            .map(|piece| PlannedPiece {
                motion: piece.motion,
                kind: piece.kind,
                start_s: piece.start_s,
                end_s: piece.end_s,
            })
            .collect();
        let path = trajectory.path();
        let types = (0..path.limits().len()).map(MotionIndex::new);
        let types = types.filter_map(|motion| Some((motion, path.motion_type(motion)?)));
        let types = types.collect();
        let labels = path.sources().labels();
        let names = labels.filter_map(|(motion, label)| Some((motion, label.name.clone()?)));
        let names = names.collect();
        let io = path
            .io_entries_to(MotionIndex::new(path.limits().len()))
            .map(|(motion, entry)| (motion, (entry.io.clone(), entry.value)))
            .collect();
        let loads = (0..path.limits().len()).map(|i| path.load(MotionIndex::new(i)).copied());
        let (loads, mount) = (loads.collect(), *path.mount());
        Self { types, names, io, loads, mount, ..Self::of(path.robot().clone(), knots, pieces) }
    }

    /// Reads a plan from an MCAP file written by [`PlanWriter`](iiwa_log::PlanWriter). The robot is
    /// that of the file, unless `robot` is given.
    ///
    /// # Errors
    ///
    /// [`PlanRecordError`] if the file is damaged or not a plan, or its robot is unknown.
    pub fn read_mcap<R: Read>(stream: R, robot: Option<Robot>) -> Result<Self, PlanRecordError> {
        Self::from_record(PlanRecord::read(stream)?, robot)
    }

    /// Creates the plan of a file that was read. The robot is that of the file, unless `robot` is
    /// given.
    ///
    /// # Errors
    ///
    /// [`PlanRecordError`] if the plan is incomplete, or its robot is unknown.
    pub fn from_record(record: PlanRecord, robot: Option<Robot>) -> Result<Self, PlanRecordError> {
        record.check()?;
        let robot = match robot {
            Some(robot) => robot,
            None => {
                record.robot()?.ok_or(PlanRecordError::Missing { part: "name of the robot" })?
            }
        };
        let piece = |piece: &PlanPiece| {
            let &PlanPiece { motion, kind, start_s, end_s, .. } = piece;
            let motion = MotionIndex::from_number(motion as usize).ok_or_else(|| {
                PlanRecordError::Damaged {
                    message: "a piece of motion 0; motions count from 1".to_owned(),
                }
            })?;
            Ok(PlannedPiece { motion, kind, start_s, end_s })
        };
        let pieces = record.pieces.iter().map(piece).collect::<Result<_, PlanRecordError>>()?;
        let motions = record.figures().map(|figures| figures.motions).unwrap_or_default();
        let types = motions.iter().filter_map(|motion| {
            let index = MotionIndex::from_number(motion.index)?;
            Some((index, MotionType::from_name(&motion.r#type)?))
        });
        let types = types.collect();
        let names = motions.iter().filter_map(|motion| {
            Some((MotionIndex::from_number(motion.index)?, motion.label.name.clone()?))
        });
        let names = names.collect();
        let io = motions.iter().filter_map(|motion| {
            let index = MotionIndex::from_number(motion.index)?;
            Some((index, (motion.io.clone()?, motion.value?)))
        });
        let io = io.collect();
        let program = record.program.as_deref().and_then(|text| Program::from_json(text).ok());
        let (loads, mount) = program
            .map_or_else(Default::default, |program| (program.loads(), program.workcell.mount));
        Ok(Self { types, names, io, loads, mount, ..Self::of(robot, record.nodes, pieces) })
    }

    /// Returns the type of a motion; the default type (PTP) if the plan does not contain it.
    pub(crate) fn motion_type(&self, motion: MotionIndex) -> MotionType {
        let place = self.types.binary_search_by_key(&motion, |(motion, _)| *motion);
        place.map_or_else(|_| MotionType::default(), |place| self.types[place].1)
    }

    /// Name of a motion, if it has one.
    #[must_use]
    pub fn name_of(&self, motion: MotionIndex) -> Option<&str> {
        self.names.get(&motion).map(String::as_str)
    }

    /// Input or output of an entry, and its value.
    #[must_use]
    pub fn io_of(&self, motion: MotionIndex) -> Option<(&str, IoValue)> {
        self.io.get(&motion).map(|(io, value)| (io.as_str(), *value))
    }

    fn of(robot: Robot, mut knots: Vec<PlanNode>, pieces: Vec<PlannedPiece>) -> Self {
        // A program without motions has a single state.
        if knots.is_empty() {
            knots.push(PlanNode { t_s: 0.0, q: [0.0; 7], dq: [0.0; 7], ddq: [0.0; 7] });
        }
        if let [only] = knots[..] {
            knots.push(PlanNode { t_s: only.t_s + 1e-9, ..only });
        }
        // In jerk-limited plans, the robot leaves its stops with zero acceleration.
        let leaves = |pair: &&[PlanNode]| pair[0].dq == [0.0; 7] && pair[1].dq != [0.0; 7];
        let smooth = knots
            .windows(2)
            .filter(leaves)
            .all(|pair| pair[0].ddq.iter().all(|ddq| ddq.abs() <= 1e-6));
        let curve = Curve::new(knots, smooth);
        let (loads, mount) = (Vec::new(), Mount::default());
        let (types, names, io) = (Vec::new(), BTreeMap::new(), BTreeMap::new());
        Self { robot, curve, pieces, types, names, io, loads, mount }
    }

    /// Returns the robot of the plan.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Returns the time from the start to the end of the last settling, in s.
    #[must_use]
    pub fn cycle_time_s(&self) -> f64 {
        self.curve.knots()[self.curve.knots().len() - 1].t_s
    }

    /// Returns the planned rest at the start and at the end (settling and waits), in s, which joint
    /// positions do not show.
    #[must_use]
    pub fn standing_s(&self) -> f64 {
        match self.legs().as_slice() {
            [] => self.cycle_time_s(),
            [first, .., last] => self.cycle_time_s() - (last.end_s - first.start_s),
            [only] => self.cycle_time_s() - (only.end_s - only.start_s),
        }
    }

    /// Returns the planned joint positions at `t_s`, in rad.
    #[must_use]
    pub fn at(&self, t_s: f64) -> Joints {
        self.curve.at(t_s).0
    }

    /// Returns the motion at `t_s`.
    #[must_use]
    pub fn motion_at(&self, t_s: f64) -> MotionIndex {
        let next = self.pieces.partition_point(|piece| piece.end_s <= t_s);
        self.pieces
            .get(next)
            .or(self.pieces.last())
            .map_or_else(MotionIndex::default, |piece| piece.motion)
    }

    /// Returns the dynamics of the mounted robot with the payload of a motion.
    pub(crate) fn dynamics(&self, motion: MotionIndex) -> Dynamics {
        let empty = self.robot.dynamics().with_mount(&self.mount);
        let load = self.loads.get(motion.index()).and_then(Option::as_ref);
        load.map_or(empty, |load| empty.with_load(load))
    }

    /// Returns the torques at `t_s`, including friction, in Nm.
    pub(crate) fn torques_at(&self, t_s: f64, dynamics: &Dynamics) -> Joints {
        let interval = self.curve.interval_at(t_s);
        let (q, dq) = self.curve.in_interval(interval, t_s);
        let next = self.pieces.partition_point(|piece| piece.end_s <= t_s);
        if self.pieces.get(next).is_none_or(|piece| !piece.kind.moves()) {
            return dynamics.gravity_torques(&q);
        }
        let (a, b) = (&self.curve.knots()[interval], &self.curve.knots()[interval + 1]);
        let x = ((t_s - a.t_s) / (b.t_s - a.t_s)).clamp(0.0, 1.0);
        let ddq = std::array::from_fn(|j| a.ddq[j] + x * (b.ddq[j] - a.ddq[j]));
        let friction = dynamics.friction().torques_nm(&dq);
        let rigid = dynamics.torques(&q, &dq, &ddq);
        std::array::from_fn(|j| rigid[j] + friction[j])
    }

    /// Returns the parts from stop to stop, in order.
    pub(crate) fn legs(&self) -> Vec<PlanLeg> {
        self.pieces
            .chunk_by(|a, b| a.kind.moves() == b.kind.moves())
            .filter(|pieces| pieces[0].kind.moves())
            .map(|pieces| PlanLeg {
                start_s: pieces[0].start_s,
                end_s: pieces[pieces.len() - 1].end_s,
            })
            .collect()
    }
}
