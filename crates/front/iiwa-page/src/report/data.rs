//! Data of the page, in page format.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use crate::arm_look::Look;
use iiwa_kin::{Joints, Robot};
use iiwa_log::{LogOptions, Loss, PlanPiece};
use iiwa_plan::{PlanRequest, ProgramSource};
use iiwa_program::{Blend, LimitKind, Motion, Program};
use iiwa_report::{ComparisonReport, with_causes};
use iiwa_scene::{ArmInScene, ArmMeshes, CarriedBodies, Scene};
use iiwa_traj::PieceKind;
use serde::Serialize;
use serde_json::Value;

use crate::{
    PageError,
    page::{self, ArmSource, PagePart, Poses},
};

use super::{
    attached,
    body_times::BodyTimes,
    clearance::{Clearances, OfPose},
    compared::{Compared, comparison},
    curve::{CurveColumns, TimeSeries},
    curves::Curves,
    measured::{self, MeasuredCurves},
    planned::PlannedCurves,
    segments::segments,
    source::{PageSource, Role},
    tool::PageWorkcell,
};

/// Parts of this page only.
const PARTS: [PagePart; 11] = [
    ("/*data.js*/", include_str!("data.js")),
    ("/*plot.js*/", include_str!("../page/plot.js")),
    ("/*timeline.js*/", include_str!("../page/timeline.js")),
    ("/*player.js*/", include_str!("../page/player.js")),
    ("/*charts.js*/", include_str!("charts.js")),
    ("/*head.js*/", include_str!("head.js")),
    ("/*point.js*/", include_str!("point.js")),
    ("/*panels.js*/", include_str!("panels.js")),
    ("/*tables.js*/", include_str!("tables.js")),
    ("/*pointing.js*/", include_str!("pointing.js")),
    ("/*main.js*/", include_str!("main.js")),
];

/// Page that shows a plan, a recording, or both, in one self-contained file.
#[derive(Debug, Serialize)]
pub struct Page {
    robot: RobotModel,
    /// Arm of FILE, then the arm of MEASURED.
    arms: Vec<ArmMotion>,
    /// Path pieces: lines, TCP paths, blends, settle times and waits, in the order of time.
    pieces: Vec<PlanPiece>,
    corners: Vec<BlendedTarget>,
    workcell: PageWorkcell,
    /// Surroundings and payload of the arm.
    #[serde(skip_serializing_if = "Option::is_none")]
    scene: Option<Scene>,
    /// Shapes that the program carries at the flange.
    #[serde(skip_serializing_if = "Option::is_none")]
    carried: Option<CarriedBodies>,
    /// Reduced limits of motions, by motion number from 1.
    shares: BTreeMap<usize, LimitShares>,
    /// Segment types of splines, by motion number from 1.
    segments: BTreeMap<usize, Vec<&'static str>>,
    /// Figures, as in `iiwasim plan --json`.
    figures: Value,
    compared: Option<Compared>,
    /// Missing data and assumptions, as text.
    notes: Vec<String>,
    /// Names of the files.
    #[serde(skip)]
    title: String,
}

/// Robot: appearance, kinematics and limits.
#[derive(Debug, Serialize)]
struct RobotModel {
    name: String,
    /// URDF with the joints.
    urdf: String,
    look: Look,
    lower_rad: Joints,
    upper_rad: Joints,
    velocity_rad_s: Joints,
    acceleration_rad_s2: Joints,
    jerk_rad_s3: Joints,
    torque_nm: Joints,
    assumptions: Vec<String>,
}

/// Motion of the arm in one file. Times are in s of the page.
#[derive(Debug, Serialize)]
struct ArmMotion {
    role: Role,
    file: String,
    start_s: f64,
    end_s: f64,
    samples: usize,
    rate_hz: Option<f64>,
    poses: Poses,
    #[serde(flatten)]
    curves: Option<Curves>,
    /// Torques that the joints exert, in Nm; without columns if the file lacks them.
    torque: CurveColumns,
    /// Bodies that the arm carries over time; none if their times are unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    bodies: Option<BodyTimes>,
    /// Speed in m/s: of the flange, and, with a tool, of the TCP.
    #[serde(skip_serializing_if = "Option::is_none")]
    speed: Option<CurveColumns>,
    /// Clearance, in a scene with obstacles.
    #[serde(skip_serializing_if = "Option::is_none")]
    clearance: Option<Clearances>,
    /// Clearance of the arm to itself, in a scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    self_clearance: Option<Clearances>,
}

/// Part of a page that is computed. Curves use more memory than the rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Extent {
    /// Only the content of [`Page::sketch`].
    Sketch,
    /// Whole page.
    #[default]
    Whole,
}

/// Options of a page.
#[derive(Clone, Debug)]
pub struct PageOptions {
    /// Robot, if it differs from that of the files.
    pub robot: Option<Robot>,
    /// Meshes in place of the built-in shells; their convex hulls are also used for the clearance.
    pub arm: Option<ArmSource>,
    /// Surroundings of the arm: the whole page shows them, and the clearance.
    pub scene: Option<Scene>,
    /// Options for the information that log columns leave open.
    pub log: LogOptions,
    /// Part of the page to compute.
    pub extent: Extent,
    /// Returns true to end the work early; called repeatedly during planning.
    pub interrupted: fn() -> bool,
}

impl Default for PageOptions {
    /// Returns the files' robot with built-in shells, no scene, the whole page, no interrupt.
    fn default() -> Self {
        Self {
            robot: None,
            arm: None,
            scene: None,
            log: LogOptions::default(),
            extent: Extent::default(),
            interrupted: || false,
        }
    }
}

/// Page without curves.
#[derive(Serialize)]
struct Sketch<'a> {
    arms: Vec<Outline<'a>>,
    pieces: &'a [PlanPiece],
    corners: &'a [BlendedTarget],
    workcell: &'a PageWorkcell,
    compared: Option<&'a ComparisonReport>,
    notes: &'a [String],
}

/// Arm without curves.
#[derive(Serialize)]
struct Outline<'a> {
    start_s: &'a f64,
    end_s: &'a f64,
    poses: &'a Poses,
    torque: &'a CurveColumns,
}

/// Blended target.
#[derive(Debug, Serialize)]
struct BlendedTarget {
    /// Number of the motion, from 1.
    motion: usize,
    target_m: [f64; 3],
    /// Radius of the blend sphere; `None` for a relative blend.
    radius_m: Option<f64>,
}

/// Limits of a motion relative to the robot's limits.
#[derive(Debug, Serialize)]
struct LimitShares {
    velocity: Joints,
    acceleration: Joints,
    jerk: Joints,
}

/// Shapes of the loads of a program; `None` without shapes, or with a note if they cannot be read.
fn carried_bodies(program: &Program, notes: &mut Vec<String>) -> Option<CarriedBodies> {
    match CarriedBodies::new(program, recorded_mesh) {
        Ok(carried) => (!carried.bodies().is_empty()).then_some(carried),
        Err(error) => {
            notes.push(format!("{error}; no shapes of loads are shown or checked"));
            None
        }
    }
}

/// Note on a file in which the load changes are not known in time.
fn unknown_times(name: &str) -> String {
    format!(
        "{name}: the times of its load changes are unknown, so that no shapes of loads and no \
         clearances are shown for it"
    )
}

impl Page {
    /// Reads one file, a plan or a recording, or a plan and a recording. For a single recording
    /// that contains its program, the plan of that program is shown beside it.
    ///
    /// # Errors
    ///
    /// [`PageError`] if a file cannot be read or shown, or its robot is unknown.
    pub fn read(
        file: &Path,
        measured: Option<&Path>,
        options: &PageOptions,
    ) -> Result<Self, PageError> {
        let first = PageSource::read(file, options.log)?;
        let second = measured.map(|path| PageSource::read(path, options.log)).transpose()?;
        swapped(&first, second.as_ref())?;
        let (robot, assumed) = first.robot(options.robot.as_ref())?;
        first.check(&robot)?;
        let title = second.as_ref().map(|second| format!("{} and {}", first.file, second.file));
        let title = title.unwrap_or_else(|| first.file.clone());
        let mut notes: Vec<String> = assumed.into_iter().collect();
        let (first, second) = match second {
            None => beside_its_plan(first, &robot, options.interrupted, &mut notes)?,
            second => (first, second),
        };
        Self::of_sources(first, second.as_ref(), &robot, title, notes, options)
    }

    /// Plans a program, and shows the plan.
    ///
    /// # Errors
    ///
    /// [`PageError`] if the program cannot be planned, or the plan cannot be shown.
    pub fn of_program(
        title: &str,
        source: &ProgramSource,
        request: &PlanRequest,
        options: &PageOptions,
    ) -> Result<Self, PageError> {
        let (plan, robot) = attached::planned(title, source, request, options.interrupted)?;
        Self::of_sources(plan, None, &robot, title.to_owned(), Vec::new(), options)
    }

    /// Converts a plan or a recording, and the recording beside a plan.
    fn of_sources(
        first: PageSource,
        second: Option<&PageSource>,
        robot: &Robot,
        title: String,
        mut notes: Vec<String>,
        options: &PageOptions,
    ) -> Result<Self, PageError> {
        let extent = options.extent;
        notes.extend(first.losses());
        if first.role() == Role::Part {
            notes.push(format!(
                "{}: the file of the plan is truncated; motions and limits are shown up to its end",
                first.name
            ));
        }

        let mut compared = None;
        let program = first.program();
        let workcell = PageWorkcell::new(program.as_ref());
        let shift_s = from_start(&first);
        let scene = options.scene.as_ref().filter(|_| extent == Extent::Whole);
        let meshes = options.arm.as_ref().filter(|_| extent == Extent::Whole);
        let meshes = meshes.map(|source| source.of(robot)).transpose()?;
        let carried = program.as_ref().filter(|_| extent == Extent::Whole);
        let carried = carried.and_then(|program| carried_bodies(program, &mut notes));
        let in_scene = scene.map(|scene| match &meshes {
            Some(meshes) => ArmInScene::with_meshes(robot, scene, meshes),
            None => ArmInScene::new(robot, scene),
        });
        let in_scene = in_scene.map(|arm| match &carried {
            Some(carried) => arm.carrying(carried),
            None => arm,
        });
        let making = Making {
            extent,
            robot,
            scene: in_scene.as_ref(),
            workcell: &workcell,
            pieces: &first.record.pieces,
        };
        let bodies = match (&carried, first.role()) {
            (None, _) => Some(BodyTimes::default()),
            (Some(_), Role::Recording) => None,
            (Some(carried), role) => {
                Some(BodyTimes::of_plan(carried, &first.record.pieces, role == Role::Plan))
            }
        };
        if bodies.is_none() {
            notes.push(unknown_times(&first.name));
        }
        let mut arms = vec![making.arm(&first, shift_s, bodies)];
        if let Some(second) = second {
            second.check(robot)?;
            if second.role() != Role::Recording {
                notes.push(format!("{}: a plan, too: nothing in it was measured", second.name));
            }
            let (shift_s, motions) = match comparison(&first, second, robot) {
                Ok((report, shift_s, motions)) => {
                    compared = Some(report);
                    (shift_s, motions)
                }
                Err(why) => {
                    notes.push(why);
                    (from_start(second), Vec::new())
                }
            };
            let bodies = match &carried {
                None => Some(BodyTimes::default()),
                Some(carried) => BodyTimes::of_recording(carried, &motions),
            };
            if bodies.is_none() {
                notes.push(unknown_times(&second.name));
            }
            // The comparison reports gaps itself.
            let gap = |loss: &Loss| matches!(loss, Loss::Gap { .. });
            if compared.is_none() || !second.log.losses.iter().all(gap) {
                notes.extend(second.losses());
            }
            arms.push(making.arm(second, shift_s, bodies));
        }
        let motions = program.as_ref().map_or(&[][..], |program| &program.motions);
        Ok(Self {
            robot: RobotModel::new(robot, meshes.as_ref(), extent),
            arms,
            corners: corners(&first.record.pieces, program.as_ref(), robot),
            workcell,
            scene: scene.cloned(),
            carried,
            shares: shares(motions),
            segments: segments(motions),
            figures: first.record.to_json(),
            pieces: first.record.pieces,
            compared,
            notes,
            title,
        })
    }

    /// Missing data and assumptions, as text.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Measured cycle time of the second file, in s, if it was compared with the plan.
    #[must_use]
    pub fn measured_cycle_time_s(&self) -> Option<f64> {
        self.compared.as_ref().map(|compared| compared.report.measured_cycle_time_s())
    }

    /// Data for the 3D view of the page, without curves.
    #[must_use]
    pub fn sketch(&self) -> impl Serialize + use<'_> {
        Sketch {
            arms: self
                .arms
                .iter()
                .map(|ArmMotion { start_s, end_s, poses, torque, .. }| Outline {
                    start_s,
                    end_s,
                    poses,
                    torque,
                })
                .collect(),
            pieces: &self.pieces,
            corners: &self.corners,
            workcell: &self.workcell,
            compared: self.compared.as_ref().map(|compared| &compared.report),
            notes: &self.notes,
        }
    }

    /// Assembles the page as HTML, with its style, scripts and data.
    ///
    /// # Errors
    ///
    /// [`PageError::Json`].
    pub fn html(&self) -> Result<String, PageError> {
        page::assemble(include_str!("page.html"), &PARTS, &self.title, self)
    }
}

/// Data of the page for a page of two plans.
#[cfg(feature = "optimise")]
impl Page {
    /// End of the motion in the first file, in s.
    pub(crate) fn end_s(&self) -> f64 {
        self.arms.first().map_or(0.0, |arm| arm.end_s)
    }

    /// Pieces of the plan, in the order of time.
    pub(crate) fn pieces(&self) -> &[PlanPiece] {
        &self.pieces
    }
}

/// Rejects a recording followed by a plan: the page would swap the two.
fn swapped(first: &PageSource, second: Option<&PageSource>) -> Result<(), PageError> {
    match second {
        Some(second) if first.role() == Role::Recording && second.role() != Role::Recording => {
            Err(PageError::Swapped { recording: first.name.clone(), plan: second.name.clone() })
        }
        _ => Ok(()),
    }
}

/// Returns a file that is shown alone; for a recording with its program, the plan of the program,
/// and the recording.
fn beside_its_plan(
    alone: PageSource,
    robot: &Robot,
    interrupted: fn() -> bool,
    notes: &mut Vec<String>,
) -> Result<(PageSource, Option<PageSource>), PageError> {
    match attached::recorded(&alone, robot, interrupted) {
        None => Ok((alone, None)),
        Some(Ok(plan)) => {
            notes.push(format!(
                "{}: the plan beside it was made for this page, of the program that the recording \
                 holds, with jerk limits",
                alone.name
            ));
            Ok((plan, Some(alone)))
        }
        Some(Err(error @ (PageError::Interrupted | PageError::Write { .. }))) => Err(error),
        // The recording can be shown without its plan.
        Some(Err(error)) => {
            let why = with_causes(&error);
            notes.push(format!("{}: no plan of the program that it holds: {why}", alone.name));
            Ok((alone, None))
        }
    }
}

/// Time shift from a file to the page: its first sample is at 0.
fn from_start(source: &PageSource) -> f64 {
    source.log.t_s.first().map_or(0.0, |first| 0.0 - first)
}

/// Returns the motions with reduced limits, by their numbers.
fn shares(motions: &[Motion]) -> BTreeMap<usize, LimitShares> {
    let motion_share = |(index, motion): (usize, &Motion)| {
        let share = |kind| match motion {
            Motion::Ptp(ptp) => Some(*ptp.share(kind)),
            Motion::Cartesian(cartesian) => Some(cartesian.shares[kind]),
            Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => None,
        };
        let [velocity, acceleration, jerk] = LimitKind::ALL.map(share);
        let [velocity, acceleration, jerk] = [velocity?, acceleration?, jerk?];
        let narrower = [velocity, acceleration, jerk].iter().flatten().any(|share| *share < 1.0);
        narrower.then_some((index + 1, LimitShares { velocity, acceleration, jerk }))
    };
    motions.iter().enumerate().filter_map(motion_share).collect()
}

/// Returns the blended targets.
fn corners(pieces: &[PlanPiece], program: Option<&Program>, robot: &Robot) -> Vec<BlendedTarget> {
    let Some(program) = program else { return Vec::new() };
    let blended: BTreeSet<usize> = pieces
        .iter()
        .filter(|piece| piece.kind == PieceKind::Blend)
        .map(|piece| piece.motion as usize)
        .collect();
    let corner = |(index, motion): (usize, &Motion)| {
        let (target_m, radius_mm) = match motion {
            Motion::Ptp(ptp) => {
                // TCP of the program's tool, or the flange.
                let tcp = program.workcell.tcp(None).ok()?;
                let target = robot.flange_pose(&ptp.target_rad).then(&tcp);
                let radius_mm = match ptp.blend? {
                    Blend::CartMm(radius_mm) => Some(radius_mm),
                    _ => None,
                };
                (target.position_m, radius_mm)
            }
            Motion::Cartesian(cartesian) => {
                let target = cartesian.target()?;
                let (_, pose) = program.workcell.target(target, cartesian.base.as_deref()).ok()?;
                (pose.position_m, cartesian.blend?.cart_mm)
            }
            Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => return None,
        };
        // A blend belongs to the motion that it leads into.
        let waits =
            program.motions[index + 1..].iter().take_while(|next| next.is_overlapping_wait());
        blended.contains(&(index + 2 + waits.count())).then(|| BlendedTarget {
            motion: index + 1,
            target_m,
            radius_m: radius_mm.map(|radius_mm| 1e-3 * radius_mm),
        })
    };
    program.motions.iter().enumerate().filter_map(corner).collect()
}

/// Returns the contents of a mesh in a stored program.
fn recorded_mesh(file: &str) -> Result<Vec<u8>, String> {
    iiwa_plan::embedded_mesh(file)
        .unwrap_or_else(|| Err("the recorded program does not contain this mesh".to_owned()))
}

/// Common input for all arms of a page.
#[derive(Clone, Copy)]
struct Making<'a> {
    extent: Extent,
    robot: &'a Robot,
    scene: Option<&'a ArmInScene>,
    workcell: &'a PageWorkcell,
    /// Pieces of the plan in page time, which determine the active TCP.
    pieces: &'a [PlanPiece],
}

impl Making<'_> {
    /// Converts the motion of a file, all times shifted by `shift_s`. Without the times of carried
    /// `bodies`, clearances are unknown.
    fn arm(&self, source: &PageSource, shift_s: f64, bodies: Option<BodyTimes>) -> ArmMotion {
        let log = &source.log;
        let times = |t_s: Option<&f64>| t_s.map_or(0.0, |t_s| t_s + shift_s);
        let (start_s, end_s) = (times(log.t_s.first()), times(log.t_s.last()));
        let role = source.role();
        let (mut clearance, mut self_clearance, mut speed) = (None, None, None);
        let mut measure = |position: &TimeSeries, velocity: &TimeSeries| {
            let distances = |of_pose: OfPose| {
                let (arm, bodies) = self.scene.zip(bodies.as_ref())?;
                Clearances::new(arm, of_pose, position, bodies, shift_s)
            };
            clearance = distances(ArmInScene::clearance_during);
            self_clearance = distances(ArmInScene::self_clearance_during);
            let states = std::iter::zip(position.at_times(&velocity.t_s), &velocity.rows);
            let states = std::iter::zip(&velocity.t_s, states);
            let states = states.map(|(t_s, (q, dq))| (*t_s, q, dq));
            speed = Some(self.workcell.speeds(self.robot, self.pieces, states, shift_s));
        };
        let (poses, curves) = match (self.extent, role) {
            (Extent::Sketch, _) => (Poses::new(&log.t_s, &log.q_rad, shift_s), None),
            (Extent::Whole, Role::Plan) => {
                let timing = source.record.timing();
                let planned =
                    PlannedCurves::new(&source.record.nodes, timing != Some("acceleration"));
                measure(&planned.position, &planned.velocity);
                let poses = Poses::new(&planned.position.t_s, &planned.position.rows, shift_s);
                (poses, Some(Curves::of_plan(planned, timing, shift_s)))
            }
            (Extent::Whole, _) => {
                let poses = Poses::new(&log.t_s, &log.q_rad, shift_s);
                let measured = MeasuredCurves::new(log);
                measure(&measured.position, &measured.velocity);
                (poses, Some(Curves::of_recording(measured, shift_s)))
            }
        };
        ArmMotion {
            role,
            file: source.file.clone(),
            start_s,
            end_s,
            samples: log.t_s.len(),
            rate_hz: log.period_s().map(f64::recip),
            poses,
            curves,
            torque: CurveColumns::new(&measured::torques(log), shift_s),
            bodies: bodies.filter(|bodies| !bodies.is_empty()),
            speed,
            clearance,
            self_clearance,
        }
    }
}

impl RobotModel {
    fn new(robot: &Robot, meshes: Option<&ArmMeshes>, extent: Extent) -> Self {
        let limits = robot.limits();
        let look = match (extent, meshes) {
            (Extent::Sketch, _) => Look::default(),
            (Extent::Whole, Some(meshes)) => Look::of_meshes(meshes),
            (Extent::Whole, None) => Look::built_in(robot),
        };
        Self {
            name: robot.name().to_owned(),
            urdf: robot.to_urdf(),
            look,
            lower_rad: limits.lower_rad,
            upper_rad: limits.upper_rad,
            velocity_rad_s: limits.velocity_rad_s,
            acceleration_rad_s2: limits.acceleration_rad_s2,
            jerk_rad_s3: limits.jerk_rad_s3,
            torque_nm: limits.torque_nm,
            assumptions: robot
                .assumptions()
                .iter()
                .map(|assumption| format!("{}: {}", assumption.quantity, assumption.basis))
                .collect(),
        }
    }
}
