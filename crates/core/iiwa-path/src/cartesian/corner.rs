//! Blends with a TCP path on at least one side.

use std::sync::Arc;

use iiwa_kin::{
    Joints, Robot, Taylor,
    rotation::{norm, scaled, sub},
    vector,
};

use super::{
    joint_curve::{CurveInterval, JointBlend, JointCurve, TcpBlend},
    leg::Leg,
    tcp_course::Length,
    tcp_path::TcpPath,
};
use crate::{
    crossing::{HALF, tcp_distance_mm},
    joint_spline::{CurveFaultAt, JointSpline, Sigma},
    line::Line,
    options::PathOptions,
    step::ShortenedBlend,
};
use iiwa_program::{Blend, CART_MM_MIN, MotionIndex, MotionLimits, PathBlend, SUNRISE_REL_MIN};

/// A blend between two motions, and the shares of both that it replaces.
#[derive(Debug)]
pub(crate) struct CurvedCorner {
    /// Replaced shares in s: of the first motion (of a spline: its last segment) at its end, and of
    /// the second motion (of a spline: its first segment) at its start.
    pub(crate) shares: [f64; 2],
    /// The blend as a curve in joint space.
    pub(crate) image: JointSpline,
    /// Angle between the directions before and after the blend: of the TCP if the blend joins two
    /// paths of one TCP and the wrist joints are interpolated on neither (0 if the TCP keeps its
    /// position on one side), otherwise in joint space.
    pub(crate) gamma_deg: f64,
    /// Limits of the blend, if the spline segment after the corner has its own; otherwise, the
    /// limits of the second motion apply.
    pub(crate) limits: Option<Arc<MotionLimits>>,
    /// Radius, if it is smaller than the program asks for.
    pub(crate) shortened: Option<ShortenedBlend>,
}

/// Shares that a blend replaces, and its radius, if it is smaller than the program asks for.
struct BlendShares {
    shares: [f64; 2],
    shortened: Option<ShortenedBlend>,
}

impl CurvedCorner {
    /// Returns the blend of `size` between two motions, or `None` if the blend is too small. The
    /// robot has to move in both motions.
    pub(crate) fn new(
        robot: &Robot,
        options: PathOptions,
        tcp_m: &[f64; 3],
        motions: [MotionIndex; 2],
        legs: [&Leg; 2],
        size: &PathBlend,
    ) -> Result<Option<Self>, CurveFaultAt> {
        let Some(BlendShares { shares, shortened }) =
            shares(robot, options, tcp_m, motions, legs, size)
        else {
            return Ok(None);
        };
        let ranges = [[1.0 - shares[0], 1.0], [0.0, shares[1]]];
        let paths = next_to_corner(legs);
        let (gamma_rad, image) = match paths {
            [Some(a), Some(b)] if a.curve.joins_in_space(&b.curve) => {
                let position_by_s = |path: &TcpPath, s: f64| {
                    let pose = path.curve.course.at(Taylor::variable(s));
                    pose.position_m.map(|x| x.derivatives()[1])
                };
                let (into, out) = (
                    scaled(shares[0], &position_by_s(a, 1.0)),
                    scaled(shares[1], &position_by_s(b, 0.0)),
                );
                // If only E1 or the orientation changes in one of the motions, the TCP keeps its
                // position there, and its computed direction consists of rounding errors. With
                // kappa = 0, each position of the blend is on the straight line between the corner
                // and a point on the path of the moving motion: if this path is a line, the blend
                // stays on it.
                let moves = norm(&into).min(norm(&out)) > MIN_WAY_M;
                let (gamma_rad, kappa) = if moves {
                    let (a, b) = (scaled(1.0 / norm(&into), &into), scaled(1.0 / norm(&out), &out));
                    let sum = std::array::from_fn(|i| a[i] + b[i]);
                    // Unlike an arc cosine, precise near 0 and 180 deg.
                    let gamma_rad = 2.0 * norm(&sub(&b, &a)).atan2(norm(&sum));
                    (gamma_rad, options.blend_shape.tcp_kappa(robot, gamma_rad.to_degrees()))
                } else {
                    (0.0, 0.0)
                };
                let part =
                    |path: &TcpPath, range| CurveInterval { range, curve: Arc::clone(&path.curve) };
                let parts = [part(a, ranges[0]), part(b, ranges[1])];
                let derivative_change = sub(&out, &into);
                let blend = Arc::new(TcpBlend { parts, kappa, derivative_change });
                let part =
                    |path: &TcpPath, range| CurveInterval { range, curve: Arc::clone(&path.image) };
                let sides = [part(a, ranges[0]), part(b, ranges[1])];
                (gamma_rad, JointSpline::of_blend(blend, [&sides[0], &sides[1]])?)
            }
            _ => {
                let parts = [0, 1].map(|side| {
                    let curve: Arc<dyn JointCurve> = match paths[side] {
                        Some(path) => Arc::clone(&path.image) as Arc<dyn JointCurve>,
                        None => Arc::new(Line::new(legs[side].ends_rad[0], legs[side].ends_rad[1])),
                    };
                    CurveInterval { range: ranges[side], curve }
                });
                let joints_by_s = |part: &CurveInterval<dyn JointCurve>,
                                   s: f64|
                 -> Result<Joints, CurveFaultAt> {
                    let joints = part.at(Taylor::variable(s));
                    let joints = joints.map_err(|fault| CurveFaultAt { s, fault })?;
                    Ok(joints.map(|joint| joint.derivatives()[1]))
                };
                let (into, out) = (joints_by_s(&parts[0], 1.0)?, joints_by_s(&parts[1], 0.0)?);
                let gamma_rad = vector::angle(&vector::unit(&into), &vector::unit(&out));
                let kappa = options.blend_shape.kappa(robot, gamma_rad.to_degrees());
                // The TCP of the second motion or, if that is not a TCP path, of the first.
                let tool = paths.into_iter().flatten().next_back();
                let tcp_m = tool.map_or([0.0; 3], |path| path.curve.flange.inverse().position_m);
                let blend = JointBlend {
                    robot: Arc::new(robot.clone()),
                    tcp_m,
                    parts,
                    kappa,
                    derivative_change: vector::sub(&out, &into),
                };
                (gamma_rad, JointSpline::of(Arc::new(blend))?)
            }
        };
        // dsigma/ds of each replaced part, with s from 0 to 1 along the part, as in the blend.
        let sigma_rates_rad = [0, 1].map(|side| {
            let [from, to] = &legs[side].ends_rad;
            let whole_rad = paths[side].map(|path| path.rate_rad);
            shares[side] * whole_rad.unwrap_or_else(|| vector::distance(from, to))
        });
        let image = image.with_sigma(Sigma::of_blend(sigma_rates_rad));
        // The limits of the second motion apply in the blend.
        let limits = paths[1].and_then(|path| path.limits.clone());
        Ok(Some(Self { shares, image, gamma_deg: gamma_rad.to_degrees(), limits, shortened }))
    }
}

/// Returns the TCP paths next to the corner, `None` for a motion in joint space. A LIN or CIRC has
/// one TCP path, a spline has one for each segment.
fn next_to_corner(legs: [&Leg; 2]) -> [Option<&TcpPath>; 2] {
    [legs[0].paths.last(), legs[1].paths.first()]
}

/// Returns the shares in s that a blend of `size` replaces, as in [`CurvedCorner::shares`], or
/// `None` if the blend is too small.
fn shares(
    robot: &Robot,
    options: PathOptions,
    tcp_m: &[f64; 3],
    motions: [MotionIndex; 2],
    legs: [&Leg; 2],
    size: &PathBlend,
) -> Option<BlendShares> {
    if size.cart_mm.is_some_and(|radius| radius < CART_MM_MIN)
        || size.sunrise_rel.is_some_and(|share| share < SUNRISE_REL_MIN)
    {
        return None;
    }
    // If the first motion is a TCP path, Sunrise applies `sunrise_rel` (`setBlendingRel`) to E1
    // only. Here, it counts as the smallest `cart_mm`, and has no effect if `cart_mm` is given.
    let paths = next_to_corner(legs);
    let min_mm = (paths[0].is_some() && size.sunrise_rel.is_some()).then_some(CART_MM_MIN);
    let radius_mm = size.cart_mm.or(min_mm);
    let blend = match (radius_mm, size.sunrise_rel, size.fraction) {
        (Some(radius), ..) => Some(Blend::CartMm(radius)),
        (_, Some(share), _) => Some(Blend::SunriseRel(share)),
        (.., Some(share)) => Some(Blend::Fraction(share)),
        _ => None,
    };
    let share = |side: usize| -> Option<f64> {
        let Some(path) = paths[side] else {
            let [from, to] = legs[side].ends_rad;
            let (target, other) = if side == 0 { (to, from) } else { (from, to) };
            return match blend {
                Some(blend) => options.blend_search.share(blend, robot, tcp_m, &target, &other),
                None => Some(HALF),
            };
        };
        let share_of = |length| match (&path.curve.wrist, length) {
            // If the wrist joints determine the orientation, the norm of their displacement counts
            // as the rotation of the whole motion.
            (Some(wrist), Length::Turn(angle)) => angle / norm(&wrist.by_rad),
            _ => path.curve.course.share_of(END_AT_CORNER[side], length),
        };
        let by_way = radius_mm.map(|radius| share_of(Length::Way(1e-3 * radius)));
        let by_turn = size.orientation_rad.map(|angle| share_of(Length::Turn(angle)));
        let by_share = match blend {
            Some(Blend::SunriseRel(share)) => Some(0.5 * share),
            Some(Blend::Fraction(share)) => Some(share),
            _ => None,
        };
        let all = [by_way, by_turn, by_share];
        // The smallest zone counts; at most half, so that two blends of a motion do not overlap.
        Some(all.into_iter().flatten().fold(HALF, f64::min))
    };
    let mut shares = [share(0)?, share(1)?];
    let way_within_mm = |side: usize, share: f64| {
        if let Some(path) = paths[side] {
            return 1e3 * path.curve.course.way_within(END_AT_CORNER[side], share);
        }
        let [from, to] = legs[side].ends_rad;
        let (target, other) = if side == 0 { (to, from) } else { (from, to) };
        let end = vector::add_scaled(&target, share, &vector::sub(&other, &target));
        tcp_distance_mm(robot, tcp_m, [&target, &end])
    };
    // A motion in which the TCP keeps its position does not shorten the radius.
    let shortened = |side: usize| {
        let used_mm = way_within_mm(side, HALF);
        let asked_mm =
            size.cart_mm.filter(|_| shares[side] >= HALF && used_mm > 1e3 * MIN_WAY_M)?;
        ShortenedBlend::new(motions[side], asked_mm, used_mm)
    };
    let sides = [shortened(0), shortened(1)];
    let mut shortened = sides.into_iter().flatten().reduce(ShortenedBlend::smaller);
    if let [Some(a), Some(b)] = paths
        && a.curve.joins_in_space(&b.curve)
    {
        // Both sides get the path length of the shorter one.
        let courses = [&a.curve.course, &b.curve.course];
        let ways_m = [0, 1].map(|side| courses[side].way_within(END_AT_CORNER[side], shares[side]));
        let way_m = ways_m[0].min(ways_m[1]);
        if way_m > MIN_WAY_M {
            shortened = sides[usize::from(ways_m[1] < ways_m[0])];
            shares =
                [0, 1].map(|side| courses[side].share_of(END_AT_CORNER[side], Length::Way(way_m)));
        }
    }
    let is_kept = shares.iter().all(|share| *share > MIN_SHARE);
    is_kept.then_some(BlendShares { shares, shortened })
}

/// Parameter s at which each motion is at the corner: 1, its end, for the first motion, and 0, its
/// start, for the second.
const END_AT_CORNER: [usize; 2] = [1, 0];

/// Path length in m up to which the TCP counts as at rest.
const MIN_WAY_M: f64 = 1e-9;

/// Share of a motion up to which a blend is left out.
const MIN_SHARE: f64 = 1e-9;
