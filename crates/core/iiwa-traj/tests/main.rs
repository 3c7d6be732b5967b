//! Time parameterisation: closed forms, sweep, jerk-limited timing, batches, playback.

mod batch;
mod cartesian_figures;
mod custom_limit;
mod interrupt;
mod jerk;
mod overlap;
mod pauses;
mod playback;
mod recorded;
mod rest_ramps;
mod segment;
mod speed_override;
mod spline_speed;
mod stamps;
mod sunrise;
mod t1;
mod threads;
mod tool_limits;
