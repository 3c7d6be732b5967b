//! Segments of a spline: position, orientation and E1 between the knots.
//!
//! The position on SPL segments is a quintic in chord length. Orientation and E1 are separate
//! splines, linked to the arc length of the position. The path parameter is the chord length, and
//! the arc length on circles.

use iiwa_kin::{
    MovingPose, Pose, Taylor,
    rotation::{Vec3, constant, exp, log, norm, product, sub, transposed},
};

use iiwa_program::CourseFault;

use super::{
    channel::{MIN_CHORD_RAD, channel},
    knot_rates::{RateSource, Stretch, rate_sources, with_ends},
    quintic::{Linked, Quintic, Rates},
    reversal::{PositionPart, parts, with_reversal},
    tcp_course::{TcpCourse, turn_between},
};

/// Pose and E1 at the end of a segment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Knot {
    pub(crate) pose: Pose,
    pub(crate) e1_rad: f64,
}

/// The kind of a segment between two knots.
#[derive(Clone, Debug)]
pub(crate) enum Between {
    /// A curve defined by the knots and their neighbours; with the orientation of its start, if
    /// `is_constant`.
    Spl { is_constant: bool },
    /// A line or a circle, with E1 linear along it.
    Course(Box<TcpCourse>),
}

/// A part of the spline without a stop inside: a segment, or a part of one.
#[derive(Clone, Debug)]
pub(crate) struct SplinePiece {
    /// Index of the segment.
    pub(crate) segment: usize,
    pub(crate) course: TcpCourse,
    pub(crate) e1_rad: Linked<1>,
    /// Range of the path parameter, in m; zero if only orientation or E1 changes.
    pub(crate) range_m: f64,
    /// True if the TCP stops at the end of the piece.
    pub(crate) stops: bool,
}

/// Largest chord, in m, that counts as zero.
const SAME_M: f64 = 1e-6;

/// Largest difference of orientation or E1, in rad, that counts as zero.
const SAME_RAD: f64 = 1e-6;

/// Largest difference of rates, by arc length, at which the path is smooth.
const SMOOTH: f64 = 1e-6;

/// Returns the pieces of a spline. There is one more knot than segments. Segments without motion
/// have no piece.
///
/// # Errors
///
/// The index of a segment with a rotation by half a turn.
pub(crate) fn pieces(
    knots: &[Knot],
    between: &[Between],
) -> Result<Vec<SplinePiece>, (usize, CourseFault)> {
    let steps = knots.windows(2).zip(between).enumerate().map(|(index, (ends, between))| {
        KnotStep::new(&ends[0], &ends[1], between).map_err(|fault| (index, fault))
    });
    let steps: Vec<KnotStep> = steps.collect::<Result<_, _>>()?;
    let mut pieces: Vec<SplinePiece> = Vec::new();
    let mut start = 0;
    // A repeated point divides the spline, and so does a change of orientation or E1 alone.
    for in_place in (0..steps.len()).filter(|i| steps[*i].length_m <= SAME_M).chain([steps.len()]) {
        let run = SplineRun {
            first: start,
            knots: &knots[start..=in_place],
            between: &between[start..in_place],
            steps: &steps[start..in_place],
        };
        pieces.extend(run.pieces());
        start = in_place + 1;
        let Some(step) = steps.get(in_place) else { break };
        if let Some(before) = pieces.last_mut() {
            before.stops = true;
        }
        if !step.is_nothing() {
            let [from, to] = [&knots[in_place], &knots[in_place + 1]];
            pieces.push(SplinePiece {
                segment: in_place,
                course: TcpCourse::even(&from.pose, &to.pose, step.turn_rad),
                e1_rad: Linked::even([from.e1_rad], [to.e1_rad]),
                range_m: 0.0,
                stops: true,
            });
        }
    }
    // The motion itself ends after the last piece, with a blend or at rest.
    if let Some(last) = pieces.last_mut() {
        last.stops = false;
    }
    Ok(pieces)
}

/// Difference of two knots.
#[derive(Clone, Copy, Debug)]
struct KnotStep {
    by_m: Vec3<f64>,
    /// Rotation vector.
    turn_rad: Vec3<f64>,
    e1_rad: f64,
    /// Chord of an SPL segment, or length of a line or a circle; in m.
    length_m: f64,
}

impl KnotStep {
    fn new(from: &Knot, to: &Knot, between: &Between) -> Result<Self, CourseFault> {
        let by_m = sub(&to.pose.position_m, &from.pose.position_m);
        let length_m = match between {
            Between::Course(course) => course.lengths()[0],
            Between::Spl { .. } => norm(&by_m),
        };
        let turn_rad = turn_between(&from.pose, &to.pose)?;
        Ok(Self { by_m, turn_rad, e1_rad: to.e1_rad - from.e1_rad, length_m })
    }

    /// True if the segment has no motion.
    fn is_nothing(&self) -> bool {
        self.length_m <= SAME_M && norm(&self.turn_rad).max(self.e1_rad.abs()) <= SAME_RAD
    }
}

/// Rates at both ends of a segment that the segment itself determines, by arc length.
#[derive(Clone, Copy, Debug, Default)]
struct GivenRates {
    position: Option<[Rates<3>; 2]>,
    turn: Option<[Rates<3>; 2]>,
    e1: Option<[Rates<1>; 2]>,
}

impl GivenRates {
    /// Returns the rates of lines and circles, and zero rotation rates for a constant orientation.
    fn of(between: &Between, step: &KnotStep) -> Self {
        let course = match between {
            Between::Spl { is_constant } => {
                return Self { turn: is_constant.then_some([Rates::ZERO; 2]), ..Self::default() };
            }
            Between::Course(course) => course,
        };
        let ends = [0.0, 1.0].map(|s| {
            let MovingPose { position_m, rotation } = course.at(Taylor::variable(s));
            let knot = constant(&transposed(&rotation.map(|row| row.map(|x| x.0[0]))));
            let turn = log(&product(&knot, &rotation));
            [position_m, turn].map(|series| by_length(&series, step.length_m))
        });
        Self {
            position: Some(ends.map(|[position, _]| position)),
            turn: Some(ends.map(|[_, turn]| turn)),
            e1: Some([Rates::even(&[step.e1_rad], step.length_m); 2]),
        }
    }

    /// True if both segments at a knot determine rates, and these differ.
    fn contradict(before: &Self, behind: &Self) -> bool {
        fn differ<const N: usize>(
            before: Option<[Rates<N>; 2]>,
            behind: Option<[Rates<N>; 2]>,
        ) -> bool {
            let (Some([_, a]), Some([b, _])) = (before, behind) else { return false };
            let pairs = a.first.iter().zip(&b.first).chain(a.second.iter().zip(&b.second));
            pairs.into_iter().any(|(a, b)| (a - b).abs() > SMOOTH)
        }
        differ(before.position, behind.position)
            || differ(before.turn, behind.turn)
            || differ(before.e1, behind.e1)
    }
}

/// Converts derivatives with respect to the share of a segment of `length` into rates by length.
fn by_length(series: &[Taylor; 3], length: f64) -> Rates<3> {
    let derivatives = series.map(Taylor::derivatives);
    Rates {
        first: derivatives.map(|[_, one, ..]| one / length),
        second: derivatives.map(|[_, _, two, _]| two / (length * length)),
    }
}

/// Consecutive segments of a spline in which the TCP moves.
struct SplineRun<'a> {
    /// Index of the first segment in the spline.
    first: usize,
    knots: &'a [Knot],
    between: &'a [Between],
    steps: &'a [KnotStep],
}

impl SplineRun<'_> {
    fn pieces(&self) -> Vec<SplinePiece> {
        // A single SPL segment is a straight line.
        if let ([Between::Spl { .. }], [from, to]) = (self.between, self.knots) {
            let KnotStep { turn_rad, length_m, .. } = self.steps[0];
            return vec![SplinePiece {
                segment: self.first,
                course: TcpCourse::even(&from.pose, &to.pose, turn_rad),
                e1_rad: Linked::even([from.e1_rad], [to.e1_rad]),
                range_m: length_m,
                stops: false,
            }];
        }
        let count = self.between.len();
        let prescribed: Vec<GivenRates> =
            self.between.iter().zip(self.steps).map(|(b, step)| GivenRates::of(b, step)).collect();
        let positions = self.positions(&prescribed);
        let arcs_m: Vec<f64> = positions
            .iter()
            .zip(self.steps)
            .map(|(parts, step)| match parts.as_slice() {
                [] => step.length_m,
                parts => parts.iter().map(|part| part.curve.length_m()).sum(),
            })
            .collect();
        let mut pieces = Vec::with_capacity(count);
        let channels = self.channels(&prescribed, &arcs_m);
        for (i, (parts, (turn, e1))) in positions.into_iter().zip(channels).enumerate() {
            let segment = self.first + i;
            let stops = i + 1 < count
                && (self.is_restart(i + 1)
                    || parts.last().is_some_and(|part| part.stops)
                    || GivenRates::contradict(&prescribed[i], &prescribed[i + 1]));
            let Knot { pose, e1_rad } = &self.knots[i];
            let even_e1 = || Linked::even([0.0], [self.steps[i].e1_rad]);
            let e1 = e1.unwrap_or_else(even_e1).plus(&[*e1_rad]);
            if let Between::Course(course) = &self.between[i] {
                let (course, range_m) = (TcpCourse::clone(course), arcs_m[i]);
                pieces.push(SplinePiece { segment, course, e1_rad: e1, range_m, stops });
                continue;
            }
            let turn = turn.unwrap_or_else(|| Linked::even([0.0; 3], [0.0; 3]));
            let last = parts.len() - 1;
            let mut start_m = 0.0;
            for (k, part) in parts.into_iter().enumerate() {
                let length_m = part.curve.length_m();
                let range = [start_m, start_m + length_m].map(|length| length / arcs_m[i]);
                start_m += length_m;
                let (turn, e1_rad) = if last == 0 {
                    (turn.clone(), e1.clone())
                } else {
                    (turn.part(range), e1.part(range))
                };
                let course = TcpCourse::spline(part.curve, pose.rotation, turn);
                let stops = if k == last { stops } else { part.stops };
                pieces.push(SplinePiece { segment, course, e1_rad, range_m: part.range_m, stops });
            }
        }
        pieces
    }

    /// Returns orientation and E1 on the segments, as differences from the start of each; `None`
    /// where the segment itself determines them.
    fn channels(
        &self,
        prescribed: &[GivenRates],
        arcs_m: &[f64],
    ) -> Vec<(Option<Linked<3>>, Option<Linked<1>>)> {
        let count = self.steps.len();
        let mut channels = Vec::with_capacity(count);
        let mut start = 0;
        for end in (1..=count).filter(|knot| *knot == count || self.is_restart(*knot)) {
            let range = start..end;
            let stretches = range.clone().map(|i| {
                let KnotStep { turn_rad, e1_rad, .. } = &self.steps[i];
                (stretch(turn_rad, prescribed[i].turn), stretch(&[*e1_rad], prescribed[i].e1))
            });
            let (turn, e1): (Vec<_>, Vec<_>) = stretches.unzip();
            let turns = channel(&turn, &arcs_m[range.clone()], turned);
            channels.extend(turns.into_iter().zip(channel(&e1, &arcs_m[range], |_, e1| *e1)));
            start = end;
        }
        channels
    }

    /// Returns the position on the SPL segments, and no parts for the others.
    fn positions(&self, prescribed: &[GivenRates]) -> Vec<Vec<PositionPart>> {
        let stretches: Vec<Stretch<3>> = self
            .steps
            .iter()
            .zip(prescribed)
            .map(|(step, prescribed)| match prescribed.position {
                Some(rates) => Stretch::Given(rates),
                None => Stretch::Free { chord: step.length_m, step: step.by_m },
            })
            .collect();
        let position = |i: usize| {
            let KnotStep { by_m, length_m, .. } = &self.steps[i];
            let Stretch::Free { .. } = stretches[i] else { return Vec::new() };
            let sources = rate_sources(&stretches, i).map(|source| match source {
                RateSource::Parabola(rates) => Some(with_reversal(rates)),
                RateSource::Neighbour(rates) => Some(rates),
                RateSource::End => None,
            });
            let [start, end] = with_ends(sources, *length_m, by_m, |_, rates| *rates);
            let [from, to] = [&self.knots[i], &self.knots[i + 1]].map(|knot| &knot.pose.position_m);
            let curve = Quintic::hermite([from, to], [&start, &end], *length_m);
            let cusps = [&start, &end].map(|rates| rates.first == [0.0; 3]);
            parts(&curve, *length_m, cusps)
        };
        (0..self.steps.len()).map(position).collect()
    }

    /// True if orientation and E1 restart at a knot: at the first X of SPL segments to X, Y and X.
    fn is_restart(&self, knot: usize) -> bool {
        let is_spl = |i: usize| matches!(self.between.get(i), Some(Between::Spl { .. }));
        let (Some(a), Some(b)) = (self.knots.get(knot), self.knots.get(knot + 2)) else {
            return false;
        };
        // The step from the first X to the second, as one segment.
        let step = KnotStep::new(a, b, &Between::Spl { is_constant: false });
        knot > 0
            && [knot - 1, knot, knot + 1].into_iter().all(is_spl)
            && step.is_ok_and(|step| step.is_nothing())
    }
}

/// Returns orientation or E1 of a segment as a stretch.
fn stretch<const N: usize>(step: &[f64; N], prescribed: Option<[Rates<N>; 2]>) -> Stretch<N> {
    prescribed.map_or_else(
        || {
            let length = step.iter().map(|x| x * x).sum::<f64>().sqrt();
            Stretch::Free { chord: length.max(MIN_CHORD_RAD), step: *step }
        },
        Stretch::Given,
    )
}

/// Converts rates of the rotation vector at a knot into rates relative to another knot, from which
/// the rotation vector is `step`.
fn turned(step: &Vec3<f64>, rates: &Rates<3>) -> Rates<3> {
    let t = Taylor::variable(0.0);
    let Rates { first, second } = rates;
    let vector = std::array::from_fn(|i| t * first[i] + t * t * (0.5 * second[i]));
    let series = log(&product(&constant(&exp(step)), &exp(&vector)));
    by_length(&series, 1.0)
}
