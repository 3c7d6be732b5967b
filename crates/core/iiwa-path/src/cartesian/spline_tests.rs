//! Properties of splines, and curves computed independently.

use iiwa_kin::{
    Pose, Taylor,
    rotation::{Mat3, Vec3, apply, exp, log, norm, product, scaled, sub, transposed},
};
use proptest::prelude::*;

use super::{
    spline::{Between, Knot, SplinePiece, pieces},
    tcp_course::TcpCourse,
};

const SPL: Between = Between::Spl { is_constant: false };

fn knot(position_m: Vec3<f64>, turn_rad: Vec3<f64>, e1_rad: f64) -> Knot {
    Knot { pose: Pose { position_m, rotation: exp(&turn_rad) }, e1_rad }
}

fn spl(knots: &[Knot]) -> Vec<SplinePiece> {
    pieces(knots, &vec![SPL; knots.len() - 1]).unwrap()
}

/// Position, rotation and E1 with their derivatives with respect to the path parameter in m, at a
/// share of a piece.
fn at(piece: &SplinePiece, share: f64) -> ([Vec3<f64>; 3], [Mat3<f64>; 3], [f64; 3]) {
    let s = Taylor([share, 1.0 / piece.range_m, 0.0, 0.0]);
    let pose = piece.course.at(s);
    let position = pose.position_m.map(Taylor::derivatives);
    let rotation = pose.rotation.map(|row| row.map(Taylor::derivatives));
    let [e1] = piece.e1_rad.at(piece.course.arc_share(s)).map(Taylor::derivatives);
    (
        std::array::from_fn(|order| position.map(|x| x[order])),
        std::array::from_fn(|order| rotation.map(|row| row.map(|x| x[order]))),
        [e1[0], e1[1], e1[2]],
    )
}

/// Arc length by the trapezoidal rule on even intervals, with Richardson extrapolation.
fn length_m(piece: &SplinePiece) -> f64 {
    let sum = |intervals: i32| {
        let speed = |i: i32| norm(&at(piece, f64::from(i) / f64::from(intervals)).0[1]);
        let inner = (1..intervals).map(speed).sum::<f64>();
        piece.range_m * (inner + 0.5 * (speed(0) + speed(intervals))) / f64::from(intervals)
    };
    let [coarse, fine] = [2048, 4096].map(sum);
    fine + (fine - coarse) / 3.0
}

/// Share of a piece at a share of its arc length.
fn share_at_arc(piece: &SplinePiece, arc_share: f64) -> f64 {
    let [mut low, mut high] = [0.0, 1.0];
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if piece.course.arc_share(Taylor::constant(middle)).0[0] < arc_share {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::midpoint(low, high)
}

fn position(piece: &SplinePiece, share: f64) -> Vec3<f64> {
    at(piece, share).0[0]
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().map(f64::abs).fold(0.0, f64::max)
}

fn shares() -> impl Iterator<Item = f64> {
    (0..=16).map(|i| f64::from(i) / 16.0)
}

/// Knots with chords from 20 mm on, rotations up to 40 deg and E1 up to 30 deg.
fn any_knots(count: std::ops::RangeInclusive<usize>) -> impl Strategy<Value = Vec<Knot>> {
    let step = (
        prop::array::uniform3(-1.0..1.0_f64),
        0.02..0.2_f64,
        prop::array::uniform3(-0.4..0.4_f64),
        -0.5..0.5_f64,
    );
    prop::collection::vec(step, count).prop_map(|steps| {
        let mut position = [0.4, 0.1, 0.3];
        let knots = steps.into_iter().map(|(way, length, turn, e1)| {
            let unit = scaled(1.0 / norm(&way).max(1e-3), &way);
            position = std::array::from_fn(|i| position[i] + length * unit[i]);
            knot(position, turn, e1)
        });
        knots.collect()
    })
}

/// Knots without sharp reversals, at which derivatives by arc length are large.
fn smooth_knots(count: std::ops::RangeInclusive<usize>) -> impl Strategy<Value = Vec<Knot>> {
    any_knots(count).prop_filter("sharp reversal", |knots| {
        knots.windows(3).all(|three| {
            let [a, b] = [1, 2].map(|i| {
                let by = sub(&three[i].pose.position_m, &three[i - 1].pose.position_m);
                scaled(1.0 / norm(&by), &by)
            });
            norm(&sub(&a, &b)) < 1.8
        })
    })
}

proptest! {
    #[test]
    fn it_goes_through_its_knots(knots in any_knots(2..=8)) {
        let pieces = spl(&knots);
        for piece in &pieces {
            for (share, knot) in [(0.0, &knots[piece.segment]), (1.0, &knots[piece.segment + 1])] {
                let (position, rotation, e1) = at(piece, share);
                prop_assert!(largest(sub(&position[0], &knot.pose.position_m)) < 1e-12);
                let off = product(&transposed(&knot.pose.rotation), &rotation[0]);
                prop_assert!(norm(&log(&off)) < 1e-12);
                prop_assert!((e1[0] - knot.e1_rad).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn two_derivatives_go_on(knots in smooth_knots(3..=8)) {
        let pieces = spl(&knots);
        for ends in pieces.windows(2) {
            prop_assert!(!ends[0].stops);
            let (a, b) = (at(&ends[0], 1.0), at(&ends[1], 0.0));
            for order in 0..3 {
                // Rates of orientation and E1 increase as the shorter chord decreases.
                let tolerance = [1e-12, 1e-8, 1e-4][order];
                prop_assert!(
                    largest(sub(&a.0[order], &b.0[order])) < tolerance,
                    "position {order}"
                );
                let rotations = a.1[order].as_flattened().iter().zip(b.1[order].as_flattened());
                prop_assert!(largest(rotations.map(|(a, b)| a - b)) < tolerance, "turn {order}");
                prop_assert!((a.2[order] - b.2[order]).abs() < tolerance, "E1 {order}");
            }
        }
    }

    /// Orientation and E1 are linked to the arc length of the position.
    #[test]
    fn the_arc_length_is_that_of_the_position(knots in any_knots(3..=6)) {
        for piece in spl(&knots) {
            let length_m = length_m(&piece);
            for share in shares() {
                let [_, rate, ..] = piece.course.arc_share(Taylor::variable(share)).derivatives();
                let ([_, tangent, _], ..) = at(&piece, share);
                prop_assert!((length_m * rate - piece.range_m * norm(&tangent)).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn it_moves_with_its_knots(
        knots in any_knots(2..=6),
        turn in prop::array::uniform3(-2.0..2.0_f64),
        by in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        let rotation = exp(&turn);
        let moved = |p: &Vec3<f64>| {
            let turned = apply(&rotation, p);
            [0, 1, 2].map(|i| turned[i] + by[i])
        };
        let others: Vec<Knot> = knots.iter().map(|knot| Knot {
            pose: Pose {
                position_m: moved(&knot.pose.position_m),
                rotation: product(&rotation, &knot.pose.rotation),
            },
            e1_rad: knot.e1_rad,
        }).collect();
        for (a, b) in spl(&knots).iter().zip(&spl(&others)) {
            for share in shares() {
                let (a, b) = (at(a, share), at(b, share));
                prop_assert!(largest(sub(&moved(&a.0[0]), &b.0[0])) < 1e-10);
                let turned = product(&rotation, &a.1[0]);
                let pairs = turned.as_flattened().iter().zip(b.1[0].as_flattened());
                prop_assert!(largest(pairs.map(|(a, b)| a - b)) < 1e-9);
                prop_assert!((a.2[0] - b.2[0]).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn its_position_scales(knots in any_knots(2..=6), factor in 0.2..5.0_f64) {
        let scale = |knot: &Knot| {
            let position_m = scaled(factor, &knot.pose.position_m);
            Knot { pose: Pose { position_m, ..knot.pose }, ..*knot }
        };
        let others: Vec<Knot> = knots.iter().map(scale).collect();
        for (a, b) in spl(&knots).iter().zip(&spl(&others)) {
            for share in shares() {
                let off = sub(&scaled(factor, &position(a, share)), &position(b, share));
                prop_assert!(largest(off) < 1e-10);
            }
        }
    }

    /// The same knots in reverse give the same position and E1 exactly, and the same orientation
    /// about fixed axes.
    #[test]
    fn backwards_it_is_the_same(knots in any_knots(2..=6)) {
        let about_z = |knot: &Knot| knot_about_z(knot);
        let knots: Vec<Knot> = knots.iter().map(about_z).collect();
        let back: Vec<Knot> = knots.iter().rev().copied().collect();
        let (forth, back) = (spl(&knots), spl(&back));
        prop_assert_eq!(forth.len(), back.len());
        for (a, b) in forth.iter().zip(back.iter().rev()) {
            for share in shares() {
                let (a, b) = (at(a, share), at(b, 1.0 - share));
                prop_assert!(largest(sub(&a.0[0], &b.0[0])) < 1e-10);
                let pairs = a.1[0].as_flattened().iter().zip(b.1[0].as_flattened());
                prop_assert!(largest(pairs.map(|(a, b)| a - b)) < 1e-9);
                prop_assert!((a.2[0] - b.2[0]).abs() < 1e-9);
            }
        }
    }

    /// A knot changes the position up to two segments away, also at the ends of the spline.
    #[test]
    fn a_knot_acts_on_its_neighbourhood_alone(
        knots in any_knots(8..=8),
        which in 0..8_usize,
        by in prop::array::uniform3(-0.01..0.01_f64),
    ) {
        let mut others = knots.clone();
        others[which].pose.position_m = [0, 1, 2].map(|i| knots[which].pose.position_m[i] + by[i]);
        let [a, b] = [&knots, &others].map(|knots| spl(knots));
        for segment in 0..7 {
            // Both ends of the segment, and one neighbour of each.
            let near = segment.max(1) - 1..=segment + 2;
            let is_same = |a: &&SplinePiece| a.segment == segment;
            let (a, b): (Vec<_>, Vec<_>) =
                (a.iter().filter(is_same).collect(), b.iter().filter(is_same).collect());
            if near.contains(&which) {
                continue;
            }
            prop_assert_eq!(a.len(), b.len());
            for (a, b) in a.iter().zip(&b) {
                for share in shares() {
                    prop_assert_eq!(position(a, share), position(b, share));
                }
            }
        }
    }

    /// The link does not turn back: if E1 increases from knot to knot, E1 increases everywhere.
    #[test]
    fn e1_rises_with_its_knots(
        knots in any_knots(3..=7),
        steps in prop::collection::vec(prop_oneof![1e-3..0.01_f64, 0.05..0.5_f64], 7),
    ) {
        let mut e1_rad = -1.0;
        let knots: Vec<Knot> = knots.iter().zip(steps).map(|(knot, step)| {
            e1_rad += step;
            Knot { e1_rad, ..*knot }
        }).collect();
        for piece in spl(&knots) {
            for share in shares() {
                let (_, _, [_, rate, _]) = at(&piece, share);
                prop_assert!(rate > -1e-9, "{rate}");
            }
        }
    }
}

fn knot_about_z(knot: &Knot) -> Knot {
    let [.., z] = log(&knot.pose.rotation);
    Knot { pose: Pose { rotation: exp(&[0.0, 0.0, z]), ..knot.pose }, ..*knot }
}

/// Positions in m, E1 and the angle about z in rad, at shares of the arc length of each segment.
/// Computed with numpy: parabolas by interpolation, Hermite quintics, arc lengths by quadrature
/// with 80 points, the region of the link by alternating projections. The third segment has no
/// rotation: its orientation chord is 3e-4 rad.
#[test]
fn it_is_as_computed_independently() {
    let positions = [
        [0.0, 0.0, 0.0],
        [0.08, 0.02, 0.0],
        [0.11, 0.10, 0.03],
        [0.05, 0.14, 0.08],
        [0.01, 0.05, 0.06],
    ];
    let e1_deg: [f64; 5] = [10.0, 25.0, 31.0, 22.0, 24.0];
    let angles_deg: [f64; 5] = [0.0, 12.0, 30.0, 30.0, 21.0];
    let knots: Vec<Knot> = (0..5)
        .map(|i| knot(positions[i], [0.0, 0.0, angles_deg[i].to_radians()], e1_deg[i].to_radians()))
        .collect();
    let pieces = spl(&knots);
    let lengths = [0.084_694_24, 0.094_146_40, 0.091_683_13, 0.105_957_28];
    for (piece, length) in pieces.iter().zip(lengths) {
        assert!((length_m(piece) - length).abs() < 6e-9);
    }
    #[rustfmt::skip]
    let expected = [
        (0, 0.25, [0.021_050_700_560, 0.000_025_894_950, -0.002_166_943_527],
         0.243_775_610_248, 0.051_538_271_441),
        (0, 0.50, [0.042_002_332_185, 0.002_720_814_490, -0.003_219_214_575],
         0.321_413_151_558, 0.101_188_666_894),
        (0, 0.75, [0.062_140_041_512, 0.009_088_583_759, -0.002_667_486_877],
         0.390_681_220_206, 0.152_556_664_989),
        (1, 0.25, [0.094_699_968_092, 0.037_469_101_196, 0.005_198_441_896],
         0.472_976_976_032, 0.302_380_395_225),
        (1, 0.50, [0.104_363_398_897, 0.057_965_848_485, 0.011_443_079_601],
         0.502_078_593_099, 0.459_919_155_996),
        (1, 0.75, [0.110_332_709_305, 0.079_367_237_739, 0.019_095_584_790],
         0.526_079_297_181, 0.521_718_282_551),
        (2, 0.25, [0.100_331_740_366, 0.115_892_876_073, 0.043_093_547_583],
         0.526_351_386_892, 0.523_598_857_377),
        (2, 0.50, [0.085_875_831_395, 0.127_955_832_171, 0.056_121_773_711],
         0.433_283_388_077, 0.523_598_883_220),
        (2, 0.75, [0.069_330_121_226, 0.137_400_613_680, 0.068_821_942_648],
         0.377_981_840_286, 0.523_598_886_176),
        (3, 0.25, [0.031_110_881_084, 0.122_753_649_234, 0.082_100_202_505],
         0.392_890_689_555, 0.522_888_677_200),
        (3, 0.50, [0.020_842_820_696, 0.099_028_149_659, 0.076_681_663_191],
         0.400_213_773_566, 0.504_879_585_296),
        (3, 0.75, [0.014_426_693_078, 0.074_554_093_185, 0.068_884_904_829],
         0.408_228_684_011, 0.443_878_818_913),
    ];
    for (segment, share, place, e1_rad, angle_rad) in expected {
        let (position, rotation, e1) = at(&pieces[segment], share_at_arc(&pieces[segment], share));
        assert!(largest(sub(&position[0], &place)) < 1e-11, "{segment} {share}");
        assert!((e1[0] - e1_rad).abs() < 1e-9, "{segment} {share} {} {e1_rad}", e1[0]);
        let [_, _, angle] = log(&rotation[0]);
        assert!((angle - angle_rad).abs() < 1e-9, "{segment} {share} {angle} {angle_rad}");
    }
}

/// X, Y, X, Z: the TCP stops at Y and at the first X of both. Up to Y, the tangent is 0 by chord
/// length only.
#[test]
fn it_stops_where_it_turns_back() {
    let x = knot([0.1, 0.0, 0.0], [0.1, 0.0, 0.0], 0.2);
    let y = knot([0.2, 0.05, 0.0], [0.2, 0.0, 0.1], 0.5);
    let knots = [
        knot([0.0, 0.02, 0.0], [0.0; 3], 0.0),
        x,
        y,
        x,
        knot([0.05, 0.1, 0.02], [0.0, 0.3, 0.0], -0.2),
    ];
    let pieces = spl(&knots);
    let stops: Vec<bool> = pieces.iter().map(|piece| piece.stops).collect();
    assert_eq!(stops, [true, true, false, false]);
    // Position: the direction continues at X, and reverses at Y.
    let tangent = |i: usize, share: f64| at(&pieces[i], share).0[1];
    assert!(largest(sub(&tangent(0, 1.0), &tangent(1, 0.0))) < 1e-9);
    let (forth, back) = (tangent(1, 1.0), tangent(2, 0.0));
    assert!(largest([0, 1, 2].map(|i| forth[i] + back[i])) < 1e-9);
    // E1: from the end of one spline to the start of another at X, at rest at Y.
    let e1 = |i: usize, share: f64| at(&pieces[i], share).2;
    assert!((e1(0, 1.0)[1] - e1(1, 0.0)[1]).abs() > 0.1);
    assert!(e1(1, 1.0)[1].abs() < 1e-9 && e1(2, 0.0)[1].abs() < 1e-9);
    // The first segment alone: E1 is linear.
    let middle = share_at_arc(&pieces[0], 0.5);
    assert!((e1(0, middle)[0] - 0.1).abs() < 1e-12);
    // As the start of a spline, X needs no stop.
    let stops: Vec<bool> = spl(&knots[1..]).iter().map(|piece| piece.stops).collect();
    assert_eq!(stops, [true, false, false]);
}

/// At a near reversal, the curve continues with a bend.
#[test]
fn it_does_not_stop_where_it_nearly_turns_back() {
    let knots = [
        knot([0.0, 0.0, 0.0], [0.0; 3], 0.0),
        knot([0.1, 0.0, 0.0], [0.0; 3], 0.0),
        knot([0.0, 0.02, 0.0], [0.0; 3], 0.0),
    ];
    assert!(spl(&knots).iter().all(|piece| !piece.stops));
}

/// A line to 100 mm and back to 40 mm: the TCP reverses beyond the knot.
#[test]
fn it_stops_where_it_turns_back_between_knots() {
    let knots = [0.0, 0.1, 0.04].map(|x| knot([x, 0.0, 0.0], [0.0; 3], 10.0 * x));
    let pieces = spl(&knots);
    let stops: Vec<bool> = pieces.iter().map(|piece| piece.stops).collect();
    assert_eq!(stops, [true, false, false]);
    // The parabola through all three knots is 0.1 + m u + c u^2 / 2 with m = (0.06 - 0.1) / 0.16
    // and c = -4 / 0.16. It increases up to 0.1 + m^2 / (2 |c|) at u = m / |c|, on the first
    // segment.
    let peak = 0.1 + 0.25 * 0.25 / 50.0;
    assert!((position(&pieces[0], 1.0)[0] - peak).abs() < 1e-9);
    assert!((length_m(&pieces[0]) + length_m(&pieces[1]) - (peak + peak - 0.1)).abs() < 1e-6);
    let e1 = |piece: &SplinePiece, share: f64| at(piece, share).2;
    // In reverse from there, E1 continues.
    let (end, start) = (e1(&pieces[0], 1.0), e1(&pieces[1], 0.0));
    assert!((end[0] - start[0]).abs() < 1e-9 && end[1] * start[1] > 0.0);
}

#[test]
fn a_repeated_point_parts_the_spline() {
    let knots = [
        knot([0.0, 0.0, 0.0], [0.0; 3], 0.0),
        knot([0.1, 0.0, 0.0], [0.1, 0.0, 0.0], 0.3),
        knot([0.1, 0.1, 0.0], [0.0; 3], 0.1),
        knot([0.1, 0.1, 0.0], [0.0; 3], 0.1),
        knot([0.0, 0.1, 0.1], [0.0, 0.1, 0.0], 0.2),
        knot([0.0, 0.2, 0.1], [0.0; 3], 0.0),
    ];
    let whole = spl(&knots);
    let stops: Vec<(usize, bool)> =
        whole.iter().map(|piece| (piece.segment, piece.stops)).collect();
    assert_eq!(stops, [(0, false), (1, true), (3, false), (4, false)]);
    let parts = [spl(&knots[..3]), spl(&knots[3..])].concat();
    for (a, b) in whole.iter().zip(&parts) {
        for share in shares() {
            let (a, b) = (at(a, share), at(b, share));
            assert_eq!((a.0[0], a.1[0], a.2[0]), (b.0[0], b.1[0], b.2[0]));
        }
    }
}

/// The TCP stops before and after a change of orientation or E1 alone.
#[test]
fn a_turn_in_place_is_a_separate_piece() {
    let knots = [
        knot([0.0, 0.0, 0.0], [0.0; 3], 0.0),
        knot([0.1, 0.0, 0.0], [0.0; 3], 0.0),
        knot([0.1, 0.0, 0.0], [0.0, 0.4, 0.0], 0.3),
        knot([0.1, 0.1, 0.0], [0.0; 3], 0.0),
    ];
    let pieces = spl(&knots);
    let stops: Vec<bool> = pieces.iter().map(|piece| piece.stops).collect();
    assert_eq!(stops, [true, true, false]);
    assert_eq!(pieces[1].range_m, 0.0);
}

/// Next to a line, position, orientation and E1 have its rates; a large rate of E1 does not make
/// the others turn back.
#[test]
fn next_to_a_line_it_takes_its_rates() {
    let knots = [
        knot([0.0, 0.0, 0.0], [0.0; 3], 0.0),
        knot([0.1, 0.0, 0.0], [0.1, 0.0, 0.0], 0.0),
        knot([0.1, 0.1, 0.0], [0.1, 0.2, 0.0], 1.0),
        knot([0.2, 0.1, 0.05], [0.0; 3], 1.0),
        knot([0.3, 0.0, 0.05], [0.0; 3], 1.1),
    ];
    let line = TcpCourse::line(&knots[1].pose, &knots[2].pose, false).unwrap();
    let between = [SPL, Between::Course(Box::new(line)), SPL, SPL];
    let pieces = pieces(&knots, &between).unwrap();
    assert!(pieces.iter().all(|piece| !piece.stops));
    for ends in pieces.windows(2) {
        let (a, b) = (at(&ends[0], 1.0), at(&ends[1], 0.0));
        for order in 0..3 {
            assert!(largest(sub(&a.0[order], &b.0[order])) < 1e-9);
            let rotations = a.1[order].as_flattened().iter().zip(b.1[order].as_flattened());
            assert!(largest(rotations.map(|(a, b)| a - b)) < 1e-9);
            assert!((a.2[order] - b.2[order]).abs() < 1e-9);
        }
    }
    for piece in &pieces {
        for share in shares() {
            assert!((-0.3..1.5).contains(&at(piece, share).2[0]));
        }
    }
}
