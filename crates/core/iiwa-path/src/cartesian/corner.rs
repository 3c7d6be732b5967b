//! Blends with a TCP path on at least one side.

use std::sync::Arc;

use iiwa_kin::{
    Joints, Pose, Robot, Taylor,
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
    crossing::HALF,
    joint_spline::{CurveFaultAt, JointSpline, Sigma},
    line::Line,
    options::PathOptions,
};
use iiwa_program::{Blend, CART_MM_MIN, MotionLimits, PathBlend, SUNRISE_REL_MIN};

/// A blend between two motions, and the shares of both that it replaces.
#[derive(Debug)]
pub(crate) struct CurvedCorner {
    /// Replaced share of the first motion, at its end, and of the second, at its start.
    pub(crate) shares: [f64; 2],
    /// The blend as a curve in joint space.
    pub(crate) image: JointSpline,
    /// Angle between both directions: of the TCP between two TCP paths, otherwise in joint space.
    pub(crate) gamma_deg: f64,
    /// Limits of the segment after the corner, if it has its own.
    pub(crate) limits: Option<Arc<MotionLimits>>,
}

impl CurvedCorner {
    /// Returns the blend of `size` between two motions, or `None` if it is too small, or if one of
    /// the motions does not move.
    pub(crate) fn new(
        robot: &Robot,
        options: PathOptions,
        tcp_m: &[f64; 3],
        legs: [&Leg; 2],
        size: &PathBlend,
    ) -> Result<Option<Self>, CurveFaultAt> {
        let Some(shares) = shares(robot, options, tcp_m, legs, size) else { return Ok(None) };
        let ranges = [[1.0 - shares[0], 1.0], [0.0, shares[1]]];
        let paths = next_to_corner(legs);
        let (gamma_rad, curve): (f64, Arc<dyn JointCurve>) = match paths {
            [Some(a), Some(b)] if a.curve.joins_in_space(&b.curve) => {
                let rate = |path: &TcpPath, s: f64| {
                    let pose = path.curve.course.at(Taylor::variable(s));
                    pose.position_m.map(|x| x.derivatives()[1])
                };
                let (into, out) =
                    (scaled(shares[0], &rate(a, 1.0)), scaled(shares[1], &rate(b, 0.0)));
                // While only E1 or the orientation changes, the direction of the TCP is rounding.
                // Without kappa, the blend stays on the path of the other motion.
                let goes = norm(&into).min(norm(&out)) > NO_WAY_M;
                let (gamma_rad, kappa) = if goes {
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
                (gamma_rad, Arc::new(TcpBlend { parts, kappa, turn: sub(&out, &into) }))
            }
            _ => {
                let parts = [0, 1].map(|side| {
                    let curve: Arc<dyn JointCurve> = match paths[side] {
                        Some(path) => Arc::clone(&path.curve) as Arc<dyn JointCurve>,
                        None => Arc::new(Line::new(legs[side].ends_rad[0], legs[side].ends_rad[1])),
                    };
                    CurveInterval { range: ranges[side], curve }
                });
                let rate = |part: &CurveInterval<dyn JointCurve>,
                            s: f64|
                 -> Result<Joints, CurveFaultAt> {
                    let joints = part.at(Taylor::variable(s));
                    let joints = joints.map_err(|fault| CurveFaultAt { s, fault })?;
                    Ok(joints.map(|joint| joint.derivatives()[1]))
                };
                let (into, out) = (rate(&parts[0], 1.0)?, rate(&parts[1], 0.0)?);
                let gamma_rad = vector::angle(&vector::unit(&into), &vector::unit(&out));
                let kappa = options.blend_shape.kappa(robot, gamma_rad.to_degrees());
                // The following motion determines TCP and limits, as far as it has a TCP path.
                let tool = paths.into_iter().flatten().next_back();
                let tcp = tool.map_or(Pose::IDENTITY, |path| path.curve.flange.inverse());
                let blend = JointBlend {
                    robot: Arc::new(robot.clone()),
                    tcp,
                    parts,
                    kappa,
                    turn: vector::sub(&out, &into),
                };
                (gamma_rad, Arc::new(blend))
            }
        };
        let rates = [0, 1].map(|side| {
            let [from, to] = &legs[side].ends_rad;
            let rate = paths[side].map(|path| path.rate_rad);
            shares[side] * rate.unwrap_or_else(|| vector::distance(from, to))
        });
        let image = JointSpline::of(curve)?.with_sigma(Sigma::of_blend(rates));
        let limits = paths[1].and_then(|path| path.limits.clone());
        Ok(Some(Self { shares, image, gamma_deg: gamma_rad.to_degrees(), limits }))
    }
}

/// Returns the last TCP path of the first motion, and the first TCP path of the second: segments of
/// a spline, or `None` for a motion in joint space.
fn next_to_corner(legs: [&Leg; 2]) -> [Option<&TcpPath>; 2] {
    [legs[0].paths.last(), legs[1].paths.first()]
}

/// Shares in s of both motions that a blend of `size` replaces, or `None` if the blend is too
/// small.
fn shares(
    robot: &Robot,
    options: PathOptions,
    tcp_m: &[f64; 3],
    legs: [&Leg; 2],
    size: &PathBlend,
) -> Option<[f64; 2]> {
    if size.cart_mm.is_some_and(|radius| radius < CART_MM_MIN)
        || size.sunrise_rel.is_some_and(|share| share < SUNRISE_REL_MIN)
    {
        return None;
    }
    // On a TCP path, `setBlendingRel` applies to the redundancy only, and the blend is the least
    // possible.
    let paths = next_to_corner(legs);
    let min_mm = (paths[0].is_some() && size.sunrise_rel.is_some()).then_some(CART_MM_MIN);
    let radius_mm = size.cart_mm.or(min_mm);
    let in_joints = match (radius_mm, size.sunrise_rel, size.fraction) {
        (Some(radius), ..) => Some(Blend::CartMm(radius)),
        (_, Some(share), _) => Some(Blend::SunriseRel(share)),
        (.., Some(share)) => Some(Blend::Fraction(share)),
        _ => None,
    };
    let share = |side: usize| -> Option<f64> {
        let Some(path) = paths[side] else {
            let [from, to] = legs[side].ends_rad;
            let (target, other) = if side == 0 { (to, from) } else { (from, to) };
            return match in_joints {
                Some(blend) => options.blend_search.share(blend, robot, tcp_m, &target, &other),
                None => Some(HALF),
            };
        };
        let share_of = |length| match (&path.curve.wrist, length) {
            // The joints of the wrist give the angle.
            (Some(wrist), Length::Turn(angle)) => angle / norm(&wrist.by_rad),
            _ => path.curve.course.share_of(1 - side, length),
        };
        let by_way = radius_mm.map(|radius| share_of(Length::Way(1e-3 * radius)));
        let by_turn = size.orientation_rad.map(|angle| share_of(Length::Turn(angle)));
        let by_share = match in_joints {
            Some(Blend::SunriseRel(share)) => Some(0.5 * share),
            Some(Blend::Fraction(share)) => Some(share),
            _ => None,
        };
        let all = [by_way, by_turn, by_share];
        // The smallest zone counts; at most half, so that two blends of a motion do not overlap.
        Some(all.into_iter().flatten().fold(HALF, f64::min))
    };
    let mut shares = [share(0)?, share(1)?];
    if let [Some(a), Some(b)] = paths
        && a.curve.joins_in_space(&b.curve)
    {
        // Both sides get the path length of the shorter one.
        let courses = [&a.curve.course, &b.curve.course];
        let ways = [0, 1].map(|side| courses[side].way_within(1 - side, shares[side]));
        let reach = ways[0].min(ways[1]);
        if reach > NO_WAY_M {
            shares = [0, 1].map(|side| courses[side].share_of(1 - side, Length::Way(reach)));
        }
    }
    shares.iter().all(|share| *share > NO_SHARE).then_some(shares)
}

/// Distance in m below which the TCP is at rest.
const NO_WAY_M: f64 = 1e-9;
/// Share below which there is no blend.
const NO_SHARE: f64 = 1e-9;
