//! Limits of a path other than velocity, acceleration and jerk limits, and their usage.

use std::{ops::Range, sync::Arc};

use iiwa_kin::Joints;
use iiwa_path::JointPath;
use iiwa_solver::RowLimits;

use crate::{
    limit::Limit,
    path_limit::{MAX_RAD, PathLimit},
    section::Section,
    state::State,
    timing::TimingError,
    torque_limit::TorqueLimit,
};

/// All limits for planning a path, except velocity, acceleration and jerk limits.
#[derive(Clone, Debug)]
pub(crate) struct PathLimits(Vec<Arc<dyn PathLimit>>);

/// All these limits along one step.
#[derive(Debug, Default)]
pub(crate) struct StepLimits {
    pub(crate) rows: RowLimits,
    /// Limit of each row.
    pub(crate) limits: Vec<Limit>,
}

impl Default for PathLimits {
    fn default() -> Self {
        Self(vec![Arc::new(TorqueLimit)])
    }
}

impl PathLimits {
    pub(crate) fn add(&mut self, limit: Arc<dyn PathLimit>) {
        self.0.push(limit);
    }

    /// Returns true if any of the limits applies to a step.
    pub(crate) fn limit_step(&self, path: &JointPath, step: usize) -> bool {
        self.0.iter().any(|limit| limit.of_step(path, step).is_some())
    }

    /// Returns the limits of `steps`, one entry for each; empty if none of the steps is limited.
    pub(crate) fn of_steps(&self, path: &JointPath, steps: Range<usize>) -> Vec<StepLimits> {
        let limits: Vec<_> = steps.map(|step| self.of_step(path, step)).collect();
        if limits.iter().all(|step_limits| step_limits.limits.is_empty()) {
            Vec::new()
        } else {
            limits
        }
    }

    fn of_step(&self, path: &JointPath, step: usize) -> StepLimits {
        let (mut rows, mut limits) = (Vec::new(), Vec::new());
        for kind in &self.0 {
            if let Some(step_rows) = kind.of_step(path, step) {
                limits.extend((0..step_rows.row_count()).map(|row| kind.limit(row)));
                rows.push(step_rows);
            }
        }
        StepLimits { rows: RowLimits::new(rows), limits }
    }

    /// Checks that all limits can be kept along a path.
    pub(crate) fn check(&self, path: &JointPath) -> Result<(), TimingError> {
        self.0.iter().try_for_each(|limit| limit.check(path))
    }
}

/// Returns the largest share of a further limit in a section; `limits` are those of its moves, of
/// which the first is `first_step`.
///
/// The shares are computed at the start of spans and, if the acceleration jumps there
/// (`acceleration_jumps`), also at their ends.
pub(crate) fn largest_share(
    section: &Section,
    first_step: usize,
    limits: &[StepLimits],
    acceleration_jumps: bool,
) -> f64 {
    if acceleration_jumps {
        largest_at(&[0.0, 1.0], section, first_step, limits)
    } else {
        largest_at(&[0.0], section, first_step, limits)
    }
}

fn largest_at<const N: usize>(
    shares: &[f64; N],
    section: &Section,
    first_step: usize,
    limits: &[StepLimits],
) -> f64 {
    let mut largest = 0.0;
    for piece in section.pieces().iter().filter(|piece| piece.kind.moves()) {
        let rows = &limits[piece.step - first_step].rows;
        if rows.count() == 0 {
            continue;
        }
        let spans = section.spans_of(piece, shares, MAX_RAD);
        let states: Vec<_> = spans.flat_map(|(_, states)| states).collect();
        let all = |part: fn(&State) -> Joints| states.iter().map(part).collect::<Vec<_>>();
        let [q, dq, ddq] = [all(|state| state.q), all(|state| state.dq), all(|state| state.ddq)];
        for share in rows.shares(&q, &dq, &ddq) {
            // NaN counts as above any limit.
            largest = if share.abs() <= largest { largest } else { share.abs() };
        }
    }
    largest
}
