//! Plans a motion program and prints the duration of each motion: `plan [PROGRAM.json]`.

use std::error::Error;
use std::io::{Write, stdout};

use iiwa::prelude::*;

/// Three motions; the first target is blended within 100 mm.
const PROGRAM: &str = r#"{
    "version": 1,
    "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
    "motions": [
        { "type": "ptp", "joints_deg": [0, 42, 0, -44, 0, 90, 0], "blend": { "cart_mm": 100 } },
        { "type": "ptp", "joints_deg": [40, 42, 0, -80, 0, 60, 0], "velocity_rel": 0.5 },
        { "type": "wait", "seconds": 0.5 },
        { "type": "ptp", "joints_deg": [0, 42, 0, -44, 0, 90, 0] }
    ]
}"#;

fn main() -> Result<(), Box<dyn Error>> {
    let text = match std::env::args_os().nth(1) {
        Some(file) => std::fs::read_to_string(file)?,
        None => PROGRAM.to_owned(),
    };

    let program = Program::from_json(&text)?;
    let path = JointPath::new(&program, &Robot::lbr_iiwa_7_r800())?;
    let trajectory = Trajectory::plan(&path, Timing::default())?;

    let mut out = stdout();
    for figures in trajectory.motions() {
        let (start_s, end_s) = (figures.start_s, figures.end_s);
        writeln!(out, "motion {}: {start_s:.3} s to {end_s:.3} s", figures.motion)?;
    }
    writeln!(out, "cycle time {:.3} s", trajectory.cycle_time_s())?;
    Ok(())
}
