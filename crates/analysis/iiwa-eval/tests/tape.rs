//! Recordings simulated from plans.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use fastrand::Rng;
use iiwa_kin::Robot;
use iiwa_log::JointLog;
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_traj::{Timing, Trajectory};

/// Plans a program for the LBR iiwa 7.
pub(crate) fn trajectory(program: &str, timing: Timing) -> Trajectory {
    let program = Program::from_json(program).unwrap();
    let path = JointPath::new(&program, &Robot::lbr_iiwa_7_r800()).unwrap();
    Trajectory::plan(&path, timing).unwrap()
}

/// Parameters of a recording of a trajectory.
#[derive(Clone, Copy)]
pub(crate) struct Tape {
    pub(crate) rate_hz: f64,
    /// Clock time at the start of the program.
    pub(crate) clock_s: f64,
    /// Rest before and after the program.
    pub(crate) before_s: f64,
    pub(crate) after_s: f64,
    pub(crate) noise_rad: f64,
    /// Share of the samples that are lost.
    pub(crate) dropped: f64,
    /// Factor by which the robot is slower.
    pub(crate) section: f64,
    /// Start of the program between two samples, as a share of the time between them.
    pub(crate) phase: f64,
    /// Offset of all positions.
    pub(crate) shift_rad: [f64; 7],
}

impl Default for Tape {
    fn default() -> Self {
        Self {
            rate_hz: 1000.0,
            clock_s: 0.0,
            before_s: 0.0,
            after_s: 0.0,
            noise_rad: 0.0,
            dropped: 0.0,
            section: 1.0,
            phase: 0.0,
            shift_rad: [0.0; 7],
        }
    }
}

impl Tape {
    pub(crate) fn record(&self, trajectory: &Trajectory, rng: &mut Rng) -> JointLog {
        let (mut t_s, mut q_rad) = (Vec::new(), Vec::new());
        let end_s = self.before_s + self.section * trajectory.cycle_time_s() + self.after_s;
        let mut normal = || (0..12).map(|_| rng.f64()).sum::<f64>() - 6.0;
        for k in 0.. {
            let t = (f64::from(k) + self.phase) / self.rate_hz;
            if t > end_s + 1e-9 {
                break;
            }
            let q = trajectory.at((t - self.before_s) / self.section).q;
            t_s.push(self.clock_s + t);
            q_rad.push(std::array::from_fn(|j| {
                q[j] + self.shift_rad[j] + self.noise_rad * normal()
            }));
        }
        let keep: Vec<_> = t_s.iter().map(|_| rng.f64() >= self.dropped).collect();
        let mut kept = keep.iter();
        t_s.retain(|_| *kept.next().unwrap());
        let mut kept = keep.iter();
        q_rad.retain(|_| *kept.next().unwrap());
        JointLog::new(t_s, q_rad)
    }
}
