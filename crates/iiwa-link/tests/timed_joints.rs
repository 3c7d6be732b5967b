//! Trajectories of clients: what a planner makes is taken, what no robot should do is refused, and
//! between the points the arm goes where it was planned to.

#![expect(clippy::unwrap_used, clippy::expect_used, reason = "these are tests")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts are small and positive"
)]

use std::time::Instant;

use iiwa_kin::{Joints, Robot};
use iiwa_link::{
    MAX_POINTS, START_TOLERANCE_RAD, TimedJoints,
    message::{Code, Refusal, Request},
};
use iiwa_path::{Blend, JointPath, Motion, Program, Ptp};
use iiwa_traj::{Timing, Trajectory};
use proptest::prelude::*;

/// Programs with full and slow motions, long and tiny ones, with blends and waits.
fn programs() -> impl Strategy<Value = Program> {
    let size = prop_oneof![4 => Just(1.2), 3 => Just(0.3), 1 => Just(1e-3), 1 => Just(0.0)];
    let step = (size, prop::array::uniform7(-1.0..1.0_f64));
    let share = || prop_oneof![2 => Just(1.0), 1 => 0.05..1.0_f64];
    let blend = prop_oneof![
        Just(None),
        (0.0..0.5_f64).prop_map(|b| Some(Blend::Fraction(b))),
        (1.0..200.0_f64).prop_map(|r| Some(Blend::CartMm(r))),
    ];
    let draft = (step, share(), share(), blend, prop::option::weighted(0.1, 0.0..0.5_f64));
    (prop::array::uniform7(-1.0..1.0_f64), prop::collection::vec(draft, 1..5))
        .prop_map(|(start_rad, drafts)| {
            let mut at = start_rad;
            let mut motions: Vec<_> = drafts
                .into_iter()
                .map(|((size, by), velocity, acceleration, blend, wait)| {
                    if let Some(seconds) = wait {
                        return Motion::Wait { seconds };
                    }
                    at = std::array::from_fn(|j| (at[j] + size * by[j]).clamp(-2.0, 2.0));
                    Motion::Ptp(Ptp {
                        acceleration_rel: [acceleration; 7],
                        blend,
                        ..Ptp::to(at).velocity(velocity)
                    })
                })
                .collect();
            for i in 0..motions.len() {
                if !matches!(motions.get(i + 1), Some(Motion::Ptp(_)))
                    && let Motion::Ptp(ptp) = &mut motions[i]
                {
                    ptp.blend = None;
                }
            }
            Program { robot: None, start_rad, motions }
        })
        .prop_filter("a blend swings out of the limits", |program| {
            JointPath::new(program, &Robot::default()).is_ok()
        })
}

fn planned(program: &Program) -> Trajectory {
    let path = JointPath::new(program, &Robot::default()).unwrap();
    Trajectory::plan(&path, Timing::default()).unwrap()
}

/// Points every `step_s`, and one at the end.
fn even(plan: &Trajectory, step_s: f64) -> TimedJoints {
    let count = (plan.cycle_time_s() / step_s).ceil() as u32;
    at_stamps(plan, (0..count).map(|i| f64::from(i) * step_s))
}

/// Points at these stamps, as far as the trajectory goes, and one at the end.
fn at_stamps(plan: &Trajectory, stamps: impl Iterator<Item = f64>) -> TimedJoints {
    let end_s = plan.cycle_time_s();
    // A last step next to nothing would be no step of a planner.
    let mut t_s: Vec<f64> = stamps.take_while(|t_s| *t_s < end_s - 1e-5).collect();
    t_s.push(end_s.max(t_s.last().map_or(0.0, |last| last + 1e-3)));
    if t_s.len() < 2 {
        t_s.insert(0, 0.0);
    }
    let joints_rad = t_s.iter().map(|t_s| plan.at(*t_s).q).collect();
    TimedJoints { t_s, joints_rad }
}

fn rounded(trajectory: &TimedJoints) -> TimedJoints {
    let round = |x: f64| (x * 1e6).round() / 1e6;
    TimedJoints {
        t_s: trajectory.t_s.iter().map(|t_s| round(*t_s)).collect(),
        joints_rad: trajectory.joints_rad.iter().map(|q| q.map(round)).collect(),
    }
}

fn check(trajectory: &TimedJoints) -> Result<(), Refusal> {
    let start = trajectory.joints_rad.first().copied().unwrap_or_default();
    trajectory.check(Robot::default().limits(), &start)
}

fn assert_refused(trajectory: &TimedJoints, what: &str) -> Refusal {
    let refusal = check(trajectory).expect_err(what);
    assert_eq!(refusal.code, Code::Limit, "{refusal}");
    refusal
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_planned_is_taken(
        program in programs(),
        step_s in 0.001..0.02_f64,
        whole_ms in 1..=20_u32,
        uneven in prop::collection::vec(1e-4..0.025_f64, 50),
    ) {
        let plan = planned(&program);
        let uneven = uneven.iter().cycle().scan(0.0, |t_s, step_s| {
            let stamp = *t_s;
            *t_s += step_s;
            Some(stamp)
        });
        let trajectories = [
            even(&plan, step_s),
            even(&plan, f64::from(whole_ms) * 1e-3),
            at_stamps(&plan, uneven),
        ];
        for trajectory in trajectories {
            prop_assert_eq!(check(&trajectory), Ok(()));
            prop_assert_eq!(check(&rounded(&trajectory)), Ok(()));
            // Whenever it starts, as clocks have it.
            let mut later = trajectory;
            later.t_s.iter_mut().for_each(|t_s| *t_s += 1.7e9);
            prop_assert_eq!(check(&later), Ok(()));
        }
    }

    #[test]
    fn a_trajectory_cut_off_in_motion_is_refused(
        program in programs(),
        step_ms in 1..=20_u32,
        share in 0.0..1.0_f64,
    ) {
        let plan = planned(&program);
        let whole = even(&plan, f64::from(step_ms) * 1e-3);
        let cut = (share * whole.t_s.len() as f64) as usize;
        let state = plan.at(whole.t_s[cut]);
        // Faster than what a joint may gain within a step or two, so it cannot be coming to rest.
        let limits = Robot::default();
        let limits = limits.limits();
        let moves = (0..7).any(|j| {
            let gained = limits.acceleration_rad_s2[j] * f64::from(step_ms) * 1e-3;
            state.dq[j].abs() > 2.5 * gained
        });
        if moves && cut > 1 && cut + 2 < whole.t_s.len() {
            let [head, tail] = [0..=cut, cut..=whole.t_s.len() - 1].map(|part| TimedJoints {
                t_s: whole.t_s[part.clone()].to_vec(),
                joints_rad: whole.joints_rad[part].to_vec(),
            });
            let refusal = assert_refused(&head, "it does not end at rest");
            prop_assert!(refusal.message.contains("end at rest"), "{}", refusal);
            let refusal = assert_refused(&tail, "it does not start at rest");
            prop_assert!(refusal.message.contains("start at rest"), "{}", refusal);
        }
    }

    #[test]
    fn a_spike_of_a_milliradian_is_refused(
        program in programs(),
        step_ms in 1..=10_u32,
        share in 0.0..1.0_f64,
        joint in 0..7_usize,
        up in any::<bool>(),
    ) {
        let mut trajectory = even(&planned(&program), f64::from(step_ms) * 1e-3);
        if trajectory.t_s.len() > 3 {
            let at = 1 + (share * (trajectory.t_s.len() - 2) as f64) as usize;
            trajectory.joints_rad[at][joint] += if up { 1e-3 } else { -1e-3 };
            let _ = assert_refused(&trajectory, "a spike");
        }
    }

    #[test]
    fn between_points_the_arm_goes_where_it_was_planned_to(program in programs()) {
        let plan = planned(&program);
        let trajectory = even(&plan, 0.004);
        for (t_s, q) in trajectory.t_s.iter().zip(&trajectory.joints_rad) {
            let off = distance(&trajectory.at(*t_s), q);
            prop_assert!(off < 1e-12, "{} rad at {} s", off, t_s);
        }
        let end_s = trajectory.duration_s();
        // A cubic with slopes that are themselves means misses a step of the jerk by so much: half a
        // microradian for the large joints, two for the wrists.
        let jerk = Robot::default().limits().jerk_rad_s3;
        let most = jerk.map(|jerk| jerk * 0.004_f64.powi(3) / 20.0);
        let steps = (end_s / 0.0005) as u32;
        for i in 0..=steps {
            let t_s = f64::from(i) * 0.0005;
            let (found, expected) = (trajectory.at(t_s), plan.at(t_s).q);
            for j in 0..7 {
                let off = (found[j] - expected[j]).abs();
                prop_assert!(off < most[j], "joint {} is off by {} rad at {} s", j + 1, off, t_s);
            }
            // The speed on either side of a place is the same, but for what it gains in so short a time.
            let dt_s = 1e-6;
            let [a, b, c] = [t_s - dt_s, t_s, t_s + dt_s].map(|t_s| trajectory.at(t_s));
            for j in 0..7 {
                let jump = (c[j] - 2.0 * b[j] + a[j]).abs() / dt_s;
                prop_assert!(jump < 1e-3, "a jump of {} rad/s at {} s", jump, t_s);
            }
        }
        prop_assert_eq!(trajectory.at(-1.0), trajectory.joints_rad[0]);
        prop_assert_eq!(trajectory.at(end_s + 1.0), *trajectory.joints_rad.last().unwrap());
    }
}

/// Programs without blends whose stops are at the ends of the joints' ranges, or anywhere.
fn programs_to_the_limits() -> impl Strategy<Value = Program> {
    let range = Robot::default().limits().position_rad;
    let place = move |share: [f64; 7]| -> Joints {
        std::array::from_fn(|j| (1.5 * share[j]).clamp(-1.0, 1.0) * range[j])
    };
    let target = (prop::array::uniform7(-1.0..1.0_f64), 0.1..1.0_f64);
    (prop::array::uniform7(-1.0..1.0_f64), prop::collection::vec(target, 1..5)).prop_map(
        move |(start, targets)| Program {
            robot: None,
            start_rad: place(start),
            motions: targets
                .into_iter()
                .map(|(share, speed)| Motion::Ptp(Ptp::to(place(share)).velocity(speed)))
                .collect(),
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    /// Where a joint stops, it never swings beyond: neither over the end of its range, nor elsewhere.
    #[test]
    fn no_joint_swings_beyond_its_stops(
        program in programs_to_the_limits(),
        step_s in 0.001..0.01_f64,
    ) {
        let trajectory = even(&planned(&program), step_s);
        let targets = program.motions.iter().filter_map(|motion| match motion {
            Motion::Ptp(ptp) => Some(ptp.target_rad),
            _ => None,
        });
        let stops: Vec<Joints> = targets.chain([program.start_rad]).collect();
        let bound = |j: usize, of: fn(f64, f64) -> f64| {
            stops.iter().map(|stop| stop[j]).reduce(of).unwrap()
        };
        let steps = (trajectory.duration_s() / 0.0003) as u32;
        for q in (0..=steps).map(|i| trajectory.at(f64::from(i) * 0.0003)) {
            for (j, q) in q.iter().enumerate() {
                let beyond = (q - bound(j, f64::max)).max(bound(j, f64::min) - q);
                prop_assert!(beyond < 1e-12, "joint {} by {} rad", j + 1, beyond);
            }
        }
    }

    /// Whatever the points are, next to rest the arm stays between them.
    #[test]
    fn beside_rest_the_arm_stays_between_its_points(
        steps in prop::collection::vec((1e-3..0.02_f64, prop_oneof![2 => Just(0.0), 3 => -0.01..0.01_f64]), 2..20),
        share in 0.0..1.0_f64,
    ) {
        let (mut t_s, mut q) = (vec![0.0], vec![0.0]);
        for (step_s, by) in steps {
            t_s.push(t_s.last().unwrap() + step_s);
            q.push(q.last().unwrap() + by);
        }
        let joints_rad = q.iter().map(|q| [*q; 7]).collect();
        let trajectory = TimedJoints { t_s: t_s.clone(), joints_rad };
        let rests = |i: usize| {
            i == 0 || i + 1 == q.len() || q[i] == q[i - 1] || q[i] == q[i + 1]
        };
        for i in 0..q.len() - 1 {
            if rests(i) || rests(i + 1) {
                let found = trajectory.at(t_s[i] + share * (t_s[i + 1] - t_s[i]))[0];
                let (low, high) = (q[i].min(q[i + 1]), q[i].max(q[i + 1]));
                prop_assert!((low - 1e-12..=high + 1e-12).contains(&found), "{low} {found} {high}");
            }
        }
    }
}

fn distance(a: &Joints, b: &Joints) -> f64 {
    (0..7).map(|j| (a[j] - b[j]).abs()).fold(0.0, f64::max)
}

/// Joint 1 goes `angle_rad` with these largest speed, acceleration and jerk, in seven phases of
/// constant jerk; the truth in closed form.
struct Ramp {
    angle_rad: f64,
    jerk: f64,
    /// Duration of constant jerk, of constant acceleration and of constant speed, in s.
    phases_s: [f64; 3],
}

impl Ramp {
    fn new(angle_rad: f64, speed: f64, acceleration: f64, jerk: f64) -> Self {
        let jerks_s = acceleration / jerk;
        let ramp_s = speed / acceleration;
        let cruise_s = angle_rad / speed - ramp_s - jerks_s;
        let phases_s = [jerks_s, ramp_s - jerks_s, cruise_s];
        assert!(phases_s.iter().all(|phase_s| *phase_s > 0.0), "{phases_s:?}");
        Self { angle_rad, jerk, phases_s }
    }

    fn duration_s(&self) -> f64 {
        let [jerks_s, ramp_s, cruise_s] = self.phases_s;
        4.0 * jerks_s + 2.0 * ramp_s + cruise_s
    }

    fn at(&self, t_s: f64) -> f64 {
        let [jerks_s, ramp_s, cruise_s] = self.phases_s;
        // The second half is the first one, seen from the end.
        let whole_s = self.duration_s();
        if t_s > whole_s / 2.0 {
            return self.angle_rad - self.at(whole_s - t_s);
        }
        let (mut q, mut dq, mut ddq, mut left_s) = (0.0, 0.0, 0.0, t_s.max(0.0));
        for (phase_s, jerk) in
            [(jerks_s, self.jerk), (ramp_s, 0.0), (jerks_s, -self.jerk), (cruise_s, 0.0)]
        {
            let dt = left_s.min(phase_s);
            q += dt * (dq + dt * (ddq / 2.0 + dt * jerk / 6.0));
            dq += dt * (ddq + dt * jerk / 2.0);
            ddq += dt * jerk;
            left_s -= dt;
        }
        q
    }

    /// Joint `joint` moves so, the others stand.
    fn sampled(&self, joint: usize, step_s: f64) -> TimedJoints {
        let count = (self.duration_s() / step_s).ceil() as u32;
        let t_s: Vec<_> = (0..=count).map(|i| f64::from(i) * step_s).collect();
        let point = |t_s: &f64| {
            let mut q = [0.0; 7];
            q[joint] = self.at(*t_s);
            q
        };
        let joints_rad = t_s.iter().map(point).collect();
        TimedJoints { t_s, joints_rad }
    }
}

/// A ramp that reaches so much of one limit.
type Make<'a> = &'a dyn Fn(f64) -> Ramp;

/// Each limit in turn is exceeded by less and by more than its margin, the others not nearly reached.
#[test]
fn each_limit_is_known_to_its_margin() {
    let robot = Robot::default();
    let limits = robot.limits();
    for joint in 0..7 {
        let [speed, acceleration, jerk] = [
            limits.velocity_rad_s[joint],
            limits.acceleration_rad_s2[joint],
            limits.jerk_rad_s3[joint],
        ];
        for step_ms in [1, 2, 4, 5] {
            let fast = |over: f64| Ramp::new(2.0, over * speed, 0.8 * acceleration, 0.4 * jerk);
            let strong = |over: f64| Ramp::new(2.0, 0.95 * speed, over * acceleration, 0.8 * jerk);
            let jerky = |over: f64| {
                let top = 0.98 * acceleration;
                let speed = 1.02 * top * top / (over * jerk);
                Ramp::new(2.0, speed.max(0.3 * limits.velocity_rad_s[joint]), top, over * jerk)
            };
            // The wrists are at their full jerk for less than 30 ms: rounding to six decimals explains
            // much of a difference over so short a time.
            let jerk_beyond = if joint < 4 { 1.15 } else { 2.0 };
            let cases: [(&str, Make<'_>, f64, f64); 3] = [
                ("velocity", &fast, 1.015, 1.025),
                ("acceleration", &strong, 1.04, 1.06),
                ("jerk", &jerky, 1.09, jerk_beyond),
            ];
            for (kind, make, within, beyond) in cases {
                let place = format!("{kind} of joint {}, {step_ms} ms", joint + 1);
                let step_s = f64::from(step_ms) * 1e-3;
                for trajectory in [make(0.9), make(within)] {
                    let trajectory = trajectory.sampled(joint, step_s);
                    assert_eq!(check(&trajectory), Ok(()), "{place}");
                    assert_eq!(check(&rounded(&trajectory)), Ok(()), "{place}");
                }
                let trajectory = make(beyond).sampled(joint, step_s);
                for trajectory in [rounded(&trajectory), trajectory] {
                    let refusal = assert_refused(&trajectory, &place);
                    let named = format!("the {kind} of joint {} is", joint + 1);
                    assert!(refusal.message.contains(&named), "{place}: {refusal}");
                }
            }
        }
    }
}

/// However its stamps are spread, what is too fast is too fast: a long rest at the end makes nothing
/// of it undone.
#[test]
fn uneven_stamps_hide_nothing() {
    let robot = Robot::default();
    let limits = robot.limits();
    let ramp = Ramp::new(
        1.0,
        0.9 * limits.velocity_rad_s[0],
        3.0 * limits.acceleration_rad_s2[0],
        3.0 * limits.jerk_rad_s3[0],
    );
    for step_s in [1e-4, 1e-3, 4e-3] {
        let mut trajectory = ramp.sampled(0, step_s);
        let refusal = assert_refused(&trajectory, "too strong");
        assert!(refusal.message.contains("acceleration"), "{refusal}");
        let last = *trajectory.joints_rad.last().unwrap();
        trajectory.t_s.push(trajectory.t_s.last().unwrap() + 1000.0);
        trajectory.joints_rad.push(last);
        let refusal = assert_refused(&trajectory, "too strong, and a rest");
        assert!(refusal.message.contains("acceleration"), "{refusal}");
    }
}

#[test]
fn stamps_as_clocks_have_them_change_nothing() {
    let trajectory = Ramp::new(1.0, 1.0, 5.0, 50.0).sampled(0, 0.004);
    let mut later = trajectory.clone();
    later.t_s.iter_mut().for_each(|t_s| *t_s += 1.7e9);
    for i in 0..2000_u32 {
        let t_s = f64::from(i) * 7e-4;
        let off = distance(&trajectory.at(t_s), &later.at(t_s));
        // A stamp of that size is exact to a quarter of a microsecond.
        assert!(off < 1e-6, "{off}");
    }
}

#[test]
fn points_far_apart_are_for_rest_only() {
    let slow = Ramp::new(1.0, 1.0, 5.0, 50.0);
    check(&slow.sampled(0, 0.025)).unwrap();
    let refusal = check(&slow.sampled(0, 0.026)).unwrap_err();
    assert_eq!(refusal.code, Code::BadRequest);
    assert!(refusal.message.contains("after the one before"), "{refusal}");

    // A rest of a minute, before and in the middle, is one step, and the arm does not drift in it.
    let mut trajectory = slow.sampled(0, 0.004);
    let [first, last] = [trajectory.joints_rad[0], *trajectory.joints_rad.last().unwrap()];
    trajectory.t_s.iter_mut().for_each(|t_s| *t_s += 60.0);
    trajectory.t_s.insert(0, 0.0);
    trajectory.joints_rad.insert(0, first);
    trajectory.t_s.push(trajectory.t_s.last().unwrap() + 60.0);
    trajectory.joints_rad.push(last);
    check(&trajectory).unwrap();
    for i in 0..60 {
        assert_eq!(trajectory.at(f64::from(i)), first);
        assert_eq!(trajectory.at(trajectory.duration_s() - f64::from(i)), last);
    }
}

#[test]
fn a_trajectory_without_end_is_refused() {
    for t_s in [vec![0.0, 1e300], vec![-1e308, 1e308], vec![0.0, 1.0, 90_000.0]] {
        let joints_rad = vec![[0.0; 7]; t_s.len()];
        let refusal = check(&TimedJoints { t_s, joints_rad }).unwrap_err();
        assert_eq!(refusal.code, Code::BadRequest);
        assert!(refusal.message.contains("day") && refusal.message.len() < 200, "{refusal}");
    }
}

#[test]
fn it_starts_within_half_a_degree_of_the_robot() {
    let trajectory = Ramp::new(1.0, 1.0, 5.0, 50.0).sampled(3, 0.004);
    let robot = Robot::default();
    for (off_deg, taken) in [(0.49, true), (-0.49, true), (0.51, false), (-0.6, false)] {
        let mut at = [0.0; 7];
        at[3] += f64::to_radians(off_deg);
        let result = trajectory.check(robot.limits(), &at);
        assert_eq!(result.is_ok(), taken, "{off_deg} deg: {result:?}");
        if let Err(refusal) = result {
            assert_eq!(refusal.code, Code::StartMismatch);
            assert!(refusal.message.contains("joint 4"), "{refusal}");
        }
    }
    assert!((START_TOLERANCE_RAD.to_degrees() - 0.5).abs() < 1e-12);
}

/// Numbers of all kinds, the odd ones more often than in life.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -3.0..3.0_f64,
        2 => prop::num::f64::ANY,
        1 => prop::sample::select(vec![
            0.0, -0.0, 1e-300, 5e-324, 1e300, f64::MAX, f64::MIN, f64::NAN, f64::INFINITY,
        ]),
    ]
}

fn json() -> impl Strategy<Value = serde_json::Value> {
    use serde_json::Value;
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        number().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        ".{0,8}".prop_map(Value::from),
        prop::sample::select(Request::TYPES.to_vec()).prop_map(Value::from),
    ];
    let key = prop::sample::select(vec![
        "type",
        "id",
        "motions",
        "trajectory",
        "t_s",
        "joints_rad",
        "joints_deg",
        "name",
        "value",
        "seconds",
        "blend",
        "x\u{7}",
    ]);
    leaf.prop_recursive(4, 40, 8, move |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..8).prop_map(Value::from),
            prop::collection::vec((key.clone(), inner), 0..6).prop_map(|pairs| {
                pairs.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
            }),
        ]
    })
}

/// The message is for people, who read it on one line.
fn assert_told(refusal: &Refusal) {
    let Refusal { message, .. } = refusal;
    assert!(!message.is_empty() && message.len() <= 600, "{message}");
    assert!(!message.contains(char::is_control), "{message:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_numbers_make_it_panic(
        mut t_s in prop::collection::vec(number(), 0..20),
        joints_rad in prop::collection::vec(prop::array::uniform7(number()), 0..20),
        form in 0..3,
        at in number(),
        start in prop::array::uniform7(number()),
    ) {
        if form > 0 {
            // In order, so that the check gets further.
            t_s.sort_by(f64::total_cmp);
            t_s.resize(joints_rad.len(), 1e9);
        }
        let trajectory = TimedJoints { t_s, joints_rad };
        let _ = (trajectory.at(at), trajectory.at(0.0), trajectory.duration_s());
        for start in [start, trajectory.joints_rad.first().copied().unwrap_or_default()] {
            if let Err(refusal) = trajectory.check(Robot::default().limits(), &start) {
                assert_told(&refusal);
            }
        }
    }

    #[test]
    fn no_json_makes_it_panic(value in json(), name in prop::sample::select(Request::TYPES.to_vec())) {
        for with_type in [false, true] {
            let mut value = value.clone();
            if with_type && let Some(object) = value.as_object_mut() {
                object.insert("type".to_owned(), name.into());
            }
            let (_, request) = Request::from_json(value.to_string().as_bytes());
            match request {
                Err(refusal) => assert_told(&refusal),
                Ok(request) => {
                    let (_, again) = Request::from_json(request.to_json().as_bytes());
                    prop_assert_eq!(again.as_ref(), Ok(&request));
                }
            }
        }
    }

    #[test]
    fn no_bytes_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        if let (_, Err(refusal)) = Request::from_json(&bytes) {
            assert_told(&refusal);
        }
    }
}

/// The longest trajectory that is taken, checked in the thread that serves all clients: this is no
/// benchmark, but what takes seconds would be noticed.
#[test]
fn the_longest_trajectory_is_checked_in_no_time() {
    for ramp in [Ramp::new(2.0, 0.005, 0.01, 0.2), Ramp::new(1e-5, 2e-4, 0.01, 1.0)] {
        let count = 400_000;
        let step_s = ramp.duration_s() / f64::from(count - 1);
        let t_s: Vec<_> = (0..count).map(|i| f64::from(i) * step_s).collect();
        let joints_rad = t_s.iter().map(|t_s| [ramp.at(*t_s), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let trajectory = TimedJoints { joints_rad: joints_rad.collect(), t_s };
        let since = Instant::now();
        assert_eq!(check(&trajectory), Ok(()));
        let took = since.elapsed();
        println!("{count} points every {step_s} s: {took:?}");
        assert!(took.as_secs_f64() < 5.0, "{took:?}");
    }
}

#[test]
fn a_list_without_end_is_not_read_to_its_end() {
    let stamps = |count: usize| vec!["0"; count].join(",");
    let parse = |count: usize| {
        let text = format!("{{\"t_s\": [{}], \"joints_rad\": []}}", stamps(count));
        serde_json::from_str::<TimedJoints>(&text)
    };
    assert_eq!(parse(MAX_POINTS).unwrap().t_s.len(), MAX_POINTS);
    let error = parse(MAX_POINTS + 1).unwrap_err().to_string();
    assert!(error.contains("at most 200000"), "{error}");
}
