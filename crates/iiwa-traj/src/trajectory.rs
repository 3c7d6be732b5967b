//! A whole trajectory.

use iiwa_path::JointPath;

use crate::{
    figures::{BlendFigures, MotionFigures, Totals},
    planner::Planner,
    section::Section,
    state::State,
    timing::{Timing, TimingError},
};

/// What the arm does at any time from the start of a program to its end.
///
/// It keeps its limits: that is checked before it is handed out.
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
    /// If no stamps were found that keep the limits. This would be a fault of the planner.
    pub fn plan(path: &JointPath, timing: Timing) -> Result<Self, TimingError> {
        let sections: Vec<_> = Planner::new(path, timing).collect::<Result<_, _>>()?;
        let mut totals = Totals::default();
        for section in &sections {
            totals.add(section);
        }
        Ok(Self { path: path.clone(), sections, totals })
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
                motion: 0,
            },
        }
    }

    /// What the arm does at every sample at which stamps were found, the end included. Stamps
    /// increase strictly.
    pub fn states(&self) -> impl Iterator<Item = State> {
        let end = self.sections.last().map(|section| section.at(section.end_s()));
        self.sections.iter().flat_map(Section::states).chain(end)
    }

    /// The figures of all entries of the program's list of motions, in order.
    #[must_use]
    pub fn motions(&self) -> Vec<MotionFigures> {
        self.sections.iter().flat_map(Section::motions).collect()
    }

    /// The figures of all blends, in order.
    #[must_use]
    pub fn blends(&self) -> Vec<BlendFigures> {
        self.sections.iter().flat_map(Section::blends).collect()
    }
}
