//! Client trajectories: planned trajectories are accepted, infeasible ones are refused, and the
//! interpolation between the points follows the planned motion.

#![expect(clippy::unwrap_used, clippy::expect_used, reason = "these are tests")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts are small and positive"
)]

mod arbitrary_input;
mod interpolation;
mod limits;
mod planned;
mod ramp;
mod sampled;
mod well_formed;
