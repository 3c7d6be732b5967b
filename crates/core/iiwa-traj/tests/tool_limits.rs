//! TCP limits along segments on which the TCP moves, with either timing.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use iiwa_kin::{Joints, Robot};
use iiwa_path::{Derivatives, JointPath, Line, Segment, Step, ToolWay};
use iiwa_program::{ByKind, MotionIndex, MotionLimits, ToolLimits};
use iiwa_traj::{
    JerkOptions, Limit, LimitKind, Limited, Section, SweepOptions, Timing, Trajectory,
};

/// Joints 1 and 4 move along a gentle curve, and the TCP at a varying rate: its way is
/// `way_m (s + wave (s^2 / 2 - s^3 / 3))`, and its rotation is the same function with `turn_rad`
/// and `-wave / 2`, so that one is fast where the other is slow.
#[derive(Clone, Copy, Debug)]
struct Tool {
    way_m: f64,
    turn_rad: f64,
    wave: f64,
    straight: bool,
}

impl Tool {
    const EVEN: Self = Self { way_m: 0.4, turn_rad: 0.8, wave: 0.0, straight: false };
}

impl Segment for Tool {
    fn at(&self, s: f64) -> Derivatives {
        let bend = if self.straight { 0.0 } else { 0.1 };
        let joints = |one: f64, four: f64| -> Joints { [one, 0.0, 0.0, four, 0.0, 0.0, 0.0] };
        let (sin, cos) = (2.0 * s).sin_cos();
        Derivatives {
            q: joints(0.3 * s, bend * sin),
            dq: joints(0.3, bend * 2.0 * cos),
            ddq: joints(0.0, -bend * 4.0 * sin),
            dddq: joints(0.0, -bend * 8.0 * cos),
        }
    }

    fn bend_bound_rad(&self) -> Joints {
        [0.0, 0.0, 0.0, 0.4, 0.0, 0.0, 0.0]
    }

    fn is_straight(&self) -> bool {
        self.straight
    }

    fn tool_way(&self, s: f64) -> ToolWay {
        let rate = |wave: f64| [1.0 + wave * s * (1.0 - s), wave * (1.0 - 2.0 * s), -2.0 * wave];
        ToolWay {
            way_m: rate(self.wave).map(|rate| rate * self.way_m),
            turn_rad: rate(-0.5 * self.wave).map(|rate| rate * self.turn_rad),
        }
    }

    fn has_even_tool_way(&self) -> bool {
        self.wave == 0.0
    }
}

fn path(segments: Vec<(Arc<dyn Segment>, ToolLimits)>) -> JointPath {
    let robot = Robot::default();
    let start = segments[0].0.at(0.0).q;
    let limits = segments.iter().map(|(_, tool)| MotionLimits::full(&robot).with_tool(*tool));
    let limits = limits.collect();
    let steps = segments.into_iter().enumerate().map(|(motion, (segment, _))| Step::Move {
        motion: MotionIndex::new(motion),
        segment,
        blend: None,
        limits: None,
    });
    JointPath::from_steps(&robot, start, steps.collect(), limits).unwrap()
}

fn planned(segment: Tool, limits: ToolLimits, timing: Timing) -> Trajectory {
    Trajectory::plan(&path(vec![(Arc::new(segment), limits)]), timing).unwrap()
}

fn limits(way: [f64; 3], turn: [f64; 3]) -> ToolLimits {
    ToolLimits { way: ByKind::from_array(way), turn: ByKind::from_array(turn) }
}

const NONE: [f64; 3] = [f64::INFINITY; 3];

const ACCELERATION: Timing = Timing::Acceleration(SweepOptions { samples: 100 });

/// Returns the duration from rest to rest over a way of 1, with constant jerk in each of seven
/// phases.
fn seven_phases([speed, acceleration, jerk]: [f64; 3]) -> f64 {
    // The top speed v is reached within `rise(v)`, at v / 2 on average.
    let rise = |v: f64| {
        if v * jerk > acceleration * acceleration {
            v / acceleration + acceleration / jerk
        } else {
            2.0 * (v / jerk).sqrt()
        }
    };
    let (mut low, mut high) = (0.0, speed);
    if speed * rise(speed) > 1.0 {
        for _ in 0..200 {
            let v = 0.5 * (low + high);
            if v * rise(v) > 1.0 { high = v } else { low = v }
        }
    }
    2.0 * rise(high) + (1.0 - high * rise(high)) / high
}

/// Returns the largest share of a limit of each kind, for way and rotation of the tool, from the
/// joint derivatives.
fn largest_shares(trajectory: &Trajectory, segment: Tool, limits: &ToolLimits) -> [[f64; 3]; 2] {
    let mut largest = [[0.0_f64; 3]; 2];
    let count = 4_000;
    for i in 0..=count {
        let t_s = trajectory.motion_time_s() * f64::from(i) / f64::from(count);
        let state = trajectory.at(t_s);
        // Joint 1 is 0.3 s.
        let [s, v, a, j] =
            [state.q[0], state.dq[0], state.ddq[0], state.dddq[0]].map(|value| value / 0.3);
        let ToolWay { way_m, turn_rad } = segment.tool_way(s);
        for (largest, ([one, two, three], limits)) in
            largest.iter_mut().zip([(way_m, &limits.way), (turn_rad, &limits.turn)])
        {
            let rates =
                [one * v, one * a + two * v * v, one * j + 3.0 * two * v * a + three * v * v * v];
            for (largest, (rate, limit)) in
                largest.iter_mut().zip(rates.iter().zip(limits.values()))
            {
                *largest = largest.max(rate.abs() / limit);
            }
        }
    }
    largest
}

fn limited_by(trajectory: &Trajectory) -> Limit {
    trajectory.motions()[0].limited_by.unwrap()
}

#[test]
fn an_even_way_alone_takes_as_long_as_its_profile() {
    let way = [0.1, 0.3, 2.0];
    for straight in [false, true] {
        let segment = Tool { straight, ..Tool::EVEN };
        // In the second case, the acceleration limit of the rotation is the active one.
        for (turn, scaled) in
            [(NONE, way.map(|limit| limit / 0.4)), ([1.0, 0.4, 100.0], [0.25, 0.5, 5.0])]
        {
            let limits = limits(way, turn);
            for (timing, jerk) in [(Timing::jerk_limited(), scaled[2]), (ACCELERATION, f64::MAX)] {
                let trajectory = planned(segment, limits, timing);
                let expected = seven_phases([scaled[0], scaled[1], jerk]);
                let actual = trajectory.motion_time_s();
                assert!((actual / expected - 1.0).abs() < 1e-3, "{actual} {expected} {timing:?}");
                let limit = Limit::Motion { of: Limited::Way, kind: LimitKind::Velocity };
                assert_eq!(limited_by(&trajectory), limit);
                let all = largest_shares(&trajectory, segment, &limits);
                let [v, a, j] = std::array::from_fn(|k| all[0][k].max(all[1][k]));
                assert!((0.99..1.001).contains(&v), "{all:?}");
                assert!((0.99..1.002).contains(&a), "{all:?}");
                assert!(j < 1.02 || jerk == f64::MAX, "{all:?}");
                if turn != NONE {
                    let shares = &trajectory.motions()[0].limits;
                    let turn = Limit::Motion { of: Limited::Turn, kind: LimitKind::Acceleration };
                    assert!(shares.iter().any(|share| share.limit == turn), "{shares:?}");
                }
            }
        }
    }
}

#[test]
fn without_a_limit_that_binds_nothing_changes() {
    for timing in [Timing::jerk_limited(), ACCELERATION] {
        let free = planned(Tool::EVEN, ToolLimits::NONE, timing).motion_time_s();
        let wide = planned(Tool::EVEN, limits([1e3, 1e5, 1e7], NONE), timing);
        assert!((wide.motion_time_s() / free - 1.0).abs() < 1e-4, "{timing:?}");
        assert!(matches!(limited_by(&wide), Limit::Motion { of: Limited::Joint(_), .. }));
        // A limit of one kind alone.
        for kind in LimitKind::ALL {
            let mut only = ToolLimits::NONE;
            only.way[kind] = [0.2, 0.5, 2.0][usize::from(kind.order()) - 1];
            let trajectory = planned(Tool::EVEN, only, timing);
            let all = largest_shares(&trajectory, Tool::EVEN, &only);
            if kind == LimitKind::Jerk && timing == ACCELERATION {
                assert_eq!(trajectory.motion_time_s(), free);
            } else {
                assert!(all[0].into_iter().fold(0.0, f64::max) < 1.02, "{kind}: {all:?}");
                assert!(trajectory.motion_time_s() > 1.05 * free, "{kind}");
            }
        }
    }
}

#[test]
fn an_uneven_way_keeps_its_limits_all_along() {
    let segment = Tool { wave: 1.5, ..Tool::EVEN };
    for (limits, expected) in [
        (limits([0.2, 0.8, 8.0], NONE), Limited::Way),
        (limits(NONE, [0.3, 0.9, 9.0]), Limited::Turn),
        (limits([0.2, 3.0, 30.0], [0.5, 7.0, 70.0]), Limited::Way),
    ] {
        for (timing, max_jerk) in [(Timing::jerk_limited(), 1.02), (ACCELERATION, f64::INFINITY)] {
            let trajectory = planned(segment, limits, timing);
            let all = largest_shares(&trajectory, segment, &limits);
            for [v, a, j] in all {
                assert!(v < 1.001 && a < 1.005 && j < max_jerk, "{all:?}");
            }
            assert!(all[0][0].max(all[1][0]) > 0.91, "{all:?}");
            assert!(matches!(
                limited_by(&trajectory),
                Limit::Motion { of: limited, .. } if limited == expected
            ));
        }
    }
}

/// At a segment boundary in motion, the limits of the first segment apply up to the boundary,
/// whatever those of the next one are.
#[test]
fn limits_hold_up_to_where_the_next_segment_starts() {
    let segment = Tool { straight: true, ..Tool::EVEN };
    let next = Line::new(segment.at(1.0).q, [0.6, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let slow = limits([0.1, 0.3, 2.0], NONE);
    for timing in [
        Timing::jerk_limited(),
        ACCELERATION,
        Timing::Jerk(JerkOptions { general: true, ..JerkOptions::default() }),
    ] {
        let path =
            path(vec![(Arc::new(segment), slow), (Arc::new(next.clone()), ToolLimits::NONE)]);
        let trajectory = Trajectory::plan(&path, timing).unwrap();
        let pieces: Vec<_> = trajectory.sections().iter().flat_map(Section::pieces).collect();
        let end_s = pieces[0].end_s;
        for i in 0..=1_000 {
            let state = trajectory.at(end_s * f64::from(i) / 1_000.0);
            let [speed, acceleration] = [state.dq[0], state.ddq[0]].map(|v| v / 0.3 * 0.4);
            let max_share = if timing == ACCELERATION { 1.002 } else { 1.005 };
            assert!(
                speed < max_share * 0.1 && (i == 1_000 || acceleration.abs() < max_share * 0.3),
                "{state:?}"
            );
        }
        assert!(pieces[1].end_s - end_s < 0.7 * end_s);
    }
}
