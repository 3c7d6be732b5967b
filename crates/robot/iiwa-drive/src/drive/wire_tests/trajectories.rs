//! Random trajectories.

use fastrand::Rng;
use iiwa_kin::Robot;
use iiwa_link::TimedJoints;
use iiwa_path::JointPath;
use iiwa_program::{Blend, Motion, Program, Ptp, Sources, Start, Workcell};
use iiwa_traj::{Timing, Trajectory};

/// Returns motions at full speed between positions anywhere in the joint range, including its ends.
pub(super) fn program(random: &mut Rng) -> Program {
    let range = Robot::default().limits().upper_rad;
    loop {
        let mut place = || range.map(|q| q * (2.6 * random.f64() - 1.3).clamp(-1.0, 1.0));
        let start_rad = place();
        let targets = [place(), place(), place()];
        let mut motions: Vec<_> = targets.map(Ptp::to).into();
        let blend = random.f64() < 0.7;
        for ptp in &mut motions[..2] {
            ptp.blend = blend.then(|| Blend::Fraction(0.5 * random.f64()));
        }
        let motions = motions.into_iter().map(Motion::Ptp).collect();
        let program = Program {
            robot: None,
            start: Start::Joints(start_rad),
            motions,
            workcell: Workcell::default(),
            sources: Sources::default(),
        };
        if JointPath::new(&program, &Robot::default()).is_ok() {
            return program;
        }
    }
}

/// Samples a plan every 4 ms and at its end, as clients do.
pub(super) fn sampled(program: &Program) -> TimedJoints {
    let path = JointPath::new(program, &Robot::default()).unwrap();
    let plan = Trajectory::plan(&path, Timing::jerk_limited()).unwrap();
    let end_s = plan.cycle_time_s();
    let steps = (end_s / 0.004).floor();
    let mut t_s: Vec<f64> = (0..steps as u32).map(|i| f64::from(i) * 0.004).collect();
    t_s.push(end_s);
    let joints_rad = t_s.iter().map(|t_s| plan.at(*t_s).q).collect();
    let trajectory = TimedJoints { t_s, joints_rad };
    trajectory.check(Robot::default().limits(), program.start.joints_rad().unwrap()).unwrap();
    trajectory
}

pub(super) fn trajectories(count: usize) -> Vec<TimedJoints> {
    let mut random = Rng::with_seed(12);
    (0..count).map(|_| sampled(&program(&mut random))).collect()
}
