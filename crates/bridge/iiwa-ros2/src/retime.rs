//! Time parameterisation of joint paths without times, or with times that violate jerk limits.

use std::sync::Arc;

use iiwa_kin::{Joints, Robot, vector};
use iiwa_path::{JoinError, JointPath, Line, Segment, Step};
use iiwa_program::{MotionIndex, MotionLimits};
use iiwa_traj::{Timing, TimingError, Trajectory};

use super::{polyline::Polyline, rounded::Rounded};

/// Default of the maximum deviation from the points of a path, in rad in joint space.
pub const DEFAULT_TOLERANCE_RAD: f64 = 0.01;

/// Minimum tolerance: below it, the robot practically stops at corners.
pub const MIN_TOLERANCE_RAD: f64 = 1e-4;

/// Maximum number of points of a path.
pub const MAX_PATH_POINTS: usize = 20_000;

/// Maximum distance of points from a line that counts as straight, as a share of the tolerance.
const STRAIGHT: f64 = 1e-3;

/// A timed path.
#[derive(Clone, Debug)]
pub struct Retimed {
    /// The motion, from rest to rest.
    pub trajectory: Trajectory,
    /// Maximum distance of a given point from the path, in rad in joint space.
    pub deviation_rad: f64,
    /// Number of points, except the last one, at which the robot stops because the path reverses.
    pub stops: usize,
}

/// Reason why a path cannot be timed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RetimeError {
    /// The path is empty.
    #[error("the path has no points")]
    Empty,
    /// The path has too many points.
    #[error("the path has {found} points, at most {MAX_PATH_POINTS} are allowed")]
    TooLong {
        /// Number of points.
        found: usize,
    },
    /// A value is not finite.
    #[error("point {} of the path contains a value that is not finite", .point + 1)]
    NotFinite {
        /// Index of the point, from 0.
        point: usize,
    },
    /// A point is outside the joint ranges.
    #[error("point {} of the path: {message}", .point + 1)]
    Outside {
        /// Index of the point, from 0.
        point: usize,
        /// The joint, and its excess.
        message: String,
    },
    /// The tolerance is out of range.
    #[error(
        "a tolerance of {found} rad; it has to be from {MIN_TOLERANCE_RAD} to 1 rad, or 0 for \
         {DEFAULT_TOLERANCE_RAD} rad"
    )]
    Tolerance {
        /// The given tolerance.
        found: f64,
    },
    /// The curve is not a continuous path.
    #[error("the path through the points does not join: {0}")]
    Join(#[from] JoinError),
    /// The planner did not find a time parameterisation.
    #[error("time parameterisation of the path failed: {0}")]
    Timing(#[from] TimingError),
}

/// Returns the fastest motion of `robot` through these points within its limits, at rest at the
/// first and the last point.
///
/// Between points the robot moves on a straight line in joint space, and rounds corners within
/// `tolerance_rad`; 0 means [`DEFAULT_TOLERANCE_RAD`]. The robot stops where the path reverses.
///
/// # Errors
///
/// Any [`RetimeError`].
pub fn retime(
    robot: &Robot,
    limits: MotionLimits,
    points: &[Joints],
    tolerance_rad: f64,
) -> Result<Retimed, RetimeError> {
    let tolerance = if tolerance_rad == 0.0 { DEFAULT_TOLERANCE_RAD } else { tolerance_rad };
    if !(MIN_TOLERANCE_RAD..=1.0).contains(&tolerance) {
        return Err(RetimeError::Tolerance { found: tolerance_rad });
    }
    check(robot, points)?;
    let polyline = Polyline::new(points);
    let mut steps = Vec::new();
    let mut deviation_rad = 0.0_f64;
    let mut stops = 0;
    let motion = MotionIndex::default();
    if polyline.points().len() > 1 {
        for part in polyline.parts(0.25 * tolerance) {
            if !steps.is_empty() {
                steps.push(Step::Corner { motion, place: None });
                stops += 1;
            }
            let (segments, off) = segments(&part, tolerance);
            deviation_rad = deviation_rad.max(off);
            steps.extend(segments.into_iter().map(|segment| Step::Move {
                motion,
                segment,
                blend: None,
                limits: None,
            }));
        }
    }
    let start = polyline.points().first().copied().unwrap_or_default();
    let path = JointPath::from_steps(robot, start, steps, vec![limits])?;
    let trajectory = Trajectory::plan(&path, Timing::jerk_limited())?;
    Ok(Retimed { trajectory, deviation_rad, stops })
}

fn check(robot: &Robot, points: &[Joints]) -> Result<(), RetimeError> {
    if points.is_empty() {
        return Err(RetimeError::Empty);
    }
    if points.len() > MAX_PATH_POINTS {
        return Err(RetimeError::TooLong { found: points.len() });
    }
    for (point, q) in points.iter().enumerate() {
        if q.iter().any(|q| !q.is_finite()) {
            return Err(RetimeError::NotFinite { point });
        }
        robot
            .limits()
            .check(q)
            .map_err(|outside| RetimeError::Outside { point, message: outside.to_string() })?;
    }
    Ok(())
}

/// Returns the segments of a part without stops, and their maximum distance from its points.
fn segments(part: &Polyline, tolerance: f64) -> (Vec<Arc<dyn Segment>>, f64) {
    let straight = STRAIGHT * tolerance;
    if let ([from, .., to], true) = (part.points(), part.is_straight(straight)) {
        return (vec![Arc::new(Line::new(*from, *to))], distance_from_line(part, from, to));
    }
    let (curve, off) = Rounded::along(part, tolerance);
    (curve.segments(), off)
}

/// Returns the maximum distance of the points from the line between `from` and `to`.
fn distance_from_line(part: &Polyline, from: &Joints, to: &Joints) -> f64 {
    let direction = vector::unit(&vector::sub(to, from));
    let off = |point: &Joints| {
        let way = vector::sub(point, from);
        vector::norm(&vector::add_scaled(&way, -vector::dot(&way, &direction), &direction))
    };
    part.points().iter().map(off).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn full(points: &[Joints], tolerance: f64) -> Result<Retimed, RetimeError> {
        let robot = Robot::default();
        retime(&robot, MotionLimits::full(&robot), points, tolerance)
    }

    /// Checks the motion from rest to rest within the limits, through all points.
    fn check_motion(points: &[Joints], tolerance: f64) -> Retimed {
        let retimed = full(points, tolerance).unwrap();
        let trajectory = &retimed.trajectory;
        assert!(retimed.deviation_rad <= tolerance, "{}", retimed.deviation_rad);
        let states: Vec<_> = trajectory.samples(2000.0).collect();
        let limits = *Robot::default().limits();
        for state in &states {
            for j in 0..7 {
                assert!(state.dq[j].abs() < 1.01 * limits.velocity_rad_s[j]);
                assert!(state.ddq[j].abs() < 1.01 * limits.acceleration_rad_s2[j]);
                assert!(state.dddq[j].abs() < 1.05 * limits.jerk_rad_s3[j], "{state:?}");
            }
        }
        let (first, last) = (states.first().unwrap(), states.last().unwrap());
        assert!(vector::distance(&first.q, &points[0]) < 1e-9);
        assert!(vector::distance(&last.q, points.last().unwrap()) < 1e-9);
        for point in points {
            let near =
                states.iter().map(|s| vector::distance(&s.q, point)).fold(f64::MAX, f64::min);
            assert!(near < retimed.deviation_rad + 2e-3, "{near}");
        }
        retimed
    }

    #[test]
    fn corners_are_rounded() {
        let points = [
            [0.0; 7],
            [0.5, 0.3, 0.0, -1.0, 0.0, 0.7, 0.0],
            [1.0, 0.3, 0.2, -1.0, 0.0, 0.7, 0.5],
            [1.0, 0.6, 0.2, -1.5, 0.4, 0.2, 0.5],
        ];
        let loose = check_motion(&points, 0.1).trajectory.cycle_time_s();
        let usual = check_motion(&points, 0.01).trajectory.cycle_time_s();
        let tight = check_motion(&points, 0.001).trajectory.cycle_time_s();
        assert!(loose < usual && usual < tight);
    }

    #[test]
    fn a_line_is_as_fast_with_points_on_it() {
        let at = |s: f64| -> Joints { [s, -0.5 * s, 0.0, 0.2 * s, 0.0, 0.0, 0.0] };
        let plain = check_motion(&[at(0.0), at(1.0)], 0.01).trajectory.cycle_time_s();
        let points: Vec<_> = (0..=50).map(|i| at(f64::from(i) / 50.0)).collect();
        let dense = check_motion(&points, 0.01).trajectory.cycle_time_s();
        assert!((plain - dense).abs() < 1e-9);
    }

    #[test]
    fn smooth_ways_of_many_points_stay_smooth() {
        let at = |i: i32, n: i32| -> Joints {
            let s = f64::from(i) / f64::from(n);
            [
                s * 1.2,
                (3.0 * s).sin() * 0.6,
                0.3 * s,
                -1.0 - 0.5 * (2.0 * s).cos(),
                0.0,
                0.5 * s * s,
                0.0,
            ]
        };
        let mut times = Vec::new();
        for n in [20, 100, 500, 3000] {
            let points: Vec<_> = (0..=n).map(|i| at(i, n)).collect();
            times.push(check_motion(&points, 0.01).trajectory.cycle_time_s());
        }
        assert!(times.iter().all(|time| (time / times[3] - 1.0).abs() < 0.1), "{times:?}");
    }

    #[test]
    fn random_ways_get_times() {
        let mut random = fastrand::Rng::with_seed(1);
        let limits = *Robot::default().limits();
        for case in 0..24 {
            let count = random.usize(2..12);
            let corners: Vec<Joints> = (0..count)
                .map(|_| {
                    std::array::from_fn(|j| {
                        limits.lower_rad[j]
                            + random.f64() * (limits.upper_rad[j] - limits.lower_rad[j])
                    })
                })
                .collect();
            // Similar to OMPL paths, with points in between.
            let mut points = vec![corners[0]];
            let between = random.usize(1..30);
            for two in corners.windows(2) {
                for k in 1..=between {
                    let s = k as f64 / between as f64;
                    points.push(std::array::from_fn(|j| two[0][j] + s * (two[1][j] - two[0][j])));
                }
            }
            check_motion(&points, [0.003, 0.01, 0.05][case % 3]);
        }
    }

    #[test]
    fn the_arm_stops_where_it_turns_back() {
        let [a, b] = [[0.0; 7], [0.5, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0]];
        let retimed = check_motion(&[a, b, a], 0.01);
        assert_eq!(retimed.stops, 1);
        assert!(retimed.deviation_rad < 1e-12);
    }

    #[test]
    fn rest_has_no_duration() {
        let retimed = full(&[[0.1; 7]; 3], 0.0).unwrap();
        assert_eq!(retimed.trajectory.cycle_time_s(), 0.0);
        assert_eq!(retimed.trajectory.at(0.0).q, [0.1; 7]);
    }

    #[test]
    fn invalid_paths_are_refused() {
        assert_eq!(full(&[], 0.0).err(), Some(RetimeError::Empty));
        let nan = [[0.0; 7], [f64::NAN; 7]];
        assert_eq!(full(&nan, 0.0).err(), Some(RetimeError::NotFinite { point: 1 }));
        assert!(matches!(
            full(&[[0.0; 7], [4.0; 7]], 0.0),
            Err(RetimeError::Outside { point: 1, .. })
        ));
        assert!(matches!(full(&[[0.0; 7]; 2], 2.0), Err(RetimeError::Tolerance { .. })));
        assert!(matches!(full(&[[0.0; 7]; 2], f64::NAN), Err(RetimeError::Tolerance { .. })));
    }
}
