//! Deviation of the robot from the planned path, regardless of time.

use iiwa_kin::{
    Joints, Robot,
    vector::{distance, sub},
};
use iiwa_log::JointLog;
use iiwa_program::MotionIndex;

use super::motion_deviation::{MotionDeviation, MotionDeviations};
use super::plan::PlannedTrajectory;

/// Deviation of the recorded path from the planned one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Mean along the planned path: in rad in joint space, or in m for the flange.
    pub mean: f64,
    /// Largest deviation.
    pub max: f64,
    /// Location of the largest deviation.
    pub at: Location,
}

/// Location on both paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Location {
    /// Motion of the program.
    pub motion: MotionIndex,
    /// Planned time, in s from the program's start.
    pub plan_s: f64,
    /// Recorded time, in s, on the recording's clock.
    pub recording_s: f64,
    /// Planned joints, in rad.
    pub planned_rad: Joints,
    /// Measured joints, in rad.
    pub measured_rad: Joints,
    /// Planned position of the flange, in m.
    pub planned_flange_m: [f64; 3],
    /// Measured position of the flange, in m.
    pub measured_flange_m: [f64; 3],
}

/// Sample for plots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracePoint {
    /// Planned time, in s from the program's start.
    pub plan_s: f64,
    /// Recorded time, in s from the start of the motion.
    pub measured_s: f64,
    /// Measured position of the flange, in m.
    pub flange_m: [f64; 3],
    /// Distance to the planned path in joint space, in rad.
    pub joints_rad: f64,
    /// Distance to the planned path of the flange, in m.
    pub flange_deviation_m: f64,
}

/// Maximum number of points of a trace.
const TRACE: usize = 10_000;

/// Deviations over a range of samples.
pub(super) struct Deviations {
    pub(super) joints_rad: Deviation,
    pub(super) flange_m: Deviation,
    /// Largest deviations of each motion.
    pub(super) motions: Vec<MotionDeviation>,
    /// Subset of the samples.
    pub(super) trace: Vec<TracePoint>,
}

/// Computes the deviations in joint space and of the flange over a range of samples.
pub(super) fn deviations(
    plan: &PlannedTrajectory,
    log: &JointLog,
    samples: std::ops::Range<usize>,
    place_s: &[f64],
    start_s: f64,
) -> Option<Deviations> {
    let curve = &plan.curve;
    let thinned = samples.len().div_ceil(TRACE).max(1);
    let mut trace = Vec::with_capacity(samples.len() / thinned + 2);
    let (mut joints, mut flange) = (Sum::default(), Sum::default());
    let mut motions = MotionDeviations::default();
    let mut farthest = f64::NEG_INFINITY;
    let last = samples.len().checked_sub(1)?;
    for (k, (i, &plan_s)) in samples.zip(place_s).enumerate() {
        let q = &log.q_rad[i];
        let interval = curve.interval_at(plan_s);
        let (planned, rate) = curve.in_interval(interval, plan_s);
        let arc = curve.arc(interval) + distance(&planned, &curve.knots()[interval].q);
        // Rests, and backward steps within the noise, do not count as way.
        let way = if farthest.is_finite() { (arc - farthest).max(0.0) } else { 0.0 };
        farthest = farthest.max(arc);
        let off_rad = distance(q, &planned);
        let flange_m = plan.robot().flange_position(q);
        let off_m = flange_distance(plan, plan_s, (&planned, &rate), flange_m);
        motions.add(plan.motion_at(plan_s), &sub(q, &planned), off_m);
        joints.add(off_rad, way, i, plan_s);
        flange.add(off_m, way, i, plan_s);
        if k % thinned == 0 || k == last {
            trace.push(TracePoint {
                plan_s,
                measured_s: log.t_s[i] - start_s,
                flange_m,
                joints_rad: off_rad,
                flange_deviation_m: off_m,
            });
        }
    }
    Some(Deviations {
        joints_rad: joints.deviation(plan, log),
        flange_m: flange.deviation(plan, log),
        motions: motions.all(),
        trace,
    })
}

/// Returns the distance of a point from the planned path of the flange near the matched planned
/// time: the nearest point of that path is not exactly that of the nearest joint positions.
fn flange_distance(
    plan: &PlannedTrajectory,
    plan_s: f64,
    (planned, rate): (&Joints, &Joints),
    flange_m: [f64; 3],
) -> f64 {
    let (robot, curve): (&Robot, _) = (plan.robot(), &plan.curve);
    let (mut at_s, mut q, mut dq) = (plan_s, *planned, *rate);
    let mut nearest = f64::MAX;
    for _ in 0..4 {
        let (p, v) = robot.flange_motion(&q, &dq);
        let to: [f64; 3] = std::array::from_fn(|k| flange_m[k] - p[k]);
        let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let off = dot(&to, &to).sqrt();
        if off >= nearest {
            break;
        }
        nearest = off;
        let (along, speed) = (dot(&to, &v), dot(&v, &v));
        // No gain if the flange hardly moves, or if the point is already perpendicular to the path.
        if speed <= 1e-12 || along.abs() <= 1e-3 * off * speed.sqrt() {
            break;
        }
        at_s += (along / speed).clamp(-0.05, 0.05);
        (q, dq) = curve.at(at_s);
    }
    nearest
}

#[derive(Default)]
struct Sum {
    /// Integral over the way.
    integral: f64,
    way: f64,
    before: f64,
    max: f64,
    /// Sample with the largest deviation, and its planned time.
    at: Option<(usize, f64)>,
}

impl Sum {
    fn add(&mut self, off: f64, way: f64, sample: usize, plan_s: f64) {
        self.integral += 0.5 * (off + self.before) * way;
        self.way += way;
        self.before = off;
        if off > self.max || self.at.is_none() {
            (self.max, self.at) = (off, Some((sample, plan_s)));
        }
    }

    fn deviation(&self, plan: &PlannedTrajectory, log: &JointLog) -> Deviation {
        let (i, plan_s) = self.at.unwrap_or_default();
        let (planned_rad, measured_rad) = (plan.at(plan_s), log.q_rad[i]);
        Deviation {
            mean: if self.way > 0.0 { self.integral / self.way } else { self.max },
            max: self.max,
            at: Location {
                motion: plan.motion_at(plan_s),
                plan_s,
                recording_s: log.t_s[i],
                planned_rad,
                measured_rad,
                planned_flange_m: plan.robot().flange_position(&planned_rad),
                measured_flange_m: plan.robot().flange_position(&measured_rad),
            },
        }
    }
}
