//! Path of a motion program.

mod least_cruise;
mod update;

use std::sync::Arc;

use iiwa_kin::{Dynamics, Joints, Load, Mount, Pose, RampLaw, Robot};

use crate::{
    builder::steps,
    carried::Carried,
    join::{JoinError, check_joins},
    legs::{Legs, ListedLegs},
    options::PathOptions,
    segment::Segment,
    step::{Corner, SplineStop, Step},
};
use iiwa_program::{
    Fault, IoEntry, MotionIndex, MotionLimits, MotionType, OverlappingWait, Program, Sources,
};

pub use update::ReplacedSteps;

/// The path of a motion program in joint space: segments, corners with a stop, settling and waits,
/// in order. The path has no timing, except the durations of waits.
///
/// ```
/// use iiwa_kin::Robot;
/// use iiwa_path::JointPath;
/// use iiwa_program::{Blend, Motion, Program, Ptp, Start, Sources, Workcell};
///
/// let corner = Ptp::to([0.5, 0.3, 0.0, -1.0, 0.0, 0.7, 0.0]).blend(Blend::Fraction(0.25));
/// let end = Ptp::to([0.0, 0.6, 0.0, -1.2, 0.0, 0.4, 0.0]);
/// let program = Program {
///     robot: None,
///     start: Start::Joints([0.0; 7]),
///     motions: vec![Motion::Ptp(corner), Motion::Ptp(end)],
///     workcell: Workcell::default(),
///     sources: Sources::default(),
/// };
/// let path = JointPath::new(&program, &Robot::lbr_iiwa_7_r800())?;
/// assert_eq!(path.blends().count(), 1);
/// # Ok::<(), iiwa_program::Fault>(())
/// ```
///
/// A clone shares the steps and is cheap.
#[derive(Clone, Debug)]
pub struct JointPath {
    robot: Arc<Robot>,
    start: Joints,
    steps: Arc<Vec<Step>>,
    limits: Arc<Vec<MotionLimits>>,
    carried: Arc<Carried>,
    /// Motions of a program with frames, which updates keep where they can. Paths without updates
    /// need no memory for them.
    legs: Option<ListedLegs>,
}

impl JointPath {
    /// Builds the path of `program` on `robot`, with blends of the shape that the LBR iiwa uses.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::JointPath;
    /// use iiwa_program::{Fault, Program};
    ///
    /// let program = Program::from_deg([0.0; 7]).robot("lbr_iiwa_14_r820").wait_s(1.0).build();
    /// JointPath::new(&program, &Robot::lbr_iiwa_14_r820())?;
    /// let fault = JointPath::new(&program, &Robot::lbr_iiwa_7_r800());
    /// assert!(matches!(fault, Err(Fault::OtherRobot { .. })));
    /// # Ok::<(), Fault>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the program names another robot or another flange, or requires something that this robot
    /// cannot do.
    pub fn new(program: &Program, robot: &Robot) -> Result<Self, Fault> {
        Self::with_options(program, robot, PathOptions::default())
    }

    /// Builds the path of `program` on `robot`, with blends according to `options`.
    ///
    /// # Errors
    ///
    /// See [`new`](Self::new).
    pub fn with_options(
        program: &Program,
        robot: &Robot,
        options: PathOptions,
    ) -> Result<Self, Fault> {
        program.check_robot(robot)?;
        Self::on_other_robot(program, robot, options)
    }

    /// Builds the path of `program` on `robot`, in place of the robot that the program names.
    ///
    /// # Errors
    ///
    /// If the program requires something that this robot cannot do.
    pub fn on_other_robot(
        program: &Program,
        robot: &Robot,
        options: PathOptions,
    ) -> Result<Self, Fault> {
        program.check(robot.limits())?;
        let all = 0..program.motions.len();
        let robot = Arc::new(robot.clone());
        let legs = Legs::new(program, &robot)?;
        let steps = steps(program, &robot, options, &legs, all)?;
        let carried = Carried::new(program)?;
        Ok(Self {
            start: program.start_rad(&robot)?,
            limits: Arc::new(
                program
                    .motions
                    .iter()
                    .map(|motion| MotionLimits::of_motion(&robot, motion, &program.workcell))
                    .collect(),
            ),
            carried: Arc::new(carried),
            legs: None,
            robot,
            steps: Arc::new(steps),
        })
    }

    /// Builds a path from steps that do not come from a program, with segments of any shape.
    ///
    /// `limits` are those of the motions to which the steps refer. Consecutive segments without a
    /// stop have to join: the end of one is the start of the next, and dq/ds has the same direction
    /// there.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use iiwa_kin::Robot;
    /// use iiwa_path::{JointPath, Line, Step};
    /// use iiwa_program::{MotionIndex, MotionLimits};
    ///
    /// let robot = Robot::default();
    /// let line = Line::new([0.0; 7], [0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    /// let steps = vec![Step::Move {
    ///     motion: MotionIndex::new(0),
    ///     segment: Arc::new(line),
    ///     blend: None,
    ///     limits: None,
    /// }];
    /// let limits = vec![MotionLimits::full(&robot)];
    /// let path = JointPath::from_steps(&robot, [0.0; 7], steps, limits)?;
    /// assert_eq!(path.steps().len(), 1);
    /// # Ok::<(), iiwa_path::JoinError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If a step refers to a motion without limits, or if segments do not join.
    pub fn from_steps(
        robot: &Robot,
        start_rad: Joints,
        steps: Vec<Step>,
        limits: Vec<MotionLimits>,
    ) -> Result<Self, JoinError> {
        check_joins(&start_rad, &steps, limits.len())?;
        Ok(Self {
            robot: Arc::new(robot.clone()),
            start: start_rad,
            steps: Arc::new(steps),
            limits: Arc::new(limits),
            carried: Arc::default(),
            legs: None,
        })
    }

    /// The robot.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Joint positions at the start, in rad.
    #[must_use]
    pub fn start_rad(&self) -> &Joints {
        &self.start
    }

    /// The steps of the path, in order: moves, corners, settling, waits.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::{JointPath, Step};
    /// use iiwa_program::Program;
    ///
    /// let program = Program::from_deg([0.0; 7]).ptp_deg([30.0; 7]).wait_s(1.0).build();
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// let [Step::Move { segment, .. }, Step::Settle { .. }, Step::Wait { .. }] = path.steps()
    /// else {
    ///     panic!("a motion, its settling and a wait")
    /// };
    /// assert!(segment.is_straight());
    /// # Ok::<(), iiwa_program::Fault>(())
    /// ```
    #[must_use]
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Limits of each motion of the program, by index.
    #[must_use]
    pub fn limits(&self) -> &[MotionLimits] {
        &self.limits
    }

    /// Limits of a step: its own limits if it has any (segments of a spline can have their own),
    /// otherwise the limits of its motion.
    ///
    /// # Panics
    ///
    /// If `step` is out of range.
    #[must_use]
    pub fn limits_of(&self, step: usize) -> &MotionLimits {
        match &self.steps[step] {
            Step::Move { limits: Some(limits), .. } => limits,
            Step::Move { motion, .. }
            | Step::Corner { motion, .. }
            | Step::Settle { motion, .. }
            | Step::Wait { motion, .. } => &self.limits[motion.index()],
        }
    }

    /// TCP that a motion uses, as a pose in the flange frame: the TCP of the motion's tool, or else
    /// of the program's tool. A wait has the TCP of the motion before. Without a tool, and for
    /// paths that were not built from a program, the TCP is the flange, [`Pose::IDENTITY`].
    ///
    /// ```
    /// use iiwa_kin::{Pose, Robot};
    /// use iiwa_path::JointPath;
    /// use iiwa_program::{MotionIndex, Program};
    ///
    /// let program = Program::from_json(r#"{
    ///     "version": 1,
    ///     "tools": { "gripper": { "tcp": { "z_mm": 120 } } },
    ///     "tool": "gripper",
    ///     "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
    ///     "motions": [{ "type": "lin_rel", "offset": { "z_mm": -50 } }]
    /// }"#)?;
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// assert_eq!(path.tcp(MotionIndex::new(0)).position_m, [0.0, 0.0, 0.12]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn tcp(&self, motion: MotionIndex) -> &Pose {
        self.carried.tcp(motion.index())
    }

    /// Payload during a motion, if any; see [`Program::loads`].
    #[must_use]
    pub fn load(&self, motion: MotionIndex) -> Option<&Load> {
        self.carried.loads.get(motion.index())?.as_ref()
    }

    /// Mounting orientation of the robot base.
    #[must_use]
    pub fn mount(&self) -> &Mount {
        &self.carried.mount
    }

    /// Dynamics of the mounted robot with its payload during a motion.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::JointPath;
    /// use iiwa_program::{MotionIndex, Program};
    ///
    /// let program = Program::from_json(r#"{
    ///     "version": 1,
    ///     "mount": { "rpy_deg": [180, 0, 0] },
    ///     "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
    ///     "motions": [
    ///         { "type": "ptp", "joints_deg": [0, 50, 0, -60, 0, 90, 0] },
    ///         { "type": "load", "load": { "mass_kg": 3 } }
    ///     ]
    /// }"#)?;
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// let q = path.start_rad();
    /// let [empty, loaded] =
    ///     [0, 1].map(|motion| path.dynamics(MotionIndex::new(motion)).gravity_torques(q)[1]);
    /// assert!(empty > 0.0 && loaded > empty);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn dynamics(&self, motion: MotionIndex) -> Dynamics {
        let empty = self.robot.dynamics().with_mount(self.mount());
        self.load(motion).map_or(empty, |load| empty.with_load(load))
    }

    /// Waits of the program that overlap motions, in order. If the motion before the wait ends with
    /// a stop, the wait is a [`Step::Wait`] of 0 s; if it ends with a blend, the wait has no step.
    /// The time that the robot rests for a wait is known only after the time parameterisation.
    #[must_use]
    pub fn overlapping_waits(&self) -> &[OverlappingWait] {
        &self.carried.waits
    }

    /// Sources of the motions of the program (such as lines of Java), as far as they are known.
    #[must_use]
    pub fn sources(&self) -> &Sources {
        &self.carried.sources
    }

    /// Torque limit as a share of that of the robot, if the program limits torques.
    #[must_use]
    pub fn torque_limit_rel(&self) -> Option<f64> {
        self.carried.torque_limit_rel
    }

    /// Override of the controller, as a share; 1 if the program sets none.
    #[must_use]
    pub fn speed_override(&self) -> f64 {
        self.carried.speed_override.unwrap_or(1.0)
    }

    /// Law of soft starts and stops (ramps), slowed down by the override.
    #[must_use]
    pub fn ramp_law(&self) -> RampLaw {
        self.robot.ramp_law().slowed_down(self.speed_override())
    }

    /// Full robot limits, reduced by the override.
    #[must_use]
    pub fn full_limits(&self) -> MotionLimits {
        MotionLimits::full(&self.robot).slowed_down(self.speed_override())
    }

    /// Speed limit of TCP and flange in the operating mode T1, in m/s; `None` in other modes.
    #[must_use]
    pub fn t1_speed_m_s(&self) -> Option<f64> {
        // The operating mode, and thus the speed, is the same for all motions.
        self.limits.first()?.supervised_m_s()
    }

    /// Returns two values: the path without the T1 speed limit of TCP and flange, and this limit in
    /// m/s. Returns `None` in other operating modes.
    #[must_use]
    pub fn unsupervised(&self) -> Option<(Self, f64)> {
        let speed_m_s = self.t1_speed_m_s()?;
        let limits = self.limits.iter().map(MotionLimits::unsupervised).collect();
        let steps = self.steps.iter().map(|step| match step {
            Step::Move { motion, segment, blend, limits } => Step::Move {
                motion: *motion,
                segment: segment.unsupervised().unwrap_or_else(|| Arc::clone(segment)),
                blend: *blend,
                limits: limits.as_ref().map(|limits| Arc::new(limits.unsupervised())),
            },
            rest => rest.clone(),
        });
        let steps = Arc::new(steps.collect());
        Some((Self { limits: Arc::new(limits), steps, ..self.clone() }, speed_m_s))
    }

    /// Largest torque of each joint, in either direction, in Nm, if the program limits torques.
    #[must_use]
    pub fn torque_limits_nm(&self) -> Option<Joints> {
        let share = self.torque_limit_rel()?;
        Some(self.robot.limits().torque_nm.map(|limit| share * limit))
    }

    /// True if any motion moves a TCP other than the flange.
    #[must_use]
    pub fn has_tools(&self) -> bool {
        self.carried.has_tools
    }

    /// Type of an entry. `None` for motions and waits of a program without tools and frames, since
    /// their steps show their types.
    #[must_use]
    pub fn motion_type(&self, motion: MotionIndex) -> Option<MotionType> {
        let of_io = self.io(motion).map(IoEntry::motion_type);
        of_io.or_else(|| self.carried.types.get(motion.index()).copied())
    }

    /// Input or output of an entry, if any.
    #[must_use]
    pub fn io(&self, motion: MotionIndex) -> Option<&IoEntry> {
        self.carried.io.get(&motion)
    }

    /// Inputs and outputs of the program up to the entry `last`, in order.
    #[must_use]
    pub fn io_entries_to(
        &self,
        last: MotionIndex,
    ) -> impl DoubleEndedIterator<Item = (MotionIndex, &IoEntry)> {
        self.carried.io.range(..=last).map(|(motion, entry)| (*motion, entry))
    }

    /// Splines in which the TCP stops, and the places of these stops: at reversals, at repeated
    /// points, and between lines or circles that do not join smoothly.
    #[must_use]
    pub fn stops_in_splines(&self) -> Vec<(MotionIndex, Vec<SplineStop>)> {
        let mut stops: Vec<(MotionIndex, Vec<SplineStop>)> = Vec::new();
        for step in self.steps.iter() {
            let Step::Corner { motion, place: Some(place) } = step else { continue };
            match stops.last_mut() {
                Some((last, places)) if last == motion => places.push(*place),
                _ if self.motion_type(*motion) == Some(MotionType::Spline) => {
                    stops.push((*motion, vec![*place]));
                }
                _ => {}
            }
        }
        stops
    }

    /// All blends, in order: the corner, and the curve that rounds it off.
    pub fn blends(&self) -> impl Iterator<Item = (&Corner, &dyn Segment)> {
        self.steps.iter().filter_map(|step| match step {
            Step::Move { blend: Some(corner), segment, .. } => Some((corner, segment.as_ref())),
            _ => None,
        })
    }
}
