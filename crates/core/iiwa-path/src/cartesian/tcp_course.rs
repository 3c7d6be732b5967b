//! Course of the TCP from one frame to another: position and orientation as functions of s.

use iiwa_kin::{
    MovingPose, Number, Pose, Taylor, ToolRates,
    rotation::{
        Mat3, Vec3, constant, cross, dot, exp, log_or_half_turn, norm, product, scaled, sub,
        transposed,
    },
};

use iiwa_program::CourseFault;

use super::{chord_curve::ChordCurve, quintic::Linked};
use crate::segment::ToolWay;

/// Course of the TCP in the robot base, for s from 0 to 1.
#[derive(Clone, Debug)]
pub(crate) struct TcpCourse {
    position: TcpPosition,
    orientation: Orientation,
}

/// Position of the TCP.
#[derive(Clone, Debug)]
enum TcpPosition {
    /// A straight line, linear in s: `from + s by`.
    Line { from: Vec3<f64>, by: Vec3<f64> },
    /// A part of a spline.
    Spline(Box<ChordCurve>),
    /// A circular arc, linear in s: `centre + cos(s angle) u + sin(s angle) v`.
    Arc { centre: Vec3<f64>, u: Vec3<f64>, v: Vec3<f64>, angle: f64 },
}

/// Orientation of the TCP.
#[derive(Clone, Debug)]
struct Orientation {
    /// Reference frame of `turn`: the orientation at the start of the motion or the segment.
    from: Mat3<f64>,
    /// Rotation vector relative to `from`, by the share of the arc length.
    turn: Linked<3>,
    /// Additional rotation about a fixed axis, linear in s: its rotation vector in the robot base.
    carried: Option<Vec3<f64>>,
}

/// Orientation law along a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ArcTurn {
    /// `true` if the orientation follows the direction of the path.
    pub(crate) with_path: bool,
    /// Intermediate orientation, and the place where it is reached; `None` if the orientation of
    /// the auxiliary frame is ignored.
    pub(crate) by_way_of: Option<(Mat3<f64>, ByWayOf)>,
    /// `true` if the orientation of the end is reached at the end frame, and extrapolated beyond
    /// it.
    pub(crate) extrapolates: bool,
    /// Total angle of the arc, in rad; to the end frame if absent.
    pub(crate) angle_rad: Option<f64>,
}

/// Least share of the path between either end and a freely placed orientation of the auxiliary
/// frame.
const ASIDE: f64 = 0.1;

/// Place at which the orientation of the auxiliary frame is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ByWayOf {
    /// At a share of the path equal to its share of the total rotation.
    Somewhere,
    /// At the auxiliary frame.
    AtAux,
}

impl TcpCourse {
    /// Builds a straight line, with a rotation about a fixed axis linear in s, or without rotation
    /// if `is_constant`.
    pub(crate) fn line(from: &Pose, to: &Pose, is_constant: bool) -> Result<Self, CourseFault> {
        let turn = if is_constant { [0.0; 3] } else { turn_between(from, to)? };
        Ok(Self::even(from, to, turn))
    }

    /// Builds a straight line with a rotation by the vector `turn` linear in s.
    pub(crate) fn even(from: &Pose, to: &Pose, turn: Vec3<f64>) -> Self {
        let by = sub(&to.position_m, &from.position_m);
        let turn = Linked::even([0.0; 3], turn);
        let orientation = Orientation { from: from.rotation, turn, carried: None };
        Self { position: TcpPosition::Line { from: from.position_m, by }, orientation }
    }

    /// Builds a part of a spline, with the rotation vector `turn` from the orientation `from`.
    pub(crate) fn spline(position: ChordCurve, from: Mat3<f64>, turn: Linked<3>) -> Self {
        let orientation = Orientation { from, turn, carried: None };
        Self { position: TcpPosition::Spline(Box::new(position)), orientation }
    }

    /// Builds a circle from `from` through the point `aux` to `to`.
    pub(crate) fn arc(
        from: &Pose,
        aux: &Vec3<f64>,
        to: &Pose,
        is_constant: bool,
        turn: &ArcTurn,
    ) -> Result<Self, CourseFault> {
        /// Height of the triangle over its longest side below which its corners are collinear.
        const FLAT: f64 = 1e-6;
        let (a, b) = (sub(aux, &from.position_m), sub(&to.position_m, &from.position_m));
        let normal = cross(&a, &b);
        let longest = norm(&a).max(norm(&b)).max(norm(&sub(&a, &b)));
        let area = norm(&normal);
        let far_apart = [&a, &b, &sub(&a, &b)].iter().all(|side| norm(side) > FLAT * longest);
        if !(far_apart && area > FLAT * longest * longest) {
            return Err(CourseFault::NoCircle);
        }
        let axis = scaled(1.0 / area, &normal);
        // Vector from the start to the centre of the circle through three points.
        let to_centre = {
            let (aa, bb) = (dot(&a, &a), dot(&b, &b));
            let toward: Vec3<f64> = std::array::from_fn(|i| aa * b[i] - bb * a[i]);
            scaled(0.5 / (area * area), &cross(&toward, &normal))
        };
        let centre = std::array::from_fn(|i| from.position_m[i] + to_centre[i]);
        let u = scaled(-1.0, &to_centre);
        let v = cross(&axis, &u);
        // About `axis` = a x b, the auxiliary point precedes the end: angles are positive.
        let angle_of = |point: &Vec3<f64>| {
            let d = sub(point, &centre);
            dot(&d, &v).atan2(dot(&d, &u)).rem_euclid(std::f64::consts::TAU)
        };
        let (at_aux, programmed) = (angle_of(aux), angle_of(&to.position_m));
        let angle = turn.angle_rad.unwrap_or(programmed);
        let position = TcpPosition::Arc { centre, u, v, angle };

        // The orientation law up to the place where the orientation of the end is reached.
        let whole = if turn.extrapolates { programmed } else { angle };
        let carried = turn.with_path.then(|| scaled(whole, &axis));
        let relative = |rotation: &Mat3<f64>, share: f64| {
            let carried = carried.map_or([0.0; 3], |r| scaled(-share, &r));
            let relative = product(&exp(&carried), rotation);
            log_or_half_turn(&product(&transposed(&from.rotation), &relative))
                .ok_or(CourseFault::HalfTurn)
        };
        let (mut linear, mut square) = ([0.0; 3], [0.0; 3]);
        if !is_constant {
            linear = relative(&to.rotation, 1.0)?;
            if let Some((rotation, place)) = &turn.by_way_of {
                let on_way = at_aux / whole;
                let by_way = relative(rotation, on_way)?;
                let share = match place {
                    ByWayOf::AtAux => on_way,
                    ByWayOf::Somewhere => {
                        let before = norm(&by_way);
                        let after = norm(&sub(&linear, &by_way));
                        let share =
                            if before + after > 0.0 { before / (before + after) } else { 0.5 };
                        // Near an end, a small part of the rotation would determine the direction
                        // of all of it.
                        share.clamp(ASIDE, 1.0 - ASIDE)
                    }
                };
                // Quadratic law: 0 at 0, `by_way` at `share` and `linear` at 1.
                if share > 0.0 && share < 1.0 {
                    for i in 0..3 {
                        square[i] = (linear[i] - by_way[i] / share) / (1.0 - share);
                        linear[i] -= square[i];
                    }
                }
            }
        }
        let stretch = angle / whole;
        let turn = vec![[0.0; 3], scaled(stretch, &linear), scaled(stretch * stretch, &square)];
        let carried = carried.filter(|_| !is_constant).map(|r| scaled(stretch, &r));
        let turn = Linked::new(None, turn);
        let orientation = Orientation { from: from.rotation, turn, carried };
        Ok(Self { position, orientation })
    }

    /// Pose of the TCP at `s`.
    pub(crate) fn at(&self, s: Taylor) -> MovingPose {
        let position_m = match &self.position {
            TcpPosition::Line { from, by } => {
                std::array::from_fn(|i| s * by[i] + Taylor::constant(from[i]))
            }
            TcpPosition::Spline(curve) => curve.at(s),
            TcpPosition::Arc { centre, u, v, angle } => {
                let (sin, cos) = (s * *angle).sin_cos();
                std::array::from_fn(|i| Taylor::constant(centre[i]) + cos * u[i] + sin * v[i])
            }
        };
        let Orientation { from, turn, carried } = &self.orientation;
        let mut rotation = constant(from);
        if !turn.is_zero() {
            rotation = product(&rotation, &exp(&turn.at(self.arc_share(s))));
        }
        if let Some(vector) = carried {
            rotation = product(&exp(&vector.map(|v| s * v)), &rotation);
        }
        MovingPose { position_m, rotation }
    }

    /// Share of the arc length up to `s`.
    pub(crate) fn arc_share(&self, s: Taylor) -> Taylor {
        match &self.position {
            TcpPosition::Line { .. } | TcpPosition::Arc { .. } => s,
            TcpPosition::Spline(curve) => curve.arc_share(s),
        }
    }

    /// Pose of the TCP at the end.
    pub(crate) fn end(&self) -> Pose {
        let MovingPose { position_m, rotation } = self.at(Taylor::constant(1.0));
        Pose {
            position_m: position_m.map(Number::value),
            rotation: rotation.map(|row| row.map(Number::value)),
        }
    }

    /// Rates by s of the path length in m and of the angle in rad, if both are constant.
    pub(crate) fn even_rates(&self) -> Option<[f64; 2]> {
        let Orientation { turn, carried, .. } = &self.orientation;
        let [_, by] = turn.linear()?;
        let turn = match carried {
            None => norm(&by),
            Some(carried) if turn.is_zero() => norm(carried),
            Some(_) => return None,
        };
        let way = match &self.position {
            TcpPosition::Line { by, .. } => norm(by),
            TcpPosition::Arc { u, angle, .. } => norm(u) * angle.abs(),
            TcpPosition::Spline(_) => return None,
        };
        Some([way, turn])
    }

    /// Path length of the TCP in m, and angle of its rotation in rad.
    pub(crate) fn lengths(&self) -> [f64; 2] {
        self.even_rates().unwrap_or_else(|| self.rising_lengths()[INTERVALS].1)
    }

    /// Path length of the TCP over a share of s next to an end, 0 or 1, in m.
    pub(crate) fn way_within(&self, end: usize, share: f64) -> f64 {
        if let Some([way, _]) = self.even_rates() {
            return way * share;
        }
        let nodes = self.rising_lengths();
        let at = |s: f64| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "it is from 0 to the number of intervals"
            )]
            let index = ((s * INTERVALS as f64) as usize).min(INTERVALS - 1);
            rising(&nodes[index..], 0, s * INTERVALS as f64 - index as f64)
        };
        if end == 0 { at(share) } else { nodes[INTERVALS].1[0] - at(1.0 - share) }
    }

    /// Rates and accumulated lengths of path and angle, at evenly spaced s, by Simpson's rule.
    fn rising_lengths(&self) -> Vec<([f64; 2], [f64; 2])> {
        let step = 1.0 / INTERVALS as f64;
        let rates = |s: f64| {
            let ToolWay { way_m, turn_rad } = tool_way(&self.at(Taylor::variable(s)));
            [way_m[0], turn_rad[0]]
        };
        let mut nodes = Vec::with_capacity(INTERVALS + 1);
        let (mut from, mut length) = (rates(0.0), [0.0; 2]);
        nodes.push((from, length));
        for i in 0..INTERVALS {
            let s = i as f64 * step;
            let [middle, to] = [rates(s + 0.5 * step), rates(s + step)];
            for k in 0..2 {
                length[k] += step / 6.0 * (from[k] + 4.0 * middle[k] + to[k]);
            }
            nodes.push((to, length));
            from = to;
        }
        nodes
    }

    /// Share of s next to an end, 0 or 1, over which the TCP moves by `length` in m, or rotates by
    /// `length` in rad.
    pub(crate) fn share_of(&self, end: usize, length: Length) -> f64 {
        /// Number of halvings within an interval, for a precision of 1e-12 of it.
        const HALVINGS: u32 = 40;
        let (which, length) = match length {
            Length::Way(way_m) => (0, way_m),
            Length::Turn(turn_rad) => (1, turn_rad),
        };
        if let Some(rates) = self.even_rates() {
            // Never reached without motion: another zone counts, or half of the motion.
            return if rates[which] > NOTHING { length / rates[which] } else { f64::INFINITY };
        }
        let nodes = self.rising_lengths();
        let whole = nodes[INTERVALS].1[which];
        if whole <= NOTHING {
            return f64::INFINITY;
        }
        // Above 1: callers limit the share to half of the motion.
        if length >= whole {
            return length / whole;
        }
        let target = if end == 0 { length } else { whole - length };
        let index = nodes.partition_point(|node| node.1[which] <= target).clamp(1, INTERVALS) - 1;
        let [mut lower, mut upper] = [0.0, 1.0];
        for _ in 0..HALVINGS {
            let share = f64::midpoint(lower, upper);
            if rising(&nodes[index..], which, share) < target {
                lower = share;
            } else {
                upper = share;
            }
        }
        let s = (index as f64 + f64::midpoint(lower, upper)) / INTERVALS as f64;
        if end == 0 { s } else { 1.0 - s }
    }
}

/// Length below which motion is rounding, in m or rad.
const NOTHING: f64 = 1e-12;

/// Number of intervals for lengths: along a spline segment, the rates change little.
const INTERVALS: usize = 64;

/// Returns the length at a share of the interval between the first two nodes: by the cubic with the
/// given lengths and rates.
fn rising(nodes: &[([f64; 2], [f64; 2])], which: usize, share: f64) -> f64 {
    let [(rate, from), (next_rate, to)] = [&nodes[0], &nodes[1]]
        .map(|(rates, lengths)| (rates[which] / INTERVALS as f64, lengths[which]));
    let by = to - from;
    let rest = rate + next_rate - 2.0 * by;
    from + share * (rate + share * (by - rate - rest + share * rest))
}

/// A path length of the TCP, in m, or an angle of its rotation, in rad.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Length {
    Way(f64),
    Turn(f64),
}

/// Returns the rotation vector from one pose to another, in the frame of the first.
pub(crate) fn turn_between(from: &Pose, to: &Pose) -> Result<Vec3<f64>, CourseFault> {
    let between = product(&transposed(&from.rotation), &to.rotation);
    log_or_half_turn(&between).ok_or(CourseFault::HalfTurn)
}

/// Evaluates a polynomial in s, lowest power first, by Horner's scheme.
pub(crate) fn polynomial(
    coefficients: impl IntoIterator<Item = f64, IntoIter: DoubleEndedIterator>,
    s: Taylor,
) -> Taylor {
    let mut descending = coefficients.into_iter().rev();
    let highest = Taylor::constant(descending.next().unwrap_or(0.0));
    descending.fold(highest, |sum, c| sum * s + Taylor::constant(c))
}

/// Path length and angle of a frame, from its motion by s.
pub(crate) fn tool_way(pose: &MovingPose) -> ToolWay {
    let rate = pose.position_m.map(derivative);
    // R' R^T = [omega]; as R is a rotation, three entries of the product determine omega.
    let turning =
        product(&pose.rotation.map(|row| row.map(derivative)), &transposed(&pose.rotation));
    let omega = [turning[2][1], turning[0][2], turning[1][0]];
    ToolWay { way_m: length(&rate), turn_rad: length(&omega) }
}

/// Path length and angle of a tool, from its rates by s.
pub(crate) fn tool_way_of(rates: &ToolRates) -> ToolWay {
    ToolWay { way_m: lengths(&rates.linear), turn_rad: lengths(&rates.angular) }
}

/// Length of a vector that is given with its first two derivatives, and the derivatives of the
/// length; zeros for a vector of zero length.
fn lengths([v, dv, ddv]: &[Vec3<f64>; 3]) -> [f64; 3] {
    let square = dot(v, v);
    if square <= NOTHING * NOTHING {
        return [0.0; 3];
    }
    let length = square.sqrt();
    let first = dot(v, dv) / length;
    [length, first, (dot(dv, dv) + dot(v, ddv) - first * first) / length]
}

/// Derivative of a power series, whose last coefficient is lost.
fn derivative(Taylor([_, one, two, three]): Taylor) -> Taylor {
    Taylor([one, 2.0 * two, 3.0 * three, 0.0])
}

/// Length of a vector and its first two derivatives; zeros for a vector of zero length.
fn length(v: &Vec3<Taylor>) -> [f64; 3] {
    let square = dot(v, v);
    if square.value() <= NOTHING * NOTHING {
        return [0.0; 3];
    }
    let [zero, one, two, _] = square.sqrt().derivatives();
    [zero, one, two]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pose at an angle of the circle, in rad, with an orientation.
    fn on_circle(angle: f64, abc_rad: [f64; 3]) -> Pose {
        let (sin, cos) = angle.sin_cos();
        Pose::from_xyz_abc([0.5 + 0.2 * cos, 0.1 + 0.2 * sin, 0.4], abc_rad)
    }

    fn off(a: &Mat3<f64>, b: &Mat3<f64>) -> f64 {
        let all = a.as_flattened().iter().zip(b.as_flattened());
        all.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    fn circle(turn: &ArcTurn) -> TcpCourse {
        let [from, aux, to] = poses();
        TcpCourse::arc(&from, &aux.position_m, &to, false, turn).unwrap()
    }

    /// Start, auxiliary frame and end, at 0 rad, 1 rad and 2.5 rad.
    fn poses() -> [Pose; 3] {
        let [aux, end] = [[0.5, 0.4, -0.3], [0.6, -0.2, 0.3]];
        [on_circle(0.0, [0.1, 0.0, 0.0]), on_circle(1.0, aux), on_circle(2.5, end)]
    }

    fn at(course: &TcpCourse, s: f64) -> (Vec3<f64>, Mat3<f64>) {
        let MovingPose { position_m, rotation } = course.at(Taylor::constant(s));
        (position_m.map(Number::value), rotation.map(|row| row.map(Number::value)))
    }

    #[test]
    fn circles_reach_the_auxiliary_orientation_at_the_auxiliary_frame() {
        let [_, aux, to] = poses();
        // The angle, the extrapolation, and the share at which the orientation of the end is
        // reached.
        let cases = [
            (None, false, 1.0),
            (Some(3.0), false, 1.0),
            (Some(3.0), true, 2.5 / 3.0),
            (Some(2.0), false, 1.0),
        ];
        for (angle_rad, extrapolates, end_at) in cases {
            for with_path in [false, true] {
                let by_way_of = Some((aux.rotation, ByWayOf::AtAux));
                let course = circle(&ArcTurn { with_path, by_way_of, extrapolates, angle_rad });
                let case = format!("{angle_rad:?} {extrapolates} {with_path}");
                let (position, rotation) = at(&course, 1.0 / angle_rad.unwrap_or(2.5));
                assert!(norm(&sub(&position, &aux.position_m)) < 1e-12, "{case}: {position:?}");
                assert!(off(&rotation, &aux.rotation) < 1e-12, "{case}: {rotation:?}");
                let (_, rotation) = at(&course, end_at);
                assert!(off(&rotation, &to.rotation) < 1e-12, "{case}: {rotation:?}");
            }
        }
    }

    #[test]
    fn circles_reach_the_auxiliary_orientation_somewhere() {
        let [_, aux, _] = poses();
        let nearest = |by_way_of| {
            let turn =
                ArcTurn { with_path: false, by_way_of, extrapolates: false, angle_rad: None };
            let course = circle(&turn);
            let places = (0..=1000).map(|i| at(&course, f64::from(i) / 1000.0).1);
            places.map(|rotation| off(&rotation, &aux.rotation)).fold(f64::INFINITY, f64::min)
        };
        let actual = nearest(Some((aux.rotation, ByWayOf::Somewhere)));
        assert!(actual < 2e-3, "{actual}");
        let without = nearest(None);
        assert!(without > 0.1, "{without}");
    }
}
