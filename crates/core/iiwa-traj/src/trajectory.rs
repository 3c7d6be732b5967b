//! A whole trajectory.

use iiwa_kin::Joints;
use iiwa_path::JointPath;
use iiwa_program::MotionIndex;

use crate::{
    figures::{BlendFigures, MotionFigures, Totals},
    late_blend::LateBlend,
    planner::Planner,
    playback::TimedMotion,
    section::Section,
    state::State,
    timing::{Timing, TimingError},
};

/// What the arm does at any time from the start of a program to its end.
///
/// It keeps its limits, which is checked before it is handed out. Between the places where the solver holds them, limits of
/// velocity are exceeded by at most 0.1 %, of acceleration by 0.2 % and of jerk by 2 %.
#[derive(Clone, Debug)]
pub struct Trajectory {
    path: JointPath,
    sections: Vec<Section>,
    totals: Totals,
}

impl Trajectory {
    /// The fastest trajectory along `path` within the limits of its motions.
    ///
    /// # Errors
    ///
    /// [`TimingError::CurvatureJumps`] for jerk-limited timing of blends whose curvature jumps at their ends; any
    /// other error is a fault of the planner.
    pub fn plan(path: &JointPath, timing: Timing) -> Result<Self, TimingError> {
        Self::by(&mut Planner::new(path, timing))
    }

    /// That of all sections of a planner that has not begun yet: one that can be interrupted.
    ///
    /// ```
    /// use std::sync::{Arc, atomic::AtomicBool};
    ///
    /// use iiwa_kin::Robot;
    /// use iiwa_path::JointPath;
    /// use iiwa_program::Program;
    /// use iiwa_traj::{Planner, Timing, TimingError, Trajectory};
    ///
    /// let program = Program::from_deg([0.0; 7]).ptp_deg([30.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).build();
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// let stop = Arc::new(AtomicBool::new(true));
    /// let mut planner = Planner::new(&path, Timing::default()).interrupted_by(stop);
    /// assert_eq!(Trajectory::by(&mut planner).err(), Some(TimingError::Interrupted));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`plan`](Self::plan), and [`TimingError::Interrupted`].
    pub fn by(planner: &mut Planner) -> Result<Self, TimingError> {
        let sections = planner.collect::<Result<_, _>>()?;
        Ok(Self::from_sections(planner.path().clone(), sections))
    }

    /// That of some sections, in order.
    pub(crate) fn from_sections(path: JointPath, sections: Vec<Section>) -> Self {
        let mut totals = Totals::default();
        for section in &sections {
            totals.add(section);
        }
        Self { path, sections, totals }
    }

    /// The path.
    #[must_use]
    pub fn path(&self) -> &JointPath {
        &self.path
    }

    /// From the start to the end of the last settling, in s.
    #[must_use]
    pub fn cycle_time_s(&self) -> f64 {
        self.totals.cycle_time_s()
    }

    /// Time in motion, in s.
    #[must_use]
    pub fn motion_time_s(&self) -> f64 {
        self.totals.motion_time_s
    }

    /// Where the time goes.
    #[must_use]
    pub fn totals(&self) -> &Totals {
        &self.totals
    }

    /// The parts from stop to stop, in order.
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

    /// What the arm does at `t_s`; before the start it stands there, after the end too. O(log n).
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

    /// What the arm does at every sample at which stamps were found, the end included. Stamps
    /// increase strictly.
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

    /// What the arm does `rate_hz` times a second, from the start to the end: the first sample is at 0, the
    /// last exactly at the cycle time, however far that is from the one before.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::JointPath;
    /// use iiwa_program::Program;
    /// use iiwa_traj::{Timing, Trajectory};
    ///
    /// let program = Program::from_deg([0.0; 7]).ptp_deg([30.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).build();
    /// let path = JointPath::new(&program, &Robot::default())?;
    /// let trajectory = Trajectory::plan(&path, Timing::default())?;
    /// let samples: Vec<_> = trajectory.samples(1000.0).collect();
    /// assert_eq!(samples[1].t_s, 0.001);
    /// assert_eq!(samples.last().unwrap().t_s, trajectory.cycle_time_s());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn samples(&self, rate_hz: f64) -> impl Iterator<Item = State> {
        let end_s = self.cycle_time_s();
        let stamps = (0_u64..).map(move |i| i as f64 / rate_hz);
        let at = |t_s| State { t_s, ..self.at(t_s) };
        stamps.take_while(move |t_s| *t_s < end_s).chain([end_s]).map(at)
    }

    /// The figures of all entries of the program's list of motions, in order.
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

    /// The figures of all blends, in order.
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
    /// The blends before which the arm stops, since the motions after them are not known in time, in order.
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
