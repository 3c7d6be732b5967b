//! Files of plans and recordings, written, read back, and damaged.

mod joint_log;
mod plan_record;
mod plan_size;
mod plan_torques;
mod recording;
mod tools;
mod unchanged_motion;
