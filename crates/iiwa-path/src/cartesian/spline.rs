//! The segments of a spline: through given frames, with derivatives at each from its neighbours.
//!
//! All is by one parameter u, in m: the length of the chords and arcs between the frames. Position, orientation and E1
//! are quintic polynomials on SPL segments, which meet their neighbours with two derivatives.

use iiwa_kin::{
    MovingPose, Pose, Taylor,
    rotation::{Mat3, Vec3, constant, exp, log, norm, product, scaled, sub, transposed},
};

use iiwa_program::CourseFault;

use super::tcp_course::{TcpCourse, turn_between};

/// Where the TCP is at the end of a segment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Knot {
    pub(crate) pose: Pose,
    pub(crate) e1_rad: f64,
}

/// What is between two knots.
#[derive(Clone, Debug)]
pub(crate) enum Between {
    /// A curve that the knots and their neighbours define; with the orientation of its start, if `is_constant`.
    Spl { is_constant: bool },
    /// A line or a circle, with E1 evenly along it.
    Course(Box<TcpCourse>),
}

/// A segment between two knots.
#[derive(Clone, Debug)]
pub(crate) struct SplinePiece {
    pub(crate) course: TcpCourse,
    /// E1 as a polynomial in s, the lowest power first, in rad.
    pub(crate) e1_rad: [f64; 6],
    /// Length in u, in m.
    pub(crate) length_m: f64,
    /// Whether the TCP stops at its end, because the next one starts another way.
    pub(crate) stops: bool,
}

/// One rad counts as so much of u, in m, at least: a matter of choice. Without it, a frame that was taught for a turn in place
/// would be at next to no distance, and the curve would have to turn as fast before and after.
const M_A_RAD: f64 = 0.1;

/// Shorter than this in u, in m, a segment goes nowhere.
const NOWHERE_M: f64 = 1e-9;

/// So much may rates differ, by u, for the path to be smooth.
const SMOOTH: f64 = 1e-6;

/// First and second derivatives by u of position, rotation vector, in the frame of the knot, and E1.
type Rates = [[f64; 7]; 2];

/// Which of the seven are the position, the orientation and E1.
const CHANNELS: [std::ops::Range<usize>; 3] = [0..3, 3..6, 6..7];

/// What a segment says of the rates at a knot: of each channel, or nothing.
#[derive(Clone, Copy, Debug, Default)]
struct Says {
    rates: Rates,
    of: [bool; 3],
}

/// The curves of the segments between `knots`, each with the index of its segment. There is one more knot than segments;
/// segments that go nowhere are left out.
///
/// # Errors
///
/// The segment that turns by half a turn.
pub(crate) fn pieces(
    knots: &[Knot],
    between: &[Between],
) -> Result<Vec<(usize, SplinePiece)>, (usize, CourseFault)> {
    let mut turns = Vec::with_capacity(between.len());
    let mut lengths = Vec::with_capacity(between.len());
    for (index, (ends, segment)) in knots.windows(2).zip(between).enumerate() {
        let [a, b] = [&ends[0], &ends[1]];
        let turn = turn_between(&a.pose, &b.pose).map_err(|fault| (index, fault))?;
        let way = match segment {
            Between::Course(course) => course.lengths()[0],
            Between::Spl { .. } => norm(&sub(&b.pose.position_m, &a.pose.position_m)),
        };
        let other = norm(&turn).max((b.e1_rad - a.e1_rad).abs());
        lengths.push(way.max(M_A_RAD * other));
        turns.push(turn);
    }
    // Segments that go nowhere would be knots of no distance.
    let kept: Vec<usize> = (0..between.len()).filter(|i| lengths[*i] > NOWHERE_M).collect();
    let Some(last) = kept.last() else { return Ok(Vec::new()) };
    let sequence = KnotSequence {
        knots: kept.iter().map(|i| knots[*i]).chain([knots[last + 1]]).collect(),
        between: kept.iter().map(|i| &between[*i]).collect(),
        turns: kept.iter().map(|i| turns[*i]).collect(),
        lengths: kept.iter().map(|i| lengths[*i]).collect(),
    };
    Ok(kept.iter().copied().zip(sequence.pieces()).collect())
}

/// A spline without segments that go nowhere.
struct KnotSequence<'a> {
    knots: Vec<Knot>,
    between: Vec<&'a Between>,
    /// Rotation vectors from knot to knot.
    turns: Vec<Vec3<f64>>,
    lengths: Vec<f64>,
}

impl KnotSequence<'_> {
    fn pieces(&self) -> Vec<SplinePiece> {
        let count = self.between.len();
        // Before and after each knot, and whether they agree.
        let rates: Vec<([Rates; 2], bool)> = (0..=count).map(|knot| self.rates(knot)).collect();
        let piece = |i: usize| SplinePiece {
            course: self.course(i, [&rates[i].0[1], &rates[i + 1].0[0]]),
            e1_rad: self.e1(i, [&rates[i].0[1], &rates[i + 1].0[0]]),
            length_m: self.lengths[i],
            stops: i + 1 < count && !rates[i + 1].1,
        };
        (0..count).map(piece).collect()
    }

    /// The rates before and after a knot, and whether they are the same.
    fn rates(&self, knot: usize) -> ([Rates; 2], bool) {
        let before = if knot > 0 { self.says(knot - 1, 1) } else { Says::default() };
        let after = if knot < self.between.len() { self.says(knot, 0) } else { Says::default() };
        let own = self.rates_by_neighbours(knot);
        let (mut rates, mut is_smooth) = ([own; 2], true);
        for (channel, range) in CHANNELS.into_iter().enumerate() {
            let of = |says: &Says| says.of[channel].then_some(says.rates);
            let (from, to) = match (of(&before), of(&after)) {
                (Some(before), Some(after)) => (before, after),
                (Some(said), None) | (None, Some(said)) => (said, said),
                (None, None) => continue,
            };
            for i in range {
                for order in 0..2 {
                    rates[0][order][i] = from[order][i];
                    rates[1][order][i] = to[order][i];
                    is_smooth &= (to[order][i] - from[order][i]).abs() <= SMOOTH;
                }
            }
        }
        (rates, is_smooth)
    }

    /// What a segment says of the rates at its end, 0 or 1.
    fn says(&self, segment: usize, end: usize) -> Says {
        match self.between[segment] {
            Between::Spl { is_constant } => {
                Says { rates: Rates::default(), of: [false, *is_constant, false] }
            }
            Between::Course(course) => {
                let MovingPose { position_m, rotation } =
                    course.at(Taylor::variable(if end == 0 { 0.0 } else { 1.0 }));
                let knot = constant(&transposed(&rotation.map(|row| row.map(|x| x.0[0]))));
                let turn = log(&product(&knot, &rotation));
                let length = self.lengths[segment];
                let e1 = self.knots[segment + 1].e1_rad - self.knots[segment].e1_rad;
                let mut rates = Rates::default();
                for i in 0..3 {
                    for (channel, series) in [(0, position_m[i]), (3, turn[i])] {
                        let [_, one, two, _] = series.derivatives();
                        rates[0][channel + i] = one / length;
                        rates[1][channel + i] = two / (length * length);
                    }
                }
                rates[0][6] = e1 / length;
                Says { rates, of: [true; 3] }
            }
        }
    }

    /// The rates at a knot of the polynomial through it and two neighbours on either side, as far as there are.
    fn rates_by_neighbours(&self, knot: usize) -> Rates {
        let range = knot.saturating_sub(2)..=(knot + 2).min(self.between.len());
        // u of the neighbours, from this knot on.
        let u: Vec<f64> = range.clone().map(|other| self.distance(knot, other)).collect();
        let values: Vec<[f64; 7]> = range.map(|other| self.seen_from(knot, other)).collect();
        let mut rates = Rates::default();
        for (k, value) in values.iter().enumerate() {
            // Lagrange's polynomial that is 1 at this neighbour and 0 at the others.
            let others = (0..u.len()).filter(|j| *j != k);
            let basis = others.fold(Taylor::constant(1.0), |product, j| {
                product * (Taylor::variable(0.0) - Taylor::constant(u[j])) * (1.0 / (u[k] - u[j]))
            });
            let [_, one, two, _] = basis.derivatives();
            for i in 0..7 {
                rates[0][i] += one * value[i];
                rates[1][i] += two * value[i];
            }
        }
        rates
    }

    fn distance(&self, knot: usize, other: usize) -> f64 {
        if other < knot {
            -self.lengths[other..knot].iter().sum::<f64>()
        } else {
            self.lengths[knot..other].iter().sum()
        }
    }

    /// Position, rotation vector and E1 of a knot, as differences from another that is at most two away.
    fn seen_from(&self, knot: usize, other: usize) -> [f64; 7] {
        let (a, b) = (&self.knots[knot], &self.knots[other]);
        let by = sub(&b.pose.position_m, &a.pose.position_m);
        let turn = self.turn(knot, other);
        let [x, y, z] = by;
        let [a_x, a_y, a_z] = turn;
        [x, y, z, a_x, a_y, a_z, b.e1_rad - a.e1_rad]
    }

    /// The rotation vector from a knot to another that is at most two away. Two turns may be more than half a turn
    /// together: then it is the one that is next to their sum.
    fn turn(&self, knot: usize, other: usize) -> Vec3<f64> {
        let (from, to) = (knot.min(other), knot.max(other));
        let steps = &self.turns[from..to];
        let rotation = |i: usize| &self.knots[i].pose.rotation;
        let between = product(&transposed(rotation(knot)), rotation(other));
        match steps {
            [] => [0.0; 3],
            [step] => scaled(if other < knot { -1.0 } else { 1.0 }, step),
            _ => {
                let sum: Vec3<f64> = std::array::from_fn(|i| steps.iter().map(|s| s[i]).sum());
                let sum = scaled(if other < knot { -1.0 } else { 1.0 }, &sum);
                let short = log(&between);
                let angle = norm(&short);
                let long = scaled(1.0 - std::f64::consts::TAU / angle, &short);
                let off = |turn: &Vec3<f64>| norm(&sub(turn, &sum));
                if long.iter().all(|x| x.is_finite()) && off(&long) < off(&short) {
                    long
                } else {
                    short
                }
            }
        }
    }

    fn course(&self, segment: usize, [start, end]: [&Rates; 2]) -> TcpCourse {
        let is_constant = match self.between[segment] {
            Between::Course(course) => return TcpCourse::clone(course),
            Between::Spl { is_constant } => *is_constant,
        };
        let [from, to] = [&self.knots[segment].pose, &self.knots[segment + 1].pose];
        let length = self.lengths[segment];
        let channel = |rates: &Rates, first: usize| -> [Vec3<f64>; 2] {
            rates.map(|row| [row[first], row[first + 1], row[first + 2]])
        };
        let position = quintics(
            [from.position_m, to.position_m],
            [start, end].map(|rates| by_share(length, channel(rates, 0))),
        );
        let turn = if is_constant {
            Vec::new()
        } else {
            let turning = [start, end].map(|rates| by_share(length, channel(rates, 3)));
            let at_end = end_of_turn(&from.rotation, &to.rotation, &turning[1]);
            quintics([[0.0; 3], at_end[0]], [turning[0], [at_end[1], at_end[2]]])[1..].to_vec()
        };
        TcpCourse::polynomial(from.rotation, position.to_vec(), turn)
    }

    fn e1(&self, segment: usize, [start, end]: [&Rates; 2]) -> [f64; 6] {
        let [from, to] = [self.knots[segment].e1_rad, self.knots[segment + 1].e1_rad];
        if let Between::Course(_) = self.between[segment] {
            return [from, to - from, 0.0, 0.0, 0.0, 0.0];
        }
        let length = self.lengths[segment];
        let rates = [start, end].map(|rates| [length * rates[0][6], length * length * rates[1][6]]);
        quintic([from, to], rates)
    }
}

/// Derivatives by u, as ones by the share of a segment of this length.
fn by_share(length: f64, [one, two]: [Vec3<f64>; 2]) -> [Vec3<f64>; 2] {
    [scaled(length, &one), scaled(length * length, &two)]
}

/// The rotation vector from `from`, and its derivatives, where the TCP is at `to` and turns as `turning` says in the
/// frame of `to`.
fn end_of_turn(from: &Mat3<f64>, to: &Mat3<f64>, turning: &[Vec3<f64>; 2]) -> [Vec3<f64>; 3] {
    let t = Taylor::variable(0.0);
    let [one, two] = turning;
    let vector = std::array::from_fn(|i| t * one[i] + t * t * (0.5 * two[i]));
    let rotation = product(&constant(&product(&transposed(from), to)), &exp(&vector));
    let series = log(&rotation).map(Taylor::derivatives);
    [0, 1, 2].map(|order| [0, 1, 2].map(|i| series[i][order]))
}

/// The polynomial of degree 5 with these values, first and second derivatives at 0 and 1; the lowest power first.
fn quintic([from, to]: [f64; 2], [[v0, a0], [v1, a1]]: [[f64; 2]; 2]) -> [f64; 6] {
    let by = to - from;
    [
        from,
        v0,
        0.5 * a0,
        10.0 * by - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1,
        -15.0 * by + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1,
        6.0 * by - 3.0 * (v0 + v1) + 0.5 * (a1 - a0),
    ]
}

fn quintics(values: [Vec3<f64>; 2], rates: [[Vec3<f64>; 2]; 2]) -> [Vec3<f64>; 6] {
    let each: Vec3<[f64; 6]> = std::array::from_fn(|i| {
        quintic(values.map(|value| value[i]), rates.map(|rates| rates.map(|rate| rate[i])))
    });
    std::array::from_fn(|power| [0, 1, 2].map(|i| each[i][power]))
}
