//! Geometry of paths: derivatives, joins, and the search for the start of Cartesian blends.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::panic)]

use iiwa_kin::{Joints, Pose, Robot};
use iiwa_path::{BlendSearch, BlendShape, Continuity, JointPath, PathOptions, Segment, Step};
use iiwa_program::{Blend, Motion, Program, Ptp, Sources, Start, Workcell};
use proptest::prelude::*;

const SHAPES: [BlendShape; 6] = [
    BlendShape::Iiwa,
    BlendShape::Alpha(Continuity::First),
    BlendShape::Alpha(Continuity::Second),
    BlendShape::Alpha(Continuity::Third),
    BlendShape::MinAcceleration,
    BlendShape::Circle,
];

/// Number of continuous derivatives by arc length where a blend meets a line.
fn smoothness(shape: BlendShape) -> usize {
    match shape {
        BlendShape::Alpha(Continuity::First) | BlendShape::Circle => 1,
        BlendShape::Alpha(Continuity::Third) => 3,
        _ => 2,
    }
}

fn norm(v: &Joints) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn minus(a: &Joints, b: &Joints) -> Joints {
    std::array::from_fn(|j| a[j] - b[j])
}

fn between(a: &Joints, b: &Joints, u: f64) -> Joints {
    std::array::from_fn(|j| a[j] + u * (b[j] - a[j]))
}

fn path(shape: BlendShape, start: Joints, motions: Vec<Ptp>) -> JointPath {
    let motions = motions.into_iter().map(Motion::Ptp).collect();
    let program = Program {
        robot: None,
        start: Start::Joints(start),
        motions,
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let options = PathOptions { blend_shape: shape, ..PathOptions::default() };
    JointPath::with_options(&program, &Robot::lbr_iiwa_7_r800(), options).unwrap()
}

fn segments(path: &JointPath) -> impl Iterator<Item = &dyn Segment> {
    path.steps().iter().filter_map(|step| match step {
        Step::Move { segment, .. } => Some(segment.as_ref()),
        _ => None,
    })
}

fn shape() -> impl Strategy<Value = BlendShape> {
    prop::sample::select(&SHAPES[..])
}

/// Poses well inside the joint ranges, so that blends stay inside.
fn pose() -> impl Strategy<Value = Joints> {
    prop::array::uniform7(-1.2..1.2_f64)
}

fn far_apart(poses: &[Joints]) -> bool {
    poses.windows(2).all(|pair| norm(&minus(&pair[1], &pair[0])) > 0.3)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, ..ProptestConfig::default() })]

    #[test]
    fn derivatives_are_those_of_the_position(
        shape in shape(), poses in prop::array::uniform3(pose()), fraction in 0.05..0.5_f64,
        s in 0.01..0.99_f64,
    ) {
        prop_assume!(far_apart(&poses));
        let [a, b, c] = poses;
        let path = path(shape, a, vec![Ptp::to(b).blend(Blend::Fraction(fraction)), Ptp::to(c)]);
        for segment in segments(&path) {
            const H: f64 = 1e-3;
            // Five-point differences have an error of h^4 / 30 times the fifth derivative.
            let difference = |of: fn(&dyn Segment, f64) -> Joints| -> Joints {
                let at = |k: f64| of(segment, s + k * H);
                let [m2, m1, p1, p2] = [at(-2.0), at(-1.0), at(1.0), at(2.0)];
                std::array::from_fn(|j| {
                    (m2[j] - p2[j] + 8.0 * (p1[j] - m1[j])) / (12.0 * H)
                })
            };
            let at = segment.at(s);
            let close = |actual: Joints, expected: Joints| norm(&minus(&actual, &expected)) < 2e-7;
            prop_assert!(close(at.dq, difference(|segment, s| segment.at(s).q)));
            prop_assert!(close(at.ddq, difference(|segment, s| segment.at(s).dq)));
            prop_assert!(close(at.dddq, difference(|segment, s| segment.at(s).ddq)));
        }
    }

    /// Derivatives are by arc length, because ds/dt differs from segment to segment.
    #[test]
    fn pieces_join_smoothly(
        shape in shape(), poses in prop::array::uniform5(pose()),
        fractions in prop::array::uniform3(0.05..=0.5_f64),
    ) {
        prop_assume!(far_apart(&poses));
        let motions = (1..5)
            .map(|i| {
                let blend = fractions.get(i - 1).copied().map(Blend::Fraction);
                Ptp { blend, ..Ptp::to(poses[i]) }
            })
            .collect();
        let path = path(shape, poses[0], motions);
        let pieces: Vec<_> = segments(&path).collect();
        prop_assert!(pieces.len() >= 5);
        prop_assert_eq!(pieces[0].at(0.0).q, poses[0]);
        prop_assert!(norm(&minus(&pieces[pieces.len() - 1].at(1.0).q, &poses[4])) < 1e-14);
        for pair in pieces.windows(2) {
            let (before, after) = (pair[0].at(1.0), pair[1].at(0.0));
            let (t0, t1) = (pair[0].tangent_lengths_rad()[1], pair[1].tangent_lengths_rad()[0]);
            prop_assert!((norm(&before.dq) / t0 - 1.0).abs() < 1e-9);
            prop_assert!((norm(&after.dq) / t1 - 1.0).abs() < 1e-9);
            prop_assert!(norm(&minus(&before.q, &after.q)) < 1e-9);
            // The direction of a tiny line is a difference of 1e-16.
            if t0.min(t1) < 1e-6 {
                continue;
            }
            let by_length = |v: Joints, t: f64, n: i32| v.map(|v| v / t.powi(n));
            let jump = |a: Joints, b: Joints, n: i32| {
                norm(&minus(&by_length(a, t0, n), &by_length(b, t1, n)))
            };
            prop_assert!(jump(before.dq, after.dq, 1) < 1e-9);
            if smoothness(shape) >= 2 {
                prop_assert!(jump(before.ddq, after.ddq, 2) < 1e-9);
            }
            if smoothness(shape) >= 3 {
                prop_assert!(jump(before.dddq, after.dddq, 3) < 1e-7);
            }
        }
    }

    /// The reach follows Larsen 2019, Algorithm 3, and the angle Eq. 28.
    #[test]
    fn blends_reach_equally_far_on_both_sides(
        shape in shape(), poses in prop::array::uniform3(pose()), size in 4.0..1000.0_f64,
    ) {
        prop_assume!(far_apart(&poses));
        let [a, b, c] = poses;
        let path = path(shape, a, vec![Ptp::to(b).blend(Blend::CartMm(size)), Ptp::to(c)]);
        let (corner, blend) = path.blends().next().unwrap();
        let (start, end) = (blend.at(0.0).q, blend.at(1.0).q);
        let reach = [norm(&minus(&b, &start)), norm(&minus(&end, &b))];
        prop_assert!((reach[0] - reach[1]).abs() < 1e-12);
        let lengths = [norm(&minus(&b, &a)), norm(&minus(&c, &b))];
        prop_assert!(reach[0] <= 0.5 * lengths[0].min(lengths[1]) + 1e-12);
        let cosine = (0..7).map(|j| (b[j] - a[j]) * (c[j] - b[j])).sum::<f64>();
        let gamma = (cosine / (lengths[0] * lengths[1])).acos().to_degrees();
        prop_assert!((corner.gamma_deg - gamma).abs() < 1e-6);

        // One of the two ends is on the sphere, unless half of a segment is reached first.
        let robot = path.robot();
        let crossing = |other: &Joints, length: f64| {
            BlendSearch::FirstCrossing
                .crossing(robot, &[0.0; 3], &b, other, size * 1e-3)
                .unwrap_or(0.5)
                * length
        };
        let expected = crossing(&a, lengths[0]).min(crossing(&c, lengths[1]));
        prop_assert!((reach[0] - expected).abs() < 1e-12);
    }
}

/// Distance of the TCP at `u` from its position at `point`, in m.
fn distance(robot: &Robot, tcp: &[f64; 3], point: &Joints, other: &Joints, u: f64) -> f64 {
    let tcp = Pose { position_m: *tcp, ..Pose::IDENTITY };
    let at = |q: &Joints| robot.flange_pose(q).then(&tcp).position_m;
    let (a, b) = (at(point), at(&between(point, other, u)));
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

/// The flange, or a TCP with an offset in any direction.
fn any_tcp() -> impl Strategy<Value = [f64; 3]> {
    prop_oneof![Just([0.0; 3]), prop::array::uniform3(-0.3..=0.3_f64)]
}

fn anywhere() -> impl Strategy<Value = Joints> {
    let limits = Robot::lbr_iiwa_7_r800().limits().upper_rad;
    prop::array::uniform7(-1.0..=1.0_f64)
        .prop_map(move |share| std::array::from_fn(|j| share[j] * limits[j]))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    /// Comparison with a brute-force search.
    #[test]
    fn the_first_crossing_is_the_first(
        point in anywhere(),
        other in anywhere(),
        radius in prop_oneof![1e-3..0.1_f64, 0.1..1.5_f64],
        tcp in any_tcp(),
    ) {
        const SAMPLES: u32 = 1000;
        let robot = Robot::lbr_iiwa_7_r800();
        let actual = BlendSearch::FirstCrossing.crossing(&robot, &tcp, &point, &other, radius);
        if let Some(u) = actual {
            prop_assert!((0.0..=0.5).contains(&u));
            prop_assert!((distance(&robot, &tcp, &point, &other, u) - radius).abs() < 1e-9);
        }
        let end = actual.unwrap_or(0.5);
        for i in 0..SAMPLES {
            let u = end * f64::from(i) / f64::from(SAMPLES);
            prop_assert!(distance(&robot, &tcp, &point, &other, u) < radius + 1e-12, "already at \
                                                                                      {u}");
        }

        // Algorithm 2 is never earlier, and late by at most one step unless the robot returns into
        // the sphere.
        let late = BlendSearch::Algorithm2.crossing(&robot, &tcp, &point, &other, radius);
        let Some(u) = actual else {
            prop_assert!(late.is_none_or(|late| late == 0.5));
            return Ok(());
        };
        prop_assert!(late.is_none_or(|late| late >= u - 1e-9));
        let stays = (0..=100).all(|i| {
            distance(&robot, &tcp, &point, &other, u + 1e-5 * f64::from(i)) >= radius - 1e-12
        });
        if stays && u <= 0.499 {
            prop_assert!(late.unwrap() <= u + 0.001 + 1e-9);
        }

        // Algorithm 1 finds an arbitrary crossing or none.
        if let Some(u) = BlendSearch::Algorithm1.crossing(&robot, &tcp, &point, &other, radius) {
            prop_assert!((distance(&robot, &tcp, &point, &other, u) - radius).abs() <= 1e-9);
        }
    }

    /// All three searches terminate if the sphere is out of reach, and without motion.
    #[test]
    fn no_search_hangs(
        point in anywhere(),
        other in anywhere(),
        still in any::<bool>(),
        radius in prop_oneof![3.0..10.0_f64, 3.0..1e100_f64],
    ) {
        let robot = Robot::lbr_iiwa_7_r800();
        let other = if still { point } else { other };
        for search in
            [BlendSearch::FirstCrossing, BlendSearch::Algorithm1, BlendSearch::Algorithm2]
        {
            prop_assert_eq!(search.crossing(&robot, &[0.0; 3], &point, &other, radius), None);
        }
    }
}

/// A segment with only the required methods and sigma.
#[derive(Debug)]
struct Plain<'a>(&'a dyn Segment);

impl Segment for Plain<'_> {
    fn at(&self, s: f64) -> iiwa_path::Derivatives {
        self.0.at(s)
    }

    fn bend_bound_rad(&self) -> Joints {
        self.0.bend_bound_rad()
    }

    fn sigma(&self, s: f64) -> [f64; 4] {
        self.0.sigma(s)
    }
}

#[test]
fn shorter_ways_lead_to_the_same_derivatives() {
    let start = [0.0; 7];
    let corner = [0.4, 0.1, -0.3, 0.2, 0.0, -0.5, 0.3];
    let end = [0.1, 0.5, -0.2, 0.6, -0.4, 0.1, 0.7];
    for shape in [BlendShape::Iiwa, BlendShape::Alpha(Continuity::Third)] {
        let path =
            path(shape, start, vec![Ptp::to(corner).blend(Blend::Fraction(0.4)), Ptp::to(end)]);
        for segment in segments(&path) {
            let plain = Plain(segment);
            for s in (0..=20).map(|i| f64::from(i) / 20.0) {
                let [actual, expected] = [segment.sigma_derivatives(s), plain.sigma_derivatives(s)];
                for (actual, expected) in actual.iter().zip(&expected) {
                    let error = norm(&minus(actual, expected));
                    assert!(error <= 1e-12 * (1.0 + norm(expected)), "{segment:?} at {s}: {error}");
                }
                let sigma = segment.sigma(s)[0];
                assert!((segment.s_at(sigma) - s).abs() < 1e-14);
                assert!((plain.s_at(sigma) - s).abs() < 1e-14);
            }
        }
    }
}

/// Only joint 7 turns: the TCP is on its axis and does not move.
#[test]
fn a_tcp_that_does_not_move_crosses_no_sphere() {
    let robot = Robot::lbr_iiwa_7_r800();
    let point = [0.3, 0.4, 0.5, -0.6, 0.7, 0.8, -2.0];
    let other = [0.3, 0.4, 0.5, -0.6, 0.7, 0.8, 2.0];
    for search in [BlendSearch::FirstCrossing, BlendSearch::Algorithm1, BlendSearch::Algorithm2] {
        assert_eq!(search.crossing(&robot, &[0.0; 3], &point, &other, 0.004), None, "{search:?}");
    }
}

/// The TCP moves away to 332.564 mm and returns, and is outside of 332.563 mm for less than one
/// step of Algorithm 2, which steps over both crossings. Found by a search among random poses.
#[test]
fn a_sphere_that_is_crossed_twice_within_one_step() {
    let robot = Robot::lbr_iiwa_7_r800();
    let point = [160.0, 15.0, 145.0, -60.0, -50.0, -40.0, 0.0].map(f64::to_radians);
    let other = [-160.0, -15.0, 0.0, 115.0, -45.0, -60.0, 0.0].map(f64::to_radians);
    let radius = 0.332_563_5;
    let distance = |u: f64| distance(&robot, &[0.0; 3], &point, &other, u);

    // Outside between two multiples of 0.001, inside at both.
    assert!(distance(0.217) < radius && distance(0.2175) > radius && distance(0.218) < radius);

    let first =
        BlendSearch::FirstCrossing.crossing(&robot, &[0.0; 3], &point, &other, radius).unwrap();
    assert!(first > 0.217 && first < 0.2175, "{first}");
    assert!((distance(first) - radius).abs() < 1e-9);

    // Algorithm 2 misses both crossings, and the sphere is not reached again in the first half.
    assert_eq!(BlendSearch::Algorithm2.crossing(&robot, &[0.0; 3], &point, &other, radius), None);

    // From the other end to the point and back: the blend starts at the first crossing, or more
    // than twice too early.
    let reach = |blend_search| {
        let ptp = Ptp::to(point).blend(Blend::CartMm(1e3 * radius));
        let motions = vec![Motion::Ptp(ptp), Motion::Ptp(Ptp::to(other))];
        let program = Program {
            robot: None,
            start: Start::Joints(other),
            motions,
            workcell: Workcell::default(),
            sources: Sources::default(),
        };
        let options = PathOptions { blend_search, ..PathOptions::default() };
        let path = JointPath::with_options(&program, &robot, options).unwrap();
        path.blends().next().unwrap().1.tangent_lengths_rad()[0]
    };
    let length = norm(&minus(&other, &point));
    assert!((reach(BlendSearch::FirstCrossing) / length - first).abs() < 1e-12);
    assert!((reach(BlendSearch::Algorithm2) / length - 0.5).abs() < 1e-12);
}

/// Algorithm 1 bisects the segment, and may end at another crossing than the nearest.
#[test]
fn algorithm_1_may_find_another_crossing() {
    let robot = Robot::lbr_iiwa_7_r800();
    let point = [160.0, 15.0, 145.0, -60.0, -50.0, -40.0, 0.0].map(f64::to_radians);
    let other = [-160.0, -15.0, 0.0, 115.0, -45.0, -60.0, 0.0].map(f64::to_radians);
    let radius = 0.332_563_5;
    let first =
        BlendSearch::FirstCrossing.crossing(&robot, &[0.0; 3], &point, &other, radius).unwrap();
    let actual = BlendSearch::Algorithm1.crossing(&robot, &[0.0; 3], &point, &other, radius);
    assert!(actual.is_none_or(|actual| actual > first + 1e-4), "{actual:?}");
}
