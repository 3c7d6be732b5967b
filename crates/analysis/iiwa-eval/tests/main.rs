//! Comparison and identification on virtual recordings.

mod compare;
mod compare_soft_ramps;
mod compare_torques;
mod identify;
mod identify_load;
mod identify_ramps;
mod identify_tcp;
mod load_effect;
mod plan_difference;
mod tape;
