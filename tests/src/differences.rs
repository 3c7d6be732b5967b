//! Limits as an observer sees them: by differences of sampled joint positions.

use iiwa_kin::Joints;
use iiwa_path::MotionLimits;
use iiwa_traj::{State, Trajectory};

/// The largest of `values` over their limits.
#[must_use]
pub fn ratio(values: &Joints, limits: &Joints) -> f64 {
    values.iter().zip(limits).map(|(v, l)| v.abs() / l).fold(0.0, f64::max)
}

/// Factors of the samples in the first to third difference.
const BINOMIAL: [&[f64]; 3] = [&[-1.0, 1.0], &[1.0, -2.0, 1.0], &[-1.0, 3.0, -3.0, 1.0]];

/// Largest ratios of velocity, acceleration and jerk to their limits, by differences of the samples
/// at `rate_hz`.
///
/// Where motions meet within a difference, the larger limit counts.
#[must_use]
pub fn ratios(trajectory: &Trajectory, rate_hz: f64) -> [f64; 3] {
    let limits = trajectory.path().limits();
    let all: Vec<State> = (0..u32::MAX)
        .map(|i| f64::from(i) / rate_hz)
        .take_while(|t_s| *t_s <= trajectory.cycle_time_s())
        .map(|t_s| trajectory.at(t_s))
        .collect();
    let largest = |states: &[State], of: fn(&MotionLimits) -> &Joints| -> Joints {
        std::array::from_fn(|j| {
            let [first, last] = [0, states.len() - 1].map(|i| states[i].motion.index());
            limits[first..=last].iter().map(|limits| of(limits)[j]).fold(0.0, f64::max)
        })
    };
    let of: [fn(&MotionLimits) -> &Joints; 3] =
        [|l| &l.velocity_rad_s, |l| &l.acceleration_rad_s2, |l| &l.jerk_rad_s3];
    std::array::from_fn(|order| {
        let factors = BINOMIAL[order];
        let unit = [rate_hz, rate_hz.powi(2), rate_hz.powi(3)][order];
        all.windows(factors.len())
            .map(|states| {
                let difference: Joints = std::array::from_fn(|j| {
                    unit * states.iter().zip(factors).map(|(state, f)| f * state.q[j]).sum::<f64>()
                });
                ratio(&difference, &largest(states, of[order]))
            })
            .fold(0.0, f64::max)
    })
}
