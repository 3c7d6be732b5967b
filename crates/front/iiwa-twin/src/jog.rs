//! Jogging of a simulated robot, joint by joint.

use std::time::Duration;

use iiwa_kin::Joint;
use iiwa_link::message::{Request, RunLabel};

use crate::{
    Setup,
    run::{motion_to, position_when_idle},
};

/// Time limit of a step: many times its duration.
const LIMIT: Duration = Duration::from_mins(2);

/// Longest step, in degrees.
const MAX_STEP_DEG: f64 = 45.0;

/// Turns a joint, 1 to 7, by a step; returns after the motion. Errors are shown on the page.
/// `is_stopped` is called immediately before the motion.
pub(crate) fn jog(
    joint: usize,
    step_deg: f64,
    setup: &Setup,
    is_stopped: impl FnOnce() -> bool,
) -> Result<(), String> {
    let Some(name) = joint.checked_sub(1).and_then(|index| Joint::ALL.get(index)) else {
        return Err(format!("unknown joint {joint}"));
    };
    if !step_deg.is_finite() || step_deg.abs() > MAX_STEP_DEG {
        return Err(format!("a step of {step_deg} deg; it has to be {MAX_STEP_DEG} deg at most"));
    }
    let mut client = setup.client().map_err(|error| setup.words(&error))?;
    let status = client.state().map_err(|error| error.to_string())?;
    if !status.simulated {
        return Err("the robot is not a simulated one: its joints are not turned from here".into());
    }
    let from_rad = position_when_idle(&status, setup)?;
    let mut to_rad = from_rad;
    to_rad[name.index()] += step_deg.to_radians();
    setup.robot.limits().check(&to_rad).map_err(|outside| outside.to_string())?;
    let motion = motion_to(to_rad, from_rad, setup)
        .map_err(|why| format!("joint {name} is not turned: {why}"))?;
    if is_stopped() {
        return Err("a stop was requested meanwhile".into());
    }
    let request = Request::motions(vec![motion]).labelled(RunLabel::of_robot(&setup.robot));
    client.run(&request, Some(LIMIT)).map(drop).map_err(|error| error.to_string())
}
