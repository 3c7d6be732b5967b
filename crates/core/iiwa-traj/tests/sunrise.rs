//! PTP motions as planned by Sunrise.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::{Joints, Robot};
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_traj::{JerkOptions, Limit, LimitKind, Limited, Timing, Trajectory};
use proptest::prelude::*;

fn sunrise() -> Timing {
    Timing::Sunrise(JerkOptions::default())
}

fn plan(program: &Program, timing: Timing) -> Trajectory {
    let path = JointPath::new(program, &Robot::default()).unwrap();
    Trajectory::plan(&path, timing).unwrap()
}

struct Case {
    from_deg: Joints,
    to_deg: Joints,
    seconds: f64,
    /// Shares of the way at 0.05 s, at 0.15 s and 0.1 s before the end.
    shares: [f64; 3],
}

const fn case(from_deg: Joints, to_deg: Joints, seconds: f64, shares: [f64; 3]) -> Case {
    Case { from_deg, to_deg, seconds, shares }
}

/// Results of an independent implementation of the law, in Python, with its own mass matrix, from
/// random poses.
const CASES: [Case; 10] = [
    case(
        [98.0, 68.0, 5.0, -47.0, -143.0, -26.0, -30.0],
        [-146.0, -99.0, 160.0, 34.0, -85.0, -14.0, 156.0],
        2.843_205_955,
        [0.000_091_666_585, 0.006_777_949_211, 0.998_842_540_649],
    ),
    case(
        [127.0, 76.0, -34.0, -2.0, 57.0, -97.0, 18.0],
        [-73.0, 84.0, -139.0, 39.0, 118.0, -60.0, 130.0],
        2.401_082_532,
        [0.000_088_027_806, 0.006_850_640_658, 0.998_483_270_721],
    ),
    case(
        [119.0, -106.0, 66.0, -110.0, 1.0, -14.0, -98.0],
        [-56.0, -106.0, 66.0, -100.0, 1.0, -14.0, -98.0],
        2.128_804_110,
        [0.000_122_844_199, 0.009_267_863_644, 0.997_886_245_935],
    ),
    case(
        [-85.0, -40.0, 96.0, 2.0, 2.0, -58.0, -160.0],
        [139.0, -91.0, 110.0, -29.0, 144.0, -22.0, 144.0],
        2.617_295_483,
        [0.000_172_630_903, 0.010_274_140_159, 0.998_577_126_397],
    ),
    case(
        [18.0, -57.0, 77.0, 38.0, 59.0, -8.0, -92.0],
        [45.0, -86.0, 62.0, 30.0, -40.0, 66.0, -101.0],
        1.007_736_030,
        [0.000_583_704_451, 0.033_984_959_727, 0.988_842_897_359],
    ),
    case(
        [-35.0, 66.0, -38.0, 47.0, 36.0, 97.0, 162.0],
        [72.0, 66.0, -38.0, 47.0, 36.0, 97.0, 162.0],
        1.439_964_736,
        [0.000_183_580_694, 0.014_093_068_026, 0.996_647_289_578],
    ),
    case(
        [-7.0, 101.0, -58.0, -22.0, -160.0, -18.0, 43.0],
        [139.0, 93.0, -55.0, 108.0, -100.0, 71.0, -113.0],
        1.843_923_944,
        [0.000_088_266_233, 0.007_132_617_110, 0.996_482_346_936],
    ),
    case(
        [-30.0, -94.0, 115.0, 72.0, -115.0, 6.0, -80.0],
        [-3.0, 12.0, -126.0, 80.0, -71.0, -12.0, -146.0],
        2.729_640_891,
        [0.000_134_205_381, 0.008_900_065_123, 0.997_861_299_462],
    ),
    case(
        [-159.0, -67.0, -51.0, 94.0, 125.0, -4.0, -15.0],
        [53.0, -67.0, -51.0, 85.0, 125.0, -4.0, -15.0],
        2.512_563_589,
        [0.000_093_505_904, 0.007_166_105_258, 0.998_369_647_504],
    ),
    case(
        [0.0, 42.0, 63.0, -109.0, -147.0, -77.0, -95.0],
        [-95.0, -99.0, -90.0, 22.0, 124.0, -33.0, -44.0],
        2.245_189_986,
        [0.000_221_631_704, 0.012_649_737_225, 0.997_033_795_243],
    ),
];

#[test]
fn another_implementation_finds_the_same() {
    for case in &CASES {
        let program = Program::from_deg(case.from_deg).ptp_deg(case.to_deg).build();
        let plan = plan(&program, sunrise());
        let seconds = plan.motion_time_s();
        assert!((seconds - case.seconds).abs() < 2e-6, "{seconds} {}", case.seconds);
        for (t, expected) in [0.05, 0.15, seconds - 0.1].into_iter().zip(case.shares) {
            let q = plan.at(t).q;
            for (j, q) in q.iter().enumerate() {
                let [from, to] = [case.from_deg[j], case.to_deg[j]].map(f64::to_radians);
                let off = q - (from + expected * (to - from));
                assert!(off.abs() < 2e-5, "A{}: {off:e} rad at {t} s", j + 1);
            }
        }
    }
}

/// Generates poses in degrees, over the whole joint range.
pub(crate) fn pose() -> impl Strategy<Value = Joints> {
    [160.0, 110.0, 160.0, 110.0, 160.0, 110.0, 165.0_f64].map(|limit| -limit..limit)
}

proptest! {
    /// Far and near, fast and slow: the velocity and acceleration limits are kept at every
    /// instant, the acceleration is continuous, and stamps increase.
    #[test]
    fn limits_are_kept(
        from in pose(), to in pose(), nearer in -9.0..0.0_f64, slower in -3.0..0.0_f64,
    ) {
        let share = 10.0_f64.powf(nearer);
        let to: Joints = std::array::from_fn(|j| from[j] + share * (to[j] - from[j]));
        let velocity = 10.0_f64.powf(slower);
        let program = Program::from_deg(from).ptp_deg(to).velocity(velocity).build();
        let plan = plan(&program, sunrise());
        let section = &plan.sections()[0];
        let nodes = section.nodes(&section.pieces()[0]);
        prop_assert!(nodes.windows(2).all(|pair| pair[0].t_s < pair[1].t_s));
        let robot = Robot::default();
        let limits = robot.limits();
        let way: Joints = std::array::from_fn(|j| (to[j] - from[j]).to_radians());
        let scale = nodes.iter().fold(0.0_f64, |max, node| max.max(node.u[0].abs()));
        for pair in nodes.windows(2) {
            prop_assert!(pair[0].rate >= 0.0 && pair[0].p <= pair[1].p);
            prop_assert!((pair[0].u[1] - pair[1].u[0]).abs() <= 1e-9 * scale);
            for (j, way) in way.iter().enumerate() {
                let speed = (way * pair[1].rate).abs();
                let acceleration = (way * pair[1].u[0]).abs();
                prop_assert!(speed <= velocity * limits.velocity_rad_s[j] * (1.0 + 1e-9));
                prop_assert!(acceleration <= limits.acceleration_rad_s2[j] * (1.0 + 1e-9));
            }
        }
    }

    /// A longer way on the same line, with the same limits, takes longer; a slower motion takes at
    /// least as long.
    #[test]
    fn slower_takes_longer(from in pose(), to in pose(), slower in 0.05..1.0_f64) {
        let seconds = |velocity: f64| {
            let program = Program::from_deg(from).ptp_deg(to).velocity(velocity).build();
            plan(&program, sunrise()).motion_time_s()
        };
        prop_assert!(seconds(slower) >= seconds(1.0) * (1.0 - 1e-9));
    }
}

/// Short motions report the minimum duration, and not a speed limit that the program does not set.
#[test]
fn the_minimum_duration_is_named() {
    let planned = |motion: &str, timing: Timing| {
        let text = format!(
            r#"{{ "version": 1, "start": {{ "joints_deg": [0, 30, 0, -80, 0, 60, 0] }},
                "motions": [{motion}] }}"#
        );
        let trajectory = plan(&Program::from_json(&text).unwrap(), timing);
        trajectory.motions()[0].clone()
    };
    let cart = Limit::Motion { of: Limited::Way, kind: LimitKind::Velocity };
    let lin = r#"{ "type": "lin_rel", "offset": { "z_mm": 30 } }"#;
    let own = r#"{ "type": "lin_rel", "offset": { "z_mm": 30 }, "cart_velocity_mm_s": 50 }"#;
    let equal = r#"{ "type": "lin_rel", "offset": { "z_mm": 30 }, "cart_velocity_mm_s": 150 }"#;
    let wide = r#"{ "type": "lin_rel", "offset": { "z_mm": 30 }, "cart_velocity_mm_s": 500 }"#;
    let ptp = r#"{ "type": "ptp", "joints_deg": [3, 30, 0, -80, 0, 60, 0] }"#;
    for (motion, expected) in [
        (lin, Limit::MinimumDuration),
        (own, cart),
        (wide, Limit::MinimumDuration),
        (equal, Limit::MinimumDuration),
        (ptp, Limit::MinimumDuration),
    ] {
        let figures = planned(motion, sunrise());
        assert_eq!(figures.limited_by, Some(expected), "{motion}: {:?}", figures.limits);
        let named = |limit| figures.limits.iter().any(|active| active.limit == limit);
        assert!(!(named(cart) && named(Limit::MinimumDuration)), "{:?}", figures.limits);
        assert_ne!(
            planned(motion, Timing::jerk_limited()).limited_by,
            Some(Limit::MinimumDuration)
        );
    }
}
