//! Finds the stamps of a path, one section at a time.

use std::sync::{Arc, atomic::AtomicBool};

use iiwa_kin::Joints;
use iiwa_path::{JointPath, Step};

use crate::{
    jerk,
    section::Section,
    section_sweep::{Moves, SAMPLES_BEFORE_JERK, Scratch, sweep_moves},
    timing::{JerkOptions, Timing, TimingError},
};

/// Plans a path section by section: an iterator that needs memory for one of them only.
///
/// ```
/// use iiwa_kin::Robot;
/// use iiwa_path::JointPath;
/// use iiwa_program::{Blend, Program};
/// use iiwa_traj::{Planner, Timing};
///
/// let program = Program::from_deg([0.0; 7])
///     .ptp_deg([40.0, 0.0, 0.0, -60.0, 0.0, 0.0, 0.0])
///     .blend(Blend::Fraction(0.3))
///     .ptp_deg([40.0, 30.0, 0.0, -30.0, 0.0, 0.0, 0.0])
///     .build();
/// let path = JointPath::new(&program, &Robot::default())?;
/// let mut cycle_time_s = 0.0;
/// for section in Planner::new(&path, Timing::default()) {
///     // Written, sent or dropped before the next one is planned.
///     cycle_time_s = section?.end_s();
/// }
/// assert!(cycle_time_s > 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Planner {
    path: JointPath,
    jerk: Option<JerkOptions>,
    /// The next of the path's steps.
    step: usize,
    time_s: f64,
    rest_rad: Joints,
    scratch: Scratch,
    /// Whether it is to stop.
    stop: Arc<AtomicBool>,
}

impl Planner {
    /// A planner for `path`.
    #[must_use]
    pub fn new(path: &JointPath, timing: Timing) -> Self {
        let (samples, jerk) = match timing {
            Timing::Acceleration(options) => (options.samples.max(2), None),
            Timing::Jerk(options) => (SAMPLES_BEFORE_JERK, Some(options)),
        };
        Self {
            path: path.clone(),
            jerk,
            step: 0,
            time_s: 0.0,
            rest_rad: *path.start_rad(),
            scratch: Scratch::new(samples),
            stop: Arc::default(),
        }
    }

    /// The path.
    #[must_use]
    pub fn path(&self) -> &JointPath {
        &self.path
    }

    /// Begins again, with `path`, in the memory that it has.
    pub(crate) fn restart(&mut self, path: &JointPath) {
        (self.path, self.rest_rad) = (path.clone(), *path.start_rad());
        (self.step, self.time_s) = (0, 0.0);
    }

    /// Ends in [`TimingError::Interrupted`] soon after `stop` is set, in the middle of a section as well.
    #[must_use]
    pub fn interrupted_by(mut self, stop: Arc<AtomicBool>) -> Self {
        self.stop = stop;
        self
    }

    /// Share of the path's steps that are planned, 0 to 1.
    #[must_use]
    pub fn progress(&self) -> f64 {
        self.step as f64 / self.path.steps().len().max(1) as f64
    }
}

impl Iterator for Planner {
    type Item = Result<Section, TimingError>;

    fn next(&mut self) -> Option<Self::Item> {
        let steps = self.path.steps();
        let first = self.step;
        let rest = first + steps[first..].iter().take_while(|step| step.moves()).count();
        let end = rest + steps[rest..].iter().take_while(|step| !step.moves()).count();
        if first == end {
            return None;
        }
        self.step = end;
        let mut section = Section {
            path: self.path.clone(),
            start_s: self.time_s,
            rest_rad: match steps[first..rest].last() {
                Some(Step::Move { segment, .. }) => segment.at(1.0).q,
                _ => self.rest_rad,
            },
            pieces: Vec::with_capacity(end - first),
            nodes: Vec::new(),
        };
        let moves = Moves { steps: first..rest, ends: [None; 2] };
        let mut result = sweep_moves(&moves, &mut self.scratch, &self.stop, &mut section);
        if let Some(options) = self.jerk {
            result = result.and_then(|()| jerk::limit(&mut section, options, &self.stop));
        }
        if let Err(error) = result {
            self.step = steps.len();
            return Some(Err(error));
        }
        for step in rest..end {
            section.rest(step);
        }
        self.time_s = section.end_s();
        self.rest_rad = section.rest_rad;
        Some(Ok(section))
    }
}
