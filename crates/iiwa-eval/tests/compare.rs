//! Recordings made up from plans, and what is found in them.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use fastrand::Rng;
use iiwa_eval::{CompareError, Comparison, Plan, compare};
use iiwa_kin::Robot;
use iiwa_log::JointLog;
use iiwa_path::{Path, Program};
use iiwa_traj::{JerkOptions, SweepOptions, Timing, Trajectory};

const FIXTURES: [&str; 3] = [
    include_str!("../../../fixtures/appendix-b.json"),
    include_str!("../../../fixtures/ten-motions.json"),
    include_str!("../../../fixtures/waits-and-stops.json"),
];

/// Joint 1 by 40 degrees and stop.
const LINE: &str = r#"{ "version": 1, "start": { "joints_deg": [-20, 0, 0, -60, 0, 90, 0] },
    "motions": [{ "type": "ptp", "joints_deg": [20, 0, 0, -60, 0, 90, 0] }] }"#;

fn jerk() -> Timing {
    Timing::Jerk(JerkOptions::default())
}

fn acceleration() -> Timing {
    Timing::Acceleration(SweepOptions::default())
}

fn trajectory(program: &str, timing: Timing) -> Trajectory {
    let program = Program::from_json(program).unwrap();
    let path = Path::new(&program, &Robot::lbr_iiwa_7_r800()).unwrap();
    Trajectory::plan(&path, timing).unwrap()
}

/// A recording of a trajectory.
#[derive(Clone, Copy)]
struct Tape {
    rate_hz: f64,
    /// The clock at the start of the program.
    clock_s: f64,
    /// Standing before and after the program.
    before_s: f64,
    after_s: f64,
    noise_rad: f64,
    /// Share of the samples that are lost.
    dropped: f64,
    /// Slower by this factor.
    stretch: f64,
    /// The start of the program between two samples, as a share of the time between them.
    phase: f64,
    /// Added to all positions.
    shift_rad: [f64; 7],
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
            stretch: 1.0,
            phase: 0.0,
            shift_rad: [0.0; 7],
        }
    }
}

impl Tape {
    fn record(&self, trajectory: &Trajectory, rng: &mut Rng) -> JointLog {
        let (mut t_s, mut q_rad) = (Vec::new(), Vec::new());
        let end_s = self.before_s + self.stretch * trajectory.cycle_time_s() + self.after_s;
        let mut normal = || (0..12).map(|_| rng.f64()).sum::<f64>() - 6.0;
        for k in 0.. {
            let t = (f64::from(k) + self.phase) / self.rate_hz;
            if t > end_s + 1e-9 {
                break;
            }
            let q = trajectory.at((t - self.before_s) / self.stretch).q;
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

fn compared(trajectory: &Trajectory, tape: Tape) -> Comparison {
    let log = tape.record(trajectory, &mut Rng::with_seed(7));
    compare(&Plan::from_trajectory(trajectory), &log).unwrap()
}

#[test]
#[ignore = "prints figures"]
fn survey() {
    let tapes = [
        ("clean 1 kHz", Tape::default()),
        ("clean 250 Hz", Tape { rate_hz: 250.0, ..Tape::default() }),
        (
            "clean 100 Hz, pauses",
            Tape { rate_hz: 100.0, before_s: 1.0, after_s: 1.0, ..Tape::default() },
        ),
        ("pauses, phase", Tape { before_s: 1.2, after_s: 2.0, phase: 0.37, ..Tape::default() }),
        ("noise 1 kHz, no pause", Tape { noise_rad: 1e-5, ..Tape::default() }),
        (
            "noise 1 kHz",
            Tape { noise_rad: 1e-5, before_s: 1.2, after_s: 2.0, phase: 0.37, ..Tape::default() },
        ),
        (
            "noise 250 Hz",
            Tape {
                noise_rad: 1e-5,
                rate_hz: 250.0,
                before_s: 1.2,
                after_s: 2.0,
                phase: 0.37,
                ..Tape::default()
            },
        ),
        (
            "noise 100 Hz",
            Tape {
                noise_rad: 1e-5,
                rate_hz: 100.0,
                before_s: 1.2,
                after_s: 2.0,
                phase: 0.37,
                ..Tape::default()
            },
        ),
        (
            "noise, 10 % dropped",
            Tape {
                noise_rad: 1e-5,
                dropped: 0.1,
                before_s: 1.2,
                after_s: 2.0,
                phase: 0.37,
                ..Tape::default()
            },
        ),
        (
            "noise, stretched",
            Tape {
                noise_rad: 1e-5,
                stretch: 1.03,
                before_s: 1.2,
                after_s: 2.0,
                phase: 0.37,
                ..Tape::default()
            },
        ),
        (
            "noise 1e-4",
            Tape { noise_rad: 1e-4, before_s: 1.2, after_s: 2.0, phase: 0.37, ..Tape::default() },
        ),
    ];
    for (name, tape) in tapes {
        for (fixture, text) in FIXTURES.iter().chain([&LINE]).enumerate() {
            for (timing, planned) in [("jerk", jerk()), ("acc", acceleration())] {
                for (other, measured) in [("jerk", jerk()), ("acc", acceleration())] {
                    let plan = Plan::from_trajectory(&trajectory(text, planned));
                    let real = trajectory(text, measured);
                    let mut worst = [0.0_f64; 4];
                    for seed in 0..5 {
                        let log = tape.record(&real, &mut Rng::with_seed(seed));
                        let c = match compare(&plan, &log) {
                            Ok(c) => c,
                            Err(e) => {
                                println!("{name} {fixture} {timing} {other}: {e}");
                                continue;
                            }
                        };
                        let stretched = 1.0
                            + (tape.stretch - 1.0)
                                * (1.0 - c.cycle_time.standing_s / real.cycle_time_s());
                        let miss = c.cycle_time.real_s - stretched * real.cycle_time_s();
                        let motion = c
                            .motions
                            .iter()
                            .zip(real.motions())
                            .map(|(c, r)| {
                                c.real_s.map_or(0.0, |s| {
                                    (s - tape.stretch * (r.end_s - r.start_s)).abs()
                                })
                            })
                            .fold(0.0, f64::max);
                        let stop = c
                            .stops
                            .iter()
                            .map(|s| {
                                s.real_s.map_or(9.0, |r| (r - tape.stretch * s.planned_s).abs())
                            })
                            .fold(0.0, f64::max);
                        for (w, v) in worst.iter_mut().zip([
                            miss.abs(),
                            motion,
                            stop,
                            c.cycle_time.deviation_s,
                        ]) {
                            *w = w.max(v);
                        }
                        if seed == 0 {
                            print!("{:?} ", c.losses.len());
                        }
                        if seed == 4 {
                            println!(
                                "{name:24} {fixture} plan {timing:4} real {other:4}: cycle {:9.2e} motion {:9.2e} stop {:9.2e} (1 sigma {:9.2e}) joints {:.1e} {:.1e} tcp mm {:.1e} {:.1e} noise {:.1e}",
                                worst[0],
                                worst[1],
                                worst[2],
                                worst[3],
                                c.joints_rad.mean,
                                c.joints_rad.max,
                                1e3 * c.tcp_m.mean,
                                1e3 * c.tcp_m.max,
                                c.noise_rad
                            );
                        }
                    }
                }
            }
        }
    }
}
