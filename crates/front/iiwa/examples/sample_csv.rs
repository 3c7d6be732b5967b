//! Samples a trajectory at 1 kHz as CSV: time, joint positions and flange position.

use std::error::Error;
use std::io::{BufWriter, Write, stdout};

use iiwa::prelude::*;

const PERIOD_S: f64 = 1e-3;

fn main() -> Result<(), Box<dyn Error>> {
    let robot = Robot::lbr_iiwa_7_r800();
    let program = Program {
        robot: None,
        start: Start::Joints([0.0; 7]),
        motions: vec![Motion::Ptp(Ptp::to([0.3, 0.5, 0.0, -1.0, 0.0, 0.8, 0.0]))],
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let path = JointPath::new(&program, &robot)?;
    let trajectory = Trajectory::plan(&path, Timing::default())?;

    let mut out = BufWriter::new(stdout().lock());
    writeln!(out, "t_s,q1,q2,q3,q4,q5,q6,q7,x_m,y_m,z_m")?;
    // Multiples of the period; repeated addition would accumulate rounding errors.
    let times_s = (0_u32..).map(|sample| f64::from(sample) * PERIOD_S);
    for t_s in times_s.take_while(|t_s| *t_s <= trajectory.cycle_time_s()) {
        let q = trajectory.at(t_s).q;
        let [x, y, z] = robot.flange_pose(&q).position_m;
        write!(out, "{t_s:.3}")?;
        for value in q.iter().chain(&[x, y, z]) {
            write!(out, ",{value:.6}")?;
        }
        writeln!(out)?;
    }
    out.flush()?;
    Ok(())
}
