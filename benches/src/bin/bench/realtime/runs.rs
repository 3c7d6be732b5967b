//! Trajectories that run during the measurement.

use std::{
    thread,
    time::{Duration, Instant},
};

use iiwa_kin::Robot;
use iiwa_link::{Client, Remote, TimedJoints};
use iiwa_path::JointPath;
use iiwa_program::{Blend, Motion, Program, Ptp, Sources, Start, Workcell};
use iiwa_traj::{Timing, Trajectory};
use iiwasim_benches::Result;

use super::sockets::Sockets;

/// Runs of trajectories, set-point by set-point.
#[derive(Default)]
pub(crate) struct Runs {
    pub(crate) begun: u64,
    pub(crate) done: u64,
    /// Reason for the last aborted run.
    pub(crate) error: String,
}

/// Runs trajectories for this time, with pauses of a second.
pub(crate) fn run_trajectories(sockets: &Sockets, time: Duration) -> Result<Runs> {
    let end = Instant::now() + time;
    let pause = Duration::from_secs(1);
    let trajectory = there_and_back()?;
    let duration = Duration::from_secs_f64(trajectory.duration_s());
    let mut client = Client::new(&Remote::open(), &sockets.instructions)?;
    let mut runs = Runs::default();
    loop {
        let left = end.saturating_duration_since(Instant::now());
        // A trajectory that begins must end in time.
        if left < pause + duration + pause {
            thread::sleep(left);
            return Ok(runs);
        }
        thread::sleep(pause);
        runs.begun += 1;
        match client.run_trajectory(trajectory.clone(), Some(duration + Duration::from_secs(10))) {
            Ok(_) => runs.done += 1,
            Err(error) => {
                runs.error = error.to_string();
                go_back(&mut client, end);
            }
        }
    }
}

/// Moves to the start of the trajectories, as soon as the robot can.
fn go_back(client: &mut Client, end: Instant) {
    while Instant::now() + Duration::from_secs(5) < end {
        let back = vec![Motion::Ptp(Ptp::to([0.0; 7]))];
        if client.run_motions(back, Some(Duration::from_secs(10))).is_ok() {
            return;
        }
        thread::sleep(Duration::from_millis(100));
    }
}

/// Returns a trajectory that ends where it begins, with stamps 4 ms apart.
fn there_and_back() -> Result<TimedJoints> {
    const STEP_S: f64 = 0.004;
    let to = |deg: [f64; 7]| Ptp::to(deg.map(f64::to_radians));
    let motions = vec![
        Motion::Ptp(to([40.0, 30.0, 0.0, -60.0, 0.0, 40.0, 0.0]).blend(Blend::Fraction(0.25))),
        Motion::Ptp(to([-40.0, 20.0, 10.0, -80.0, 20.0, 50.0, 90.0])),
        Motion::Ptp(to([0.0; 7])),
    ];
    let program = Program {
        robot: None,
        start: Start::Joints([0.0; 7]),
        motions,
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let path = JointPath::new(&program, &Robot::default())?;
    let plan = Trajectory::plan(&path, Timing::default())?;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some thousands")]
    let count = (plan.cycle_time_s() / STEP_S).ceil() as u32;
    let t_s: Vec<f64> =
        (0..=count).map(|i| (f64::from(i) * STEP_S).min(plan.cycle_time_s())).collect();
    let joints_rad = t_s.iter().map(|t_s| plan.at(*t_s).q).collect();
    Ok(TimedJoints { t_s, joints_rad })
}
