//! Recordings simulated from plans, and the results of their comparison.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use fastrand::Rng;
use iiwa_eval::{CompareError, Comparison, PlannedTrajectory, compare};
use iiwa_kin::Robot;
use iiwa_log::JointLog;
use iiwa_program::MotionType;
use iiwa_traj::{SweepOptions, Timing, Trajectory};

use crate::tape::{Tape, trajectory};

const FIXTURES: [&str; 3] = [
    include_str!("../../../../fixtures/appendix-b.json"),
    include_str!("../../../../fixtures/ten-motions.json"),
    include_str!("../../../../fixtures/waits-and-stops.json"),
];

/// Joint 1 by 40 degrees and stop.
const LINE: &str = r#"{ "version": 1, "start": { "joints_deg": [-20, 0, 0, -60, 0, 90, 0] },
    "motions": [{ "type": "ptp", "joints_deg": [20, 0, 0, -60, 0, 90, 0] }] }"#;

fn jerk() -> Timing {
    Timing::jerk_limited()
}

fn acceleration() -> Timing {
    Timing::Acceleration(SweepOptions::default())
}

fn compared(trajectory: &Trajectory, tape: Tape) -> Comparison {
    let log = tape.record(trajectory, &mut Rng::with_seed(7));
    compare(&PlannedTrajectory::from_trajectory(trajectory), &log).unwrap()
}

#[test]
fn a_plan_against_itself_is_without_error() {
    for text in FIXTURES.iter().chain([&LINE]) {
        for timing in [jerk(), acceleration()] {
            for rate_hz in [100.0, 250.0, 1000.0] {
                let real = trajectory(text, timing);
                let c = compared(&real, Tape { rate_hz, ..Tape::default() });
                assert!(c.cycle_time.error_s.abs() < 1e-9, "{:?}", c.cycle_time);
                assert!(c.joints_rad.max < 1e-7 && c.flange_m.max < 1e-7, "{:?}", c.flange_m);
                let pairs = c.motions.iter().zip(real.motions());
                for (motion, planned) in pairs {
                    assert!((motion.planned_s - (planned.end_s - planned.start_s)).abs() < 1e-9);
                    assert!(motion.error_s.unwrap().abs() < 1e-7, "{motion:?}");
                }
            }
        }
    }
}

/// Calculated by hand: the motion of joint 1 takes T = 0.4082 + 0.2 + 0.0472 s, and 1.02 T when it
/// is slower; the rest of 0.05 s is in both times. Joint 2 is off by 0.004 rad throughout.
#[test]
fn a_stretched_and_shifted_line_is_off_as_computed_by_hand() {
    let real = trajectory(LINE, jerk());
    let moves_s = 40.0 / 98.0 + 98.0 / 490.0 + 490.0 / 10384.86;
    let mut shift_rad = [0.0; 7];
    shift_rad[1] = 0.004;
    let tape = Tape {
        section: 1.02,
        shift_rad,
        before_s: 1.0,
        after_s: 1.0,
        clock_s: 12.5,
        ..Tape::default()
    };
    let c = compared(&real, tape);
    let error_s = -0.02 * moves_s;
    assert!((c.cycle_time.simulated_s - (moves_s + 0.05)).abs() < 1e-9);
    assert!((c.cycle_time.real_s - (1.02 * moves_s + 0.05)).abs() < 1e-9, "{:?}", c.cycle_time);
    assert!((c.cycle_time.error_s - error_s).abs() < 1e-9);
    let percent = 100.0 * error_s / (1.02 * moves_s + 0.05);
    assert!((c.cycle_time.error_percent - percent).abs() < 1e-6);
    assert!((c.departure_s - 13.5).abs() < 1e-9, "{}", c.departure_s);
    assert!((c.motions[0].error_percent.unwrap() - 100.0 * -0.02 / 1.02).abs() < 1e-6);
    assert!((c.joints_rad.mean - 0.004).abs() < 1e-9 && (c.joints_rad.max - 0.004).abs() < 1e-9);
    // Joint 1 rotates the arm about the vertical axis. The nearest point of that circle is in the
    // plane of the arm: there, the flange is at (r, z) and moves with joint 2 about the shoulder.
    let robot = Robot::lbr_iiwa_7_r800();
    let at = |j2: f64| {
        let p = robot.flange_position(&[
            0.0,
            j2,
            0.0,
            -60_f64.to_radians(),
            0.0,
            90_f64.to_radians(),
            0.0,
        ]);
        [p[0].hypot(p[1]), p[2]]
    };
    let (planned, measured) = (at(0.0), at(0.004));
    let off_m = (planned[0] - measured[0]).hypot(planned[1] - measured[1]);
    assert!((c.flange_m.mean - off_m).abs() < 1e-8, "{} {off_m}", c.flange_m.mean);
    assert!((c.flange_m.max - off_m).abs() < 1e-6, "{} {off_m}", c.flange_m.max);
}

/// Clock offsets, rates, pauses, noise and lost samples: the cycle time is within 1 ms.
#[test]
fn times_are_found_in_noise() {
    let still =
        Tape { before_s: 1.2, after_s: 2.0, phase: 0.37, noise_rad: 1e-5, ..Tape::default() };
    let tapes = [
        still,
        Tape { rate_hz: 250.0, clock_s: 1e6, ..still },
        Tape { rate_hz: 100.0, ..still },
        Tape { before_s: 0.0, after_s: 0.0, phase: 0.0, ..still },
        Tape { dropped: 0.1, ..still },
        Tape { before_s: 40.0, after_s: 9.0, section: 1.01, ..still },
    ];
    for tape in tapes {
        for text in FIXTURES.iter().chain([&LINE]) {
            for (planned, measured) in
                [(jerk(), jerk()), (acceleration(), jerk()), (acceleration(), acceleration())]
            {
                let plan = PlannedTrajectory::from_trajectory(&trajectory(text, planned));
                let real = trajectory(text, measured);
                let log = tape.record(&real, &mut Rng::with_seed(11));
                let c = compare(&plan, &log).unwrap();
                let expected_s = tape.section * (real.cycle_time_s() - c.cycle_time.standing_s)
                    + c.cycle_time.standing_s;
                let miss_s = (c.cycle_time.real_s - expected_s).abs();
                assert!(miss_s < 1e-3, "{} Hz: {miss_s:.1e} s", tape.rate_hz);
                let [noise, off] = [c.noise_rad, c.joints_rad.mean];
                assert!((2e-5..4e-5).contains(&noise) && off < 3e-5, "{noise} {off}");
                assert!(c.flange_m.mean < 2e-5, "{}", c.flange_m.mean);
            }
        }
    }
}

#[test]
fn waits_and_stops_have_their_times() {
    let real = trajectory(FIXTURES[2], jerk());
    let c = compared(&real, Tape { before_s: 0.5, section: 1.1, ..Tape::default() });
    let wait = &c.motions[2];
    assert!(wait.motion_type == MotionType::Wait && wait.motion.number() == 3);
    // The rest of 0.05 s settling and 0.5 s waiting, stretched as a whole; the part that is not
    // settling counts as waiting.
    assert!((wait.real_s.unwrap() - (1.1 * 0.55 - 0.05)).abs() < 1e-6, "{wait:?}");
    let stops: Vec<_> = c.stops.iter().map(|stop| (stop.after_motion, stop.planned_s)).collect();
    assert!(stops.iter().map(|stop| stop.0.number()).eq([2, 6]), "{stops:?}");
    for stop in &c.stops {
        assert!((stop.real_s.unwrap() - 1.1 * stop.planned_s).abs() < 1e-6, "{stop:?}");
    }
}

/// A program that moves forth and back, twice.
const TO_AND_FRO: &str = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, -60, 0, 90, 0] },
    "motions": [{ "type": "ptp", "joints_deg": [30, 10, 0, -60, 0, 90, 0] },
        { "type": "ptp", "joints_deg": [0, 0, 0, -60, 0, 90, 0] },
        { "type": "ptp", "joints_deg": [30, 10, 0, -60, 0, 90, 0], "velocity_rel": 0.3 },
        { "type": "ptp", "joints_deg": [0, 0, 0, -60, 0, 90, 0] }] }"#;

#[test]
fn a_path_that_goes_back_on_itself_is_not_mixed_up() {
    let real = trajectory(TO_AND_FRO, jerk());
    for noise_rad in [0.0, 1e-5] {
        let tape = Tape { before_s: 1.0, after_s: 1.0, noise_rad, ..Tape::default() };
        let c = compared(&real, tape);
        assert!(c.cycle_time.error_s.abs() < 1e-3, "{:?}", c.cycle_time);
        for motion in &c.motions {
            assert!(motion.error_s.unwrap().abs() < 1e-3, "{motion:?}");
        }
    }
}

#[test]
fn slow_motions_are_not_mistaken_for_rest() {
    for (velocity_rel, within_s) in [(0.01, 2e-3), (0.001, 0.02), (0.0001, 0.3)] {
        let program = format!(
            r#"{{ "version": 1, "start": {{ "joints_deg": [0, 0, 0, -60, 0, 90, 0] }}, "motions": [
                {{ "type": "ptp", "joints_deg": [0.3, 0, 0, -60, 0, 90, 0],
                   "velocity_rel": {velocity_rel} }}] }}"#
        );
        let real = trajectory(&program, jerk());
        for (noise_rad, within_s) in [(0.0, 1e-8), (1e-5, within_s)] {
            for (before_s, rate_hz) in [(0.0, 250.0), (3.0, 1000.0)] {
                let tape =
                    Tape { before_s, after_s: before_s, noise_rad, rate_hz, ..Tape::default() };
                let c = compared(&real, tape);
                let error_s = c.cycle_time.error_s.abs();
                assert!(error_s < within_s, "{velocity_rel} {noise_rad} {before_s}: {error_s}");
            }
        }
    }
}

/// Concatenates recordings; the robot moves from one to the next in a straight line.
fn joined(logs: &[JointLog]) -> JointLog {
    let mut joined = logs[0].clone();
    for log in &logs[1..] {
        let (t_s, q) = (*joined.t_s.last().unwrap(), *joined.q_rad.last().unwrap());
        let to = log.q_rad[0];
        for k in 1..1000 {
            let share = f64::from(k) / 1000.0;
            joined.t_s.push(t_s + 2.0 * share);
            joined.q_rad.push(std::array::from_fn(|j| q[j] + share * (to[j] - q[j])));
        }
        joined.t_s.extend(log.t_s.iter().map(|t| t_s + 2.0 + t - log.t_s[0]));
        joined.q_rad.extend(&log.q_rad);
    }
    joined
}

#[test]
fn the_program_is_found_among_others() {
    let pauses = Tape { before_s: 0.7, after_s: 0.7, noise_rad: 1e-5, ..Tape::default() };
    let mut rng = Rng::with_seed(3);
    let real: Vec<_> = FIXTURES.iter().map(|text| trajectory(text, jerk())).collect();
    let tapes: Vec<_> = [0, 1, 2, 1].iter().map(|k| pauses.record(&real[*k], &mut rng)).collect();
    let log = joined(&tapes);
    let c = compare(&PlannedTrajectory::from_trajectory(&real[1]), &log).unwrap();
    assert!(c.cycle_time.error_s.abs() < 1e-3, "{:?}", c.cycle_time);
    let first_s = real[0].cycle_time_s() + 1.4 + 2.0 + 0.7;
    assert!((c.departure_s - first_s).abs() < 0.01, "{} {first_s}", c.departure_s);
    assert!(c.again_s.unwrap() > c.arrival_s);
}

fn refused(plan: &str, log: &JointLog) -> CompareError {
    compare(&PlannedTrajectory::from_trajectory(&trajectory(plan, jerk())), log).unwrap_err()
}

#[test]
fn recordings_of_other_programs_are_refused() {
    let mut rng = Rng::with_seed(5);
    let tape = Tape { before_s: 0.5, after_s: 0.5, ..Tape::default() };
    let whole = tape.record(&trajectory(FIXTURES[1], jerk()), &mut rng);
    let cut = |from: usize, to: usize| {
        JointLog::new(whole.t_s[from..to].to_vec(), whole.q_rad[from..to].to_vec())
    };
    let other = tape.record(&trajectory(FIXTURES[0], jerk()), &mut rng);
    assert!(matches!(refused(FIXTURES[1], &other), CompareError::OtherStart { .. }));
    // Stopped early; started late; cut off during the arrival.
    let early = refused(FIXTURES[1], &cut(0, 4000));
    assert!(
        matches!(early, CompareError::EndsEarly { motion, .. } if motion.number() == 5),
        "{early}"
    );
    let late = refused(FIXTURES[1], &cut(540, whole.t_s.len()));
    assert!(matches!(late, CompareError::BeginsInMotion { .. }), "{late}");
    let arriving = refused(FIXTURES[1], &cut(0, whole.t_s.len() - 590));
    assert!(
        matches!(arriving, CompareError::DoesNotStop { .. } | CompareError::EndsEarly { .. }),
        "{arriving}"
    );
    // Reversed in time.
    let mut back = whole.clone();
    back.q_rad.reverse();
    refused(FIXTURES[1], &back);
    // Without motion, and without samples.
    assert!(matches!(refused(FIXTURES[1], &cut(0, 400)), CompareError::NoMotion { .. }));
    assert!(matches!(refused(FIXTURES[1], &cut(0, 0)), CompareError::TooFewSamples { .. }));
    // Decreasing times; an invalid number.
    let mut bad = whole.clone();
    bad.t_s.swap(10, 11);
    assert!(matches!(refused(FIXTURES[1], &bad), CompareError::BadSample { index: 12, .. }));
    let mut bad = whole.clone();
    bad.q_rad[7][3] = f64::NAN;
    assert!(matches!(refused(FIXTURES[1], &bad), CompareError::BadSample { index: 8, .. }));
    // Another robot.
    let mut other = whole.clone();
    other.robot = Some("lbr_iiwa_14_r820".to_owned());
    assert!(matches!(refused(FIXTURES[1], &other), CompareError::OtherRobot { .. }));
    // A plan without motion.
    let stands = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
        "motions": [{ "type": "wait", "seconds": 1 }] }"#;
    assert!(matches!(refused(stands, &whole), CompareError::PlanWithoutMotion));
}

#[test]
fn the_same_ends_by_another_way_are_refused() {
    let by = |deg: f64| {
        format!(
            r#"{{ "version": 1, "start": {{ "joints_deg": [0, 0, 0, -60, 0, 90, 0] }}, "motions": [
                {{ "type": "ptp", "joints_deg": [30, {deg}, 0, -60, 0, 90, 0] }},
                {{ "type": "ptp", "joints_deg": [60, 0, 0, -60, 0, 90, 0] }}] }}"#
        )
    };
    let tape = Tape { before_s: 0.5, after_s: 0.5, ..Tape::default() };
    let log = tape.record(&trajectory(&by(20.0), jerk()), &mut Rng::with_seed(1));
    for deg in [-20.0, 60.0] {
        let error = refused(&by(deg), &log);
        let other =
            matches!(error, CompareError::OtherPath { .. } | CompareError::OffAllAlong { .. });
        assert!(other, "{error}");
    }
}

#[test]
fn gaps_are_stated_and_never_hide_an_edge() {
    let real = trajectory(FIXTURES[1], jerk());
    let tape = Tape { before_s: 0.5, after_s: 0.5, ..Tape::default() };
    let whole = tape.record(&real, &mut Rng::with_seed(2));
    let without = |from_s: f64, to_s: f64| {
        let remaining =
            whole.t_s.iter().zip(&whole.q_rad).filter(|(t, _)| **t < from_s || **t > to_s);
        let (t_s, q_rad) = remaining.map(|(t, q)| (*t, *q)).unzip();
        JointLog::new(t_s, q_rad)
    };
    let plan = PlannedTrajectory::from_trajectory(&real);
    let end_s = 0.5 + real.motion_time_s();
    let c = compare(&plan, &without(3.0, 3.2)).unwrap();
    assert!(c.cycle_time.error_s.abs() < 1e-6 && c.losses.len() == 1, "{:?}", c.losses);
    let c = compare(&plan, &without(0.49, 0.52)).unwrap();
    assert!(c.cycle_time.error_s.abs() < 1e-3 && !c.losses.is_empty(), "{:?}", c.cycle_time);
    for (from_s, to_s) in [(0.45, 0.58), (end_s - 0.08, end_s + 0.1)] {
        let error = compare(&plan, &without(from_s, to_s)).unwrap_err();
        assert!(matches!(error, CompareError::GapAtEdge { .. }), "{error}");
    }
}

/// A joint with a constant offset passes the plan's start in motion, or does not reach it. Both
/// offsets leave the times as they are; a large offset is refused as what it is.
#[test]
fn a_constant_offset_is_reported() {
    const BEND: &str = r#"{ "version": 1, "start": { "joints_deg": [-20, 0, 0, -60, 0, 90, 0] },
        "motions": [{ "type": "ptp", "joints_deg": [20, 0, 0, -60, 0, 90, 0] },
            { "type": "ptp", "joints_deg": [20, 0, 0, -30, 0, 90, 0] }] }"#;
    let trajectory = trajectory(BEND, jerk());
    let plan = PlannedTrajectory::from_trajectory(&trajectory);
    let recorded = |joint: usize, offset_deg: f64| {
        let mut shift_rad = [0.0; 7];
        shift_rad[joint] = offset_deg.to_radians();
        let tape = Tape { before_s: 0.5, after_s: 0.5, shift_rad, ..Tape::default() };
        tape.record(&trajectory, &mut Rng::with_seed(1))
    };
    // Joint 1 turns at the start, joint 4 at the end, both in the positive direction.
    for joint in [0, 3] {
        for offset_deg in [-2.0, -1.0, -0.35, 0.35, 1.0, 2.0] {
            let actual = compare(&plan, &recorded(joint, offset_deg)).unwrap();
            let named = format!("at rest {:.2} deg from the plan's", offset_deg.abs());
            let reports = actual.losses.iter().filter(|loss| loss.contains(&named)).count();
            assert_eq!(reports, 2, "{joint}, {offset_deg}: {:?}", actual.losses);
            assert!(actual.cycle_time.error_s.abs() < 1e-3, "{:?}", actual.cycle_time);
            assert!(actual.joints_rad.max <= offset_deg.abs().to_radians() + 1e-6);
        }
    }
    let error = compare(&plan, &recorded(0, -4.0)).unwrap_err();
    assert!(matches!(error, CompareError::RestElsewhere { edge: "start", .. }), "{error}");
    assert!(error.to_string().contains("4.00 deg"), "{error}");
}
