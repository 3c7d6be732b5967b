//! Experiments: the programs of each, and its report.

use iiwa_eval::experiment::{self, TcpSeries, Trial};

use crate::ExperimentError;

use super::{
    bench::{Bench, TrialRun},
    blends,
    chapter::Chapter,
    cycle_time, limits, load, settle, tcp_blends, zone_velocity,
};

/// Share of full speed for section 4.2; the thesis does not state its value. The path does not
/// depend on it.
const BLENDS_VELOCITY_REL: f64 = 0.5;

/// Experiment of the thesis (Larsen 2019), or of this project.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExperimentKind {
    /// Joint limits (Appendix A).
    Limits,
    /// Blend curve (sections 4.2 and 4.3).
    Blends,
    /// Velocity in blends (Appendix B).
    ZoneVelocity,
    /// Settle time (Appendix C).
    Settle,
    /// Cycle time errors (section 5.1.2).
    CycleTime,
    /// Blends of TCP paths: not in the thesis.
    TcpBlends,
    /// Influence of the load on the planner: not in the thesis, and not in [`ALL`](Self::ALL),
    /// since a person must mount the load.
    Load,
}

impl ExperimentKind {
    /// All experiments that run unattended, in the order of the report.
    pub const ALL: [Self; 6] = [
        Self::Limits,
        Self::Blends,
        Self::ZoneVelocity,
        Self::Settle,
        Self::CycleTime,
        Self::TcpBlends,
    ];

    /// Returns the programs of the experiment.
    #[must_use]
    pub fn trials(self, bench: &Bench) -> Vec<Trial> {
        let Bench { model, seed, .. } = bench;
        let count = |upper: usize| bench.count.unwrap_or(upper).min(upper);
        match self {
            Self::Limits => {
                let mut trials = experiment::limits();
                let wide = trials.pop();
                trials.truncate(count(trials.len()));
                trials.extend(wide);
                trials
            }
            Self::Blends => vec![experiment::blends(BLENDS_VELOCITY_REL)],
            Self::ZoneVelocity => vec![experiment::zone_velocity()],
            Self::Settle => vec![experiment::settle(model, count(200), *seed)],
            Self::CycleTime => cycle_time::trials(bench, count(5)),
            Self::TcpBlends => vec![experiment::tcp_blends(&TcpSeries::ALL)],
            Self::Load => experiment::load(&bench.load).into(),
        }
    }

    /// Returns true for experiments of the thesis.
    #[must_use]
    pub fn is_of_thesis(self) -> bool {
        !matches!(self, Self::TcpBlends | Self::Load)
    }

    /// Returns the instruction for manual work at the flange before a program runs, if any.
    #[must_use]
    pub fn to_mount(self, trial: &Trial) -> Option<String> {
        let load = trial.program.loads().first().copied().flatten();
        (self == Self::Load).then(|| match load {
            None => "Take all off the flange, and have no load configured".to_owned(),
            Some(load) => format!(
                "Mount {} kg with its centre at {:?} mm of the flange",
                load.mass_kg, load.center_mm
            ),
        })
    }

    /// Sample rate of a virtual robot in Hz: high enough to show the phases of constant jerk.
    #[must_use]
    pub fn rate_hz(self) -> f64 {
        if self == Self::CycleTime { 200.0 } else { 1000.0 }
    }

    /// Reports on the recordings.
    ///
    /// # Errors
    ///
    /// [`ExperimentError`] if the recordings do not show the subject of the experiment, or a figure
    /// cannot be drawn.
    pub fn chapter(self, bench: &Bench, runs: &[TrialRun]) -> Result<Chapter, ExperimentError> {
        match self {
            Self::Limits => limits::chapter(bench, runs),
            Self::Blends => blends::chapter(bench, runs),
            Self::ZoneVelocity => zone_velocity::chapter(bench, runs),
            Self::Settle => settle::chapter(bench, runs),
            Self::CycleTime => cycle_time::chapter(bench, runs),
            Self::TcpBlends => tcp_blends::chapter(bench, runs),
            Self::Load => load::chapter(bench, runs),
        }
    }
}
