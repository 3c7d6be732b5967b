//! Trajectory of a whole program.

use iiwa_kin::Joints;
use iiwa_path::JointPath;
use iiwa_program::MotionIndex;

use crate::{
    figures::{BlendFigures, MotionFigures, Totals},
    planner::Planner,
    playback::TimedMotion,
    section::{LateBlend, Section},
    state::State,
    timing::{Timing, TimingError},
};

/// Trajectory of the robot from the start of a program to its end.
///
/// The limits of each section are checked before a trajectory is returned. Between the points at
/// which the solver enforces them, velocity limits are exceeded by at most 0.1 %, acceleration
/// limits by 0.2 % and jerk limits by 2 %. Splines under [`Timing::Sunrise`] exceed acceleration
/// and jerk limits by more.
#[derive(Clone, Debug)]
pub struct Trajectory {
    path: JointPath,
    sections: Vec<Section>,
    totals: Totals,
}

impl Trajectory {
    /// Plans the trajectory along `path`: the fastest one within the limits of its motions, or one
    /// as recorded under Sunrise, depending on `timing`.
    ///
    /// # Errors
    ///
    /// [`TimingError::CurvatureJumps`] for jerk-limited timing of blends whose curvature jumps at
    /// their ends; [`TimingError::CannotHold`] if a torque limit is too low to hold the arm; any
    /// other error is a fault of the planner.
    pub fn plan(path: &JointPath, timing: Timing) -> Result<Self, TimingError> {
        Self::by(&mut Planner::new(path, timing))
    }

    /// Collects all sections of a new or restarted planner, which can be interrupted.
    ///
    /// ```
    /// use std::sync::{Arc, atomic::AtomicBool};
    ///
    /// use iiwa_kin::Robot;
    /// use iiwa_path::JointPath;
    /// use iiwa_program::Program;
    /// use iiwa_traj::{Planner, Timing, TimingError, Trajectory};
    ///
    /// let program =
    ///     Program::from_deg([0.0; 7]).ptp_deg([30.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).build();
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// let stop = Arc::new(AtomicBool::new(true));
    /// let mut planner = Planner::new(&path, Timing::default()).interrupted_by(stop);
    /// assert_eq!(Trajectory::by(&mut planner).err(), Some(TimingError::Interrupted));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The errors of [`plan`](Self::plan), [`TimingError::TooManyRows`] with too many further
    /// limits, and [`TimingError::Interrupted`].
    pub fn by(planner: &mut Planner) -> Result<Self, TimingError> {
        let sections = planner.collect::<Result<_, _>>()?;
        Ok(Self::from_sections(planner.path().clone(), sections))
    }

    /// Creates the trajectory of some sections, in order.
    pub(crate) fn from_sections(path: JointPath, sections: Vec<Section>) -> Self {
        let mut totals = Totals::default();
        for section in &sections {
            totals.add(section);
        }
        Self { path, sections, totals }
    }

    /// Returns the path.
    #[must_use]
    pub fn path(&self) -> &JointPath {
        &self.path
    }

    /// Returns the time from the start to the end of the last settling, in s.
    #[must_use]
    pub fn cycle_time_s(&self) -> f64 {
        self.totals.cycle_time_s()
    }

    /// Returns the time in motion, in s.
    #[must_use]
    pub fn motion_time_s(&self) -> f64 {
        self.totals.motion_time_s
    }

    /// Returns the total times by kind of piece.
    #[must_use]
    pub fn totals(&self) -> &Totals {
        &self.totals
    }

    /// Returns the sections from stop to stop, in order.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::JointPath;
    /// use iiwa_program::{Blend, Program};
    /// use iiwa_traj::{Timing, Trajectory};
    ///
    /// let program = Program::from_deg([0.0; 7])
    ///     .ptp_deg([40.0, 0.0, 0.0, -60.0, 0.0, 0.0, 0.0])
    ///     .blend(Blend::Fraction(0.3))
    ///     .ptp_deg([40.0, 30.0, 0.0, -30.0, 0.0, 0.0, 0.0])
    ///     .build();
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// let trajectory = Trajectory::plan(&path, Timing::default())?;
    /// // The arm stops once, at the end.
    /// assert_eq!(trajectory.sections().len(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn sections(&self) -> &[Section] {
        &self.sections
    }

    /// Returns the state at `t_s`; before the start and after the end, the robot is at rest. O(log
    /// n).
    #[must_use]
    pub fn at(&self, t_s: f64) -> State {
        let next = self.sections.partition_point(|section| section.end_s() <= t_s);
        match self.sections.get(next).or(self.sections.last()) {
            Some(section) => section.at(t_s),
            None => State {
                t_s: 0.0,
                q: *self.path.start_rad(),
                dq: [0.0; 7],
                ddq: [0.0; 7],
                dddq: [0.0; 7],
                motion: MotionIndex::default(),
                step: 0,
            },
        }
    }

    /// Returns the states at all nodes, including the end. Times increase strictly.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::JointPath;
    /// use iiwa_program::{Blend, Program};
    /// use iiwa_traj::{Timing, Trajectory};
    ///
    /// let program = Program::from_deg([0.0; 7])
    ///     .ptp_deg([40.0, 0.0, 0.0, -60.0, 0.0, 0.0, 0.0])
    ///     .blend(Blend::Fraction(0.3))
    ///     .ptp_deg([40.0, 30.0, 0.0, -30.0, 0.0, 0.0, 0.0])
    ///     .build();
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// let trajectory = Trajectory::plan(&path, Timing::default())?;
    /// let fastest = trajectory.states().map(|state| state.dq[3].abs()).fold(0.0, f64::max);
    /// assert!(fastest <= path.robot().limits().velocity_rad_s[3] * 1.004);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn states(&self) -> impl Iterator<Item = State> {
        let end = self.sections.last().map(|section| section.at(section.end_s()));
        self.sections.iter().flat_map(Section::states).chain(end)
    }

    /// Returns the states at a sampling rate of `rate_hz`: the first sample is at 0, the last one
    /// exactly at the cycle time, at any distance from the one before.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::JointPath;
    /// use iiwa_program::Program;
    /// use iiwa_traj::{Timing, Trajectory};
    ///
    /// let program =
    ///     Program::from_deg([0.0; 7]).ptp_deg([30.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).build();
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// let trajectory = Trajectory::plan(&path, Timing::default())?;
    /// let samples: Vec<_> = trajectory.samples(1000.0).collect();
    /// assert_eq!(samples[1].t_s, 0.001);
    /// assert_eq!(samples.last().unwrap().t_s, trajectory.cycle_time_s());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn samples(&self, rate_hz: f64) -> impl Iterator<Item = State> {
        let end_s = self.cycle_time_s();
        // Not added up, so that rounding errors do not accumulate.
        let stamps = (0_u64..).map(move |i| i as f64 / rate_hz);
        let at = |t_s| State { t_s, ..self.at(t_s) };
        stamps.take_while(move |t_s| *t_s < end_s).chain([end_s]).map(at)
    }

    /// Returns the figures of all entries of the program's list of motions, in order.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::JointPath;
    /// use iiwa_program::{Blend, Program};
    /// use iiwa_traj::{Timing, Trajectory};
    ///
    /// let program = Program::from_deg([0.0; 7])
    ///     .ptp_deg([40.0, 0.0, 0.0, -60.0, 0.0, 0.0, 0.0])
    ///     .blend(Blend::Fraction(0.3))
    ///     .ptp_deg([40.0, 30.0, 0.0, -30.0, 0.0, 0.0, 0.0])
    ///     .build();
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// let trajectory = Trajectory::plan(&path, Timing::default())?;
    /// for motion in trajectory.motions() {
    ///     let limit = motion.limited_by.expect("it moves");
    ///     println!("{}: limited by {limit}", motion.motion);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn motions(&self) -> Vec<MotionFigures> {
        self.sections.iter().flat_map(Section::motions).collect()
    }

    /// Returns the figures of all blends, in order.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::JointPath;
    /// use iiwa_program::{Blend, Program};
    /// use iiwa_traj::{Timing, Trajectory};
    ///
    /// let program = Program::from_deg([0.0; 7])
    ///     .ptp_deg([40.0, 0.0, 0.0, -60.0, 0.0, 0.0, 0.0])
    ///     .blend(Blend::Fraction(0.3))
    ///     .ptp_deg([40.0, 30.0, 0.0, -30.0, 0.0, 0.0, 0.0])
    ///     .build();
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// let trajectory = Trajectory::plan(&path, Timing::default())?;
    /// let blend = trajectory.blends()[0];
    /// assert!(blend.start_s < blend.end_s && blend.gamma_deg > 0.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn blends(&self) -> Vec<BlendFigures> {
        self.sections.iter().flat_map(Section::blends).collect()
    }
}

impl Trajectory {
    /// Returns the blends before which the robot stops because the motions after them are not known
    /// in time, in order.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::JointPath;
    /// use iiwa_program::{Blend, Motion, Program};
    /// use iiwa_traj::{Timing, Trajectory};
    ///
    /// let program = Program::from_deg([0.0; 7])
    ///     .ptp_deg([40.0, 0.0, 0.0, -60.0, 0.0, 0.0, 0.0])
    ///     .blend(Blend::Fraction(0.3))
    ///     .motion(Motion::Wait { seconds: 3.0, overlap: 1 })
    ///     .ptp_deg([40.0, 30.0, 0.0, -30.0, 0.0, 0.0, 0.0])
    ///     .build();
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// let trajectory = Trajectory::plan(&path, Timing::default())?;
    /// let late: Vec<_> = trajectory.late_blends().collect();
    /// assert_eq!((late.len(), late[0].after_motion.number(), late[0].known_s), (1, 1, 3.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn late_blends(&self) -> impl Iterator<Item = &LateBlend> {
        self.sections.iter().filter_map(Section::late_blend)
    }
}

impl TimedMotion for Trajectory {
    fn at(&self, t_s: f64) -> Joints {
        Self::at(self, t_s).q
    }

    fn duration_s(&self) -> f64 {
        self.cycle_time_s()
    }
}
