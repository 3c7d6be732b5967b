//! Difference of two plans: their motions matched by targets, with the change of the path.

use std::{collections::HashMap, ops::Range};

use iiwa_log::{PlanRecord, PlanRecordError};
use iiwa_plan::{GroupRecord, MotionRecord, Plan, PlanFigures};
use iiwa_program::{Course, Motion, Program};
use nalgebra::SVector;
use similar::{
    DiffOp,
    algorithms::{Capture, Compact, Replace, myers},
};

use crate::PlannedTrajectory;

/// Plan with its figures and its program, for [`PlanDifference::between`].
#[derive(Clone, Debug)]
pub struct PlanVersion {
    trajectory: PlannedTrajectory,
    figures: PlanFigures,
    /// Target of each motion, in the order of the figures.
    targets: Vec<String>,
}

impl PlanVersion {
    /// Figures of the plan.
    #[must_use]
    pub fn figures(&self) -> &PlanFigures {
        &self.figures
    }

    /// Figures of the plan, for example to add clearances to a scene.
    pub fn figures_mut(&mut self) -> &mut PlanFigures {
        &mut self.figures
    }

    /// Uses a plan that was read from a file.
    ///
    /// # Errors
    ///
    /// [`PlanRecordError`] if the file lacks figures or the program, is damaged, or its robot is
    /// unknown.
    pub fn from_record(record: PlanRecord) -> Result<Self, PlanRecordError> {
        let missing = |part| PlanRecordError::Missing { part };
        let figures = record.figures().ok_or(missing("figures of the plan"))?;
        let text = record.program.as_deref().ok_or(missing("program"))?;
        let program = Program::from_json(text)
            .map_err(|error| PlanRecordError::Damaged { message: error.to_string() })?;
        let trajectory = PlannedTrajectory::from_record(record, None)?;
        Ok(Self::new(trajectory, figures, &program))
    }

    fn new(trajectory: PlannedTrajectory, figures: PlanFigures, program: &Program) -> Self {
        let motion = |record: &MotionRecord| program.motions.get(record.index.checked_sub(1)?);
        let targets = figures
            .motions
            .iter()
            .map(|record| motion(record).map(target_of).unwrap_or_default())
            .collect();
        Self { trajectory, figures, targets }
    }

    /// Returns joint and flange positions along a motion, at equal steps of the length in joint
    /// space, so that they do not depend on speed.
    fn path(&self, motion: &MotionRecord) -> SampledPath {
        /// Number of steps: between two points, a circle of 0.5 m that is passed once deviates from
        /// its chord by 0.04 mm.
        const STEPS: usize = 128;
        let Self { trajectory, .. } = self;
        let curve = &trajectory.curve;
        let [from, to] = [motion.start_s, motion.end_s].map(|t_s| curve.arc_at(t_s));
        let joints: Vec<_> = (0..=STEPS)
            .map(|step| curve.at_arc(from + (to - from) * step as f64 / STEPS as f64))
            .collect();
        let robot = trajectory.robot();
        SampledPath {
            flange_m: joints.iter().map(|q| robot.flange_position(q).into()).collect(),
            joints_rad: joints.into_iter().map(SVector::from).collect(),
        }
    }
}

/// Points along a motion, in m and in rad.
struct SampledPath {
    flange_m: Vec<SVector<f64, 3>>,
    joints_rad: Vec<SVector<f64, 7>>,
}

impl From<&Plan> for PlanVersion {
    fn from(plan: &Plan) -> Self {
        let trajectory = PlannedTrajectory::from_trajectory(&plan.trajectory);
        Self::new(trajectory, plan.figures(), &plan.program)
    }
}

/// Returns type and target of a motion as a text that does not depend on speeds, limits and blends.
/// A frame is identified by its name.
fn target_of(motion: &Motion) -> String {
    let target = match motion {
        Motion::Ptp(ptp) => format!("{:?}", ptp.target_rad),
        Motion::Cartesian(cartesian) => match &cartesian.course {
            Course::Spline(segments) => {
                let courses: Vec<_> = segments.iter().map(|segment| &segment.course).collect();
                format!("{courses:?}")
            }
            course => format!("{course:?}"),
        },
        Motion::Io(entry) => format!("{} {}", entry.io, entry.value),
        Motion::Wait { .. } | Motion::Load(_) => String::new(),
    };
    format!("{} {target}", motion.motion_type().name())
}

/// Difference of two plans.
#[derive(Clone, Debug)]
pub struct PlanDifference {
    /// All motions of both plans, in order.
    pub motions: Vec<MotionDifference>,
    /// Groups of motions: those of the old plan in order, then those that were added.
    pub groups: Vec<GroupDifference>,
}

/// A group of motions of the old plan, of the new plan, or of both, matched by its name.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupDifference {
    /// Name of the group.
    pub name: String,
    /// Group in the old plan; `None` if it was added.
    pub old: Option<GroupRecord>,
    /// Group in the new plan; `None` if it was removed.
    pub new: Option<GroupRecord>,
}

/// A motion of the old plan, of the new plan, or of both.
#[derive(Clone, Debug)]
pub struct MotionDifference {
    /// Motion of the old plan; `None` if it was added.
    pub old: Option<MotionRecord>,
    /// Motion of the new plan; `None` if it was removed.
    pub new: Option<MotionRecord>,
    /// Largest distances of a point on one path from the other path; for motions of both plans.
    pub path: Option<PathChange>,
}

/// Largest distances between the paths of a motion in two plans, regardless of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathChange {
    /// Distance between flange positions, in m.
    pub flange_m: f64,
    /// Distance in joint space (Euclidean norm of the seven angles), in rad: also shows another
    /// orientation or elbow angle.
    pub joints_rad: f64,
}

impl PlanDifference {
    /// Compares two plans.
    #[must_use]
    pub fn between(old: &PlanVersion, new: &PlanVersion) -> Self {
        let motions = pairs(old, new)
            .into_iter()
            .map(|(a, b)| {
                let [a, b] = [(old, a), (new, b)]
                    .map(|(plan, index)| index.map(|index| (plan, &plan.figures.motions[index])));
                let path = a.zip(b).map(|((old, a), (new, b))| {
                    let (a, b) = (old.path(a), new.path(b));
                    PathChange {
                        flange_m: largest_distance(&a.flange_m, &b.flange_m),
                        joints_rad: largest_distance(&a.joints_rad, &b.joints_rad),
                    }
                });
                let [old, new] = [a, b].map(|side| side.map(|(_, motion)| motion.clone()));
                MotionDifference { old, new, path }
            })
            .collect();
        Self { motions, groups: groups(&old.figures.groups, &new.figures.groups) }
    }
}

/// Matches the groups of two plans by their names.
fn groups(old: &[GroupRecord], new: &[GroupRecord]) -> Vec<GroupDifference> {
    let by_name = |groups: &[GroupRecord]| -> HashMap<String, GroupRecord> {
        groups.iter().map(|group| (group.name.clone(), group.clone())).collect()
    };
    let (mut before, mut after) = (by_name(old), by_name(new));
    let names = old.iter().chain(new).map(|group| &group.name);
    names
        .filter_map(|name| {
            let (old, new) = (before.remove(name), after.remove(name));
            // A group of both plans is found twice.
            (old.is_some() || new.is_some()).then(|| GroupDifference {
                name: name.clone(),
                old,
                new,
            })
        })
        .collect()
}

/// Indices of a motion in the old and in the new plan.
type MatchedMotions = (Option<usize>, Option<usize>);

/// Matches the motions of two plans: by targets, and between those by types.
fn pairs(old: &PlanVersion, new: &PlanVersion) -> Vec<MatchedMotions> {
    let mut all = Vec::new();
    let targets = [old, new].map(|plan| plan.targets.iter().map(String::as_str).collect());
    add_pairs(&mut all, targets, [0, 0], |all, old_range, new_range| {
        let types = |plan: &PlanVersion, range: &Range<usize>| {
            plan.figures.motions[range.clone()].iter().map(|motion| motion.r#type.clone()).collect()
        };
        let types: [Vec<_>; 2] = [types(old, &old_range), types(new, &new_range)];
        let types = types.each_ref().map(|types| types.iter().map(|text| &**text).collect());
        add_pairs(all, types, [old_range.start, new_range.start], add_single);
    });
    all
}

/// Adds the pairs of equal elements of two lists, whose first elements have the indices `starts`.
/// `other` adds the elements in between, which differ.
fn add_pairs(
    all: &mut Vec<MatchedMotions>,
    lists: [Vec<&str>; 2],
    starts: [usize; 2],
    other: impl Fn(&mut Vec<MatchedMotions>, Range<usize>, Range<usize>),
) {
    // Numbers compare faster than texts.
    let mut numbers = HashMap::new();
    let numbered = lists.map(|list| {
        let number = |text| {
            let next = numbers.len();
            *numbers.entry(text).or_insert(next)
        };
        list.into_iter().map(number).collect::<Vec<_>>()
    });
    let [old, new] = numbered.each_ref().map(Vec::as_slice);
    // The shorter call, with the algorithm as an argument, would compile all algorithms.
    let mut found = Compact::new(Replace::new(Capture::new()), old, new);
    let Ok(()) = myers::diff(&mut found, old, 0..old.len(), new, 0..new.len());
    for op in found.into_inner().into_inner().into_ops() {
        let shifted = |start: usize, range: Range<usize>| start + range.start..start + range.end;
        let (old, new) = (shifted(starts[0], op.old_range()), shifted(starts[1], op.new_range()));
        if let DiffOp::Equal { .. } = op {
            all.extend(old.zip(new).map(|(old, new)| (Some(old), Some(new))));
        } else {
            other(all, old, new);
        }
    }
}

/// Adds motions of one plan alone.
fn add_single(all: &mut Vec<MatchedMotions>, old: Range<usize>, new: Range<usize>) {
    all.extend(old.map(|old| (Some(old), None)));
    all.extend(new.map(|new| (None, Some(new))));
}

/// Returns the largest distance of a point of one path from the other path.
fn largest_distance<const N: usize>(a: &[SVector<f64, N>], b: &[SVector<f64, N>]) -> f64 {
    if a == b {
        return 0.0;
    }
    let one_way = |from: &[SVector<f64, N>], to: &[SVector<f64, N>]| {
        from.iter().map(|point| distance(point, to)).fold(0.0, f64::max)
    };
    one_way(a, b).max(one_way(b, a))
}

/// Returns the distance of a point from a polyline.
fn distance<const N: usize>(point: &SVector<f64, N>, line: &[SVector<f64, N>]) -> f64 {
    let to_chord = |pair: &[SVector<f64, N>]| {
        let (chord, to) = (pair[1] - pair[0], point - pair[0]);
        let square = chord.norm_squared();
        let share = if square > 0.0 { (to.dot(&chord) / square).clamp(0.0, 1.0) } else { 0.0 };
        (to - share * chord).norm()
    };
    line.windows(2).map(to_chord).fold(f64::INFINITY, f64::min)
}
