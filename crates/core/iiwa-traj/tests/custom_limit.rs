//! Limits from outside the workspace crates are planned like torque limits, with either timing.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::sync::Arc;

use iiwa_kin::{Joint, Joints, Load, Robot};
use iiwa_path::{JointPath, Step};
use iiwa_program::{Blend, Motion, Program};
use iiwa_traj::{
    Limit, PathLimit, PathRow, Planner, RowLimit, SweepOptions, Timing, TimingError, Trajectory,
};

const TIMINGS: [fn() -> Timing; 3] =
    [Timing::jerk_limited, || Timing::Acceleration(SweepOptions::default()), Timing::default];

/// Largest share of such a limit that a plan may reach.
const MOST: f64 = 1.01;

/// Linear combinations of joint accelerations: for each row a sum with `weights`, from `lower` to
/// `upper`, in rad/s^2.
#[derive(Clone, Debug)]
struct Combinations(Vec<Combination>);

#[derive(Clone, Copy, Debug)]
struct Combination {
    weights: Joints,
    lower: f64,
    upper: f64,
}

impl Combination {
    fn symmetric(weights: Joints, limit: f64) -> Self {
        Self { weights, lower: -limit, upper: limit }
    }

    fn sum(&self, joints: &Joints) -> f64 {
        self.weights.iter().zip(joints).map(|(weight, joint)| weight * joint).sum()
    }

    /// Returns the share of the limits: -1 at the lower one, 1 at the upper one.
    fn share(&self, acceleration_rad_s2: &Joints) -> f64 {
        (2.0 * self.sum(acceleration_rad_s2) - self.lower - self.upper) / (self.upper - self.lower)
    }
}

impl PathLimit for Combinations {
    fn of_step(&self, _: &JointPath, _: usize) -> Option<Box<dyn RowLimit>> {
        Some(Box::new(self.clone()))
    }

    fn limit(&self, _: usize) -> Limit {
        Limit::Other { name: "combination", joint: None }
    }
}

impl RowLimit for Combinations {
    fn row_count(&self) -> usize {
        self.0.len()
    }

    fn rows(&self, _: &[Joints], derivative: &[Joints], second: &[Joints]) -> Vec<PathRow> {
        let row = |combination: &Combination, one: &Joints, two: &Joints| {
            let scale = 2.0 / (combination.upper - combination.lower);
            PathRow {
                acceleration: scale * combination.sum(one),
                square: scale * combination.sum(two),
                offset: -0.5 * scale * (combination.lower + combination.upper),
            }
        };
        let places = derivative.iter().zip(second);
        places
            .flat_map(|(one, two)| self.0.iter().map(move |combination| row(combination, one, two)))
            .collect()
    }
}

/// Acceleration of the flange along the vertical axis, of one motion only, in m/s^2. The trajectory
/// is checked by differences of its positions.
#[derive(Clone, Debug)]
struct Vertical {
    robot: Robot,
    limit_m_s2: f64,
    motion: usize,
}

/// Step of the path parameter for second differences of a position.
const STEP: f64 = 1e-3;

impl Vertical {
    fn height_m(&self, joints_rad: &Joints) -> f64 {
        self.robot.flange_position(joints_rad)[2]
    }
}

impl PathLimit for Vertical {
    fn of_step(&self, path: &JointPath, step: usize) -> Option<Box<dyn RowLimit>> {
        let is_own = path.steps()[step].motion().index() == self.motion;
        is_own.then(|| Box::new(self.clone()) as Box<dyn RowLimit>)
    }

    fn limit(&self, _: usize) -> Limit {
        Limit::Other { name: "vertical", joint: None }
    }
}

impl RowLimit for Vertical {
    fn row_count(&self) -> usize {
        1
    }

    fn rows(&self, joints: &[Joints], derivative: &[Joints], second: &[Joints]) -> Vec<PathRow> {
        let row = |(q, (one, two)): (&Joints, (&Joints, &Joints))| {
            let at = |t: f64| {
                let q = |j| q[j] + t * one[j] + 0.5 * t * t * two[j];
                self.height_m(&std::array::from_fn(q))
            };
            let [before, now, after] = [-STEP, 0.0, STEP].map(at);
            PathRow {
                acceleration: 0.5 * (after - before) / STEP / self.limit_m_s2,
                square: (before - 2.0 * now + after) / (STEP * STEP) / self.limit_m_s2,
                offset: 0.0,
            }
        };
        joints.iter().zip(derivative.iter().zip(second)).map(row).collect()
    }
}

/// Speed of the elbow, in m/s: its square is a multiple of the squared speed along the path.
#[derive(Clone, Debug)]
struct ElbowSpeed {
    robot: Robot,
    limit_m_s: f64,
}

impl ElbowSpeed {
    /// Link whose origin is the elbow.
    const LINK: usize = 4;

    fn moved_m(&self, before_rad: &Joints, after_rad: &Joints) -> f64 {
        let [before, after] =
            [before_rad, after_rad].map(|q| self.robot.link_poses(q)[Self::LINK].position_m);
        (0..3).map(|i| (after[i] - before[i]).powi(2)).sum::<f64>().sqrt()
    }
}

impl PathLimit for ElbowSpeed {
    fn of_step(&self, _: &JointPath, _: usize) -> Option<Box<dyn RowLimit>> {
        Some(Box::new(self.clone()))
    }

    fn limit(&self, _: usize) -> Limit {
        Limit::Other { name: "elbow speed", joint: None }
    }
}

impl RowLimit for ElbowSpeed {
    fn row_count(&self) -> usize {
        1
    }

    fn rows(&self, joints: &[Joints], derivative: &[Joints], _: &[Joints]) -> Vec<PathRow> {
        let row = |(q, one): (&Joints, &Joints)| {
            let at = |t: f64| std::array::from_fn(|j| q[j] + t * one[j]);
            let speed = self.moved_m(&at(-STEP), &at(STEP)) / (2.0 * STEP) / self.limit_m_s;
            PathRow { acceleration: 0.0, square: speed * speed, offset: 0.0 }
        };
        joints.iter().zip(derivative).map(row).collect()
    }
}

fn program() -> Program {
    Program::from_deg([0.0, 30.0, 0.0, -60.0, 0.0, 30.0, 0.0])
        .ptp_deg([20.0, 80.0, 20.0, -30.0, 0.0, 50.0, 10.0])
        .blend(Blend::Fraction(0.3))
        .ptp_deg([60.0, 40.0, -20.0, -80.0, 30.0, 20.0, 90.0])
        .blend(Blend::Fraction(0.4))
        .ptp_deg([10.0, 60.0, 0.0, -20.0, 0.0, 30.0, 0.0])
        .ptp_deg([0.0, 30.0, 0.0, -60.0, 0.0, 30.0, 0.0])
        .build()
}

fn plan(path: &JointPath, timing: Timing, limits: &[Arc<dyn PathLimit>]) -> Trajectory {
    let planner = limits
        .iter()
        .fold(Planner::new(path, timing), |planner, limit| planner.with_limit(Arc::clone(limit)));
    Trajectory::by(&mut { planner }).unwrap()
}

/// Returns the largest share of the limits that a trajectory reaches at 2 kHz.
fn largest(trajectory: &Trajectory, limit: &Combinations) -> f64 {
    let shares = trajectory.samples(2000.0).flat_map(|state| {
        limit.0.iter().map(move |combination| combination.share(&state.ddq).abs())
    });
    shares.fold(0.0, |largest, share| if share <= largest { largest } else { share })
}

/// Returns true if the figures contain a limit of this name.
fn is_named(trajectory: &Trajectory, name: &str) -> bool {
    let mut limits = trajectory.motions().into_iter().flat_map(|motion| motion.limits);
    limits.any(|limit| limit.limit.name() == name)
}

#[test]
fn a_custom_limit_is_kept() {
    let path = JointPath::new(&program(), &Robot::default()).unwrap();
    let sum = [1.0, 0.5, 0.0, -1.0, 0.0, 0.3, 0.2];
    let both = Combination::symmetric(sum, 3.0);
    // A wider range for braking than for acceleration, and vice versa.
    let upwards = Combination { lower: -5.0, upper: 2.0, ..both };
    let downwards = Combination { lower: -2.0, upper: 5.0, ..both };
    for timing in TIMINGS {
        let free = plan(&path, timing(), &[]);
        let mut seconds = Vec::new();
        for combination in [both, upwards, downwards] {
            let limit = Combinations(vec![combination]);
            let limited = plan(&path, timing(), &[Arc::new(limit.clone())]);
            assert!(largest(&free, &limit) > 1.5, "{}", timing().name());
            let reached = largest(&limited, &limit);
            assert!((0.99..MOST).contains(&reached), "{}: {reached}", timing().name());
            assert!(limited.cycle_time_s() > free.cycle_time_s());
            assert!(is_named(&limited, "combination") && !is_named(&free, "combination"));
            for state in limited.samples(1000.0) {
                let limits = path.limits_of(state.step);
                for j in 0..7 {
                    let acceleration = state.ddq[j].abs() / limits.acceleration_rad_s2()[j];
                    let velocity = state.dq[j].abs() / limits.velocity_rad_s()[j];
                    assert!(velocity < 1.002 && acceleration < 1.006, "{velocity} {acceleration}");
                }
            }
            seconds.push(limited.cycle_time_s());
        }
        assert!((seconds[1] - seconds[2]).abs() > 1e-3, "{seconds:?}");
    }
}

/// A limit that never becomes active changes no bit of the plan.
#[test]
fn a_limit_that_binds_nothing_changes_nothing() {
    let path = JointPath::new(&program(), &Robot::default()).unwrap();
    let limit: Arc<dyn PathLimit> =
        Arc::new(Combinations(vec![Combination::symmetric([1.0; 7], 1e3)]));
    for timing in TIMINGS {
        let [free, limited] =
            [plan(&path, timing(), &[]), plan(&path, timing(), std::slice::from_ref(&limit))];
        let bits = |trajectory: &Trajectory| -> Vec<u64> {
            let states = trajectory.states();
            states
                .flat_map(|s| s.q.into_iter().chain(s.dq).chain([s.t_s]))
                .map(f64::to_bits)
                .collect()
        };
        assert_eq!(bits(&free), bits(&limited));
    }
}

/// Further limits in addition to the seven rows of torque limits: one row, which completes a group
/// of eight, and nine rows.
#[test]
fn custom_limits_are_kept_beside_torques() {
    let mut program = program();
    let load = Load { mass_kg: 7.0, center_mm: [0.0, 0.0, 80.0], ..Load::default() };
    program.motions.insert(0, Motion::Load(Some(load.into())));
    program.workcell.torque_limit_rel = Some(0.8);
    let path = JointPath::new(&program, &Robot::default()).unwrap();
    let limits_nm = path.torque_limits_nm().unwrap();
    for timing in TIMINGS {
        let torques_only = plan(&path, timing(), &[]);
        for count in [1, 9] {
            let weights = |k: usize| std::array::from_fn(|j| if j == k % 7 { 1.0 } else { 0.2 });
            let rows = (0..count).map(|k| Combination::symmetric(weights(k), 4.0));
            let limit = Combinations(rows.collect());
            let limited = plan(&path, timing(), &[Arc::new(limit.clone())]);
            let reached = largest(&limited, &limit);
            assert!((0.99..MOST).contains(&reached), "{}: {reached}", timing().name());
            let torques = limited.samples(2000.0).flat_map(|state| {
                let torque_nm = limited.torques_of(&state).torque_nm;
                (0..7).map(move |j| torque_nm[j].abs() / limits_nm[j])
            });
            let torque = torques.fold(0.0, f64::max);
            assert!((0.9..MOST).contains(&torque), "{}: {torque}", timing().name());
            assert!(limited.cycle_time_s() > torques_only.cycle_time_s());
        }
        let rows = vec![Combination::symmetric([1.0; 7], 4.0); 10];
        let mut planner = Planner::new(&path, timing()).with_limit(Arc::new(Combinations(rows)));
        let error = Trajectory::by(&mut planner).err();
        assert_eq!(error, Some(TimingError::TooManyRows { rows: 17, max: 16 }));
    }
}

/// A limit of one motion: segments with and without it follow each other without a stop.
#[test]
fn a_limit_of_one_motion_is_kept_there() {
    let robot = Robot::default();
    let path = JointPath::new(&program(), &robot).unwrap();
    let vertical = Vertical { robot, limit_m_s2: 1.5, motion: 1 };
    for timing in TIMINGS {
        let free = plan(&path, timing(), &[]);
        let limited = plan(&path, timing(), &[Arc::new(vertical.clone())]);
        // Differences over a millisecond, within the steps of the motion.
        let largest = |trajectory: &Trajectory, is_own: bool| {
            let dt_s = 5e-4;
            let states: Vec<_> = trajectory.samples(1.0 / dt_s).collect();
            let jerks = states.windows(3).filter(|three| {
                let is_move = |step: usize| matches!(path.steps()[step], Step::Move { .. });
                let step = three[0].step;
                is_move(step)
                    && three.iter().all(|state| state.step == step)
                    && (three[0].motion.index() == 1) == is_own
            });
            let accelerations = jerks.map(|three| {
                let [a, b, c] = [0, 1, 2].map(|i| vertical.height_m(&three[i].q));
                ((a - 2.0 * b + c) / (dt_s * dt_s)).abs() / vertical.limit_m_s2
            });
            accelerations.fold(0.0, f64::max)
        };
        let reached = largest(&limited, true);
        assert!((0.97..1.012).contains(&reached), "{}: {reached}", timing().name());
        assert!(largest(&free, true) > 1.5 && largest(&limited, false) > 1.5);
        assert!(limited.cycle_time_s() > free.cycle_time_s());
        assert!(is_named(&limited, "vertical"));
    }
}

/// A limit of a speed, whose rows have no acceleration term.
#[test]
fn a_speed_limit_is_kept() {
    let robot = Robot::default();
    let path = JointPath::new(&program(), &robot).unwrap();
    let elbow = ElbowSpeed { robot, limit_m_s: 0.3 };
    for timing in TIMINGS {
        let free = plan(&path, timing(), &[]);
        let limited = plan(&path, timing(), &[Arc::new(elbow.clone())]);
        let largest = |trajectory: &Trajectory| {
            let dt_s = 5e-4;
            let states: Vec<_> = trajectory.samples(1.0 / dt_s).collect();
            let speeds = states.windows(2).map(|two| elbow.moved_m(&two[0].q, &two[1].q) / dt_s);
            speeds.fold(0.0, f64::max) / elbow.limit_m_s
        };
        let [free_share, share] = [&free, &limited].map(largest);
        assert!(free_share > 1.3, "{}: {free_share}", timing().name());
        assert!((0.98..1.005).contains(&share), "{}: {share}", timing().name());
        assert!(limited.cycle_time_s() > free.cycle_time_s());
        assert!(is_named(&limited, "elbow speed"));
    }
}

#[test]
fn they_have_names() {
    let of = |joint| Limit::Other { name: "brake", joint };
    assert_eq!(of(None).to_string(), "brake");
    assert_eq!(of(Some(Joint::A3)).to_string(), "A3 brake");
    assert_eq!(
        (of(Some(Joint::A3)).name(), of(Some(Joint::A3)).joint()),
        ("brake", Some(Joint::A3))
    );
}
