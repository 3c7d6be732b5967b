//! How far the arm is from the planned path, whenever it is there.

use iiwa_kin::{
    Joints, Robot,
    vector::{distance, sub},
};
use iiwa_log::JointLog;
use iiwa_program::MotionIndex;

use super::motion_deviation::{MotionDeviation, MotionDeviations};
use super::plan::Plan;

/// How far the recorded path is from the planned one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// The mean along the planned path: in rad of joint space, or in m of the TCP.
    pub mean: f64,
    /// The largest one.
    pub max: f64,
    /// Where it is the largest.
    pub at: Location,
}

/// A place on both paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Location {
    /// The motion of the program.
    pub motion: MotionIndex,
    /// When the plan is there, in s from the program's start.
    pub plan_s: f64,
    /// When the arm was there, in s of the recording.
    pub recording_s: f64,
    /// The planned joints, in rad.
    pub planned_rad: Joints,
    /// The measured joints, in rad.
    pub measured_rad: Joints,
    /// The planned TCP, in m.
    pub planned_tcp_m: [f64; 3],
    /// The measured TCP, in m.
    pub measured_tcp_m: [f64; 3],
}

/// A sample that is kept for pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracePoint {
    /// When the plan is there, in s from the program's start.
    pub plan_s: f64,
    /// When the arm was there, in s from the start of its motion.
    pub measured_s: f64,
    /// The measured TCP, in m.
    pub tcp_m: [f64; 3],
    /// Distance to the planned path in joint space, in rad.
    pub joints_rad: f64,
    /// Distance to the planned path of the TCP, in m.
    pub tcp_deviation_m: f64,
}

/// Points of a trace at most.
const TRACE: usize = 10_000;

/// The deviations over some samples.
pub(super) struct Deviations {
    pub(super) joints_rad: Deviation,
    pub(super) tcp_m: Deviation,
    /// The largest ones of each motion.
    pub(super) motions: Vec<MotionDeviation>,
    /// Some of the samples.
    pub(super) trace: Vec<TracePoint>,
}

/// The deviations in joint space and of the TCP over some samples, and some of them.
pub(super) fn deviations(
    plan: &Plan,
    log: &JointLog,
    samples: std::ops::Range<usize>,
    place_s: &[f64],
    start_s: f64,
) -> Option<Deviations> {
    let curve = &plan.curve;
    let thinned = samples.len().div_ceil(TRACE).max(1);
    let mut trace = Vec::with_capacity(samples.len() / thinned + 2);
    let (mut joints, mut tcp) = (Sum::default(), Sum::default());
    let mut motions = MotionDeviations::default();
    let mut farthest = f64::NEG_INFINITY;
    let last = samples.len().checked_sub(1)?;
    for (k, (i, &plan_s)) in samples.zip(place_s).enumerate() {
        let q = &log.q_rad[i];
        let interval = curve.interval_at(plan_s);
        let (planned, rate) = curve.in_interval(interval, plan_s);
        let arc = curve.arc(interval) + distance(&planned, &curve.knots()[interval].q);
        // Standing, and back within the noise, is no way.
        let way = if farthest.is_finite() { (arc - farthest).max(0.0) } else { 0.0 };
        farthest = farthest.max(arc);
        let off_rad = distance(q, &planned);
        let tcp_m = plan.robot().flange_position(q);
        let off_m = tcp_distance(plan, plan_s, (&planned, &rate), tcp_m);
        motions.add(plan.motion_at(plan_s), &sub(q, &planned), off_m);
        joints.add(off_rad, way, i, plan_s);
        tcp.add(off_m, way, i, plan_s);
        if k % thinned == 0 || k == last {
            trace.push(TracePoint {
                plan_s,
                measured_s: log.t_s[i] - start_s,
                tcp_m,
                joints_rad: off_rad,
                tcp_deviation_m: off_m,
            });
        }
    }
    Some(Deviations {
        joints_rad: joints.deviation(plan, log),
        tcp_m: tcp.deviation(plan, log),
        motions: motions.all(),
        trace,
    })
}

/// Distance of a point from the planned path of the TCP near the place that the plan's joints are at: the
/// nearest point of the TCP's path is not quite that of the nearest joints.
fn tcp_distance(
    plan: &Plan,
    plan_s: f64,
    (planned, rate): (&Joints, &Joints),
    tcp_m: [f64; 3],
) -> f64 {
    let (robot, curve): (&Robot, _) = (plan.robot(), &plan.curve);
    let (mut at_s, mut q, mut dq) = (plan_s, *planned, *rate);
    let mut nearest = f64::MAX;
    for _ in 0..4 {
        let (p, v) = robot.flange_motion(&q, &dq);
        let to: [f64; 3] = std::array::from_fn(|k| tcp_m[k] - p[k]);
        let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let off = dot(&to, &to).sqrt();
        if off >= nearest {
            break;
        }
        nearest = off;
        let (along, speed) = (dot(&to, &v), dot(&v, &v));
        // Where the TCP hardly moves, or the point is abreast already, there is nothing to gain.
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
    /// The sample with the largest, and its place.
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

    fn deviation(&self, plan: &Plan, log: &JointLog) -> Deviation {
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
                planned_tcp_m: plan.robot().flange_position(&planned_rad),
                measured_tcp_m: plan.robot().flange_position(&measured_rad),
            },
        }
    }
}
