//! Limits as an observer measures them: by differences of sampled joint positions.

use iiwa_kin::Joints;
use iiwa_program::{LimitKind, MotionLimits};
use iiwa_traj::{State, Trajectory};

/// Returns the largest ratio of `values` to their limits.
#[must_use]
pub fn ratio(values: &Joints, limits: &Joints) -> f64 {
    values.iter().zip(limits).map(|(v, l)| v.abs() / l).fold(0.0, f64::max)
}

/// Returns the largest of several limits.
#[must_use]
pub fn largest<'a>(all: impl Iterator<Item = &'a MotionLimits>, kind: LimitKind) -> Joints {
    all.fold([0.0; 7], |largest, limits| {
        std::array::from_fn(|j| limits.of(kind)[j].max(largest[j]))
    })
}

/// Coefficients of the first to third difference.
const BINOMIAL: [&[f64]; 3] = [&[-1.0, 1.0], &[1.0, -2.0, 1.0], &[-1.0, 3.0, -3.0, 1.0]];

/// Largest ratios to the limits of each kind, by differences of the samples at `rate_hz`.
///
/// If a difference spans several motions, the larger limit applies.
#[must_use]
pub fn ratios(trajectory: &Trajectory, rate_hz: f64) -> [f64; 3] {
    let path = trajectory.path();
    let all: Vec<State> = (0..u32::MAX)
        .map(|i| f64::from(i) / rate_hz)
        .take_while(|t_s| *t_s <= trajectory.cycle_time_s())
        .map(|t_s| trajectory.at(t_s))
        .collect();
    LimitKind::ALL.map(|kind| {
        let factors = BINOMIAL[usize::from(kind.order()) - 1];
        let unit = rate_hz.powi(kind.order().into());
        all.windows(factors.len())
            .map(|states| {
                let difference: Joints = std::array::from_fn(|j| {
                    unit * states.iter().zip(factors).map(|(state, f)| f * state.q[j]).sum::<f64>()
                });
                let steps = states[0].step..=states[states.len() - 1].step;
                ratio(&difference, &largest(steps.map(|step| path.limits_of(step)), kind))
            })
            .fold(0.0, f64::max)
    })
}
