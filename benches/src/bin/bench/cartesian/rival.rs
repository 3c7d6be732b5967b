//! LIN timed by a single trapezoidal profile of its path parameter, as in the KDL and Pilz
//! planners.
//!
//! The trapezoid limits the TCP: joint positions follow from inverse kinematics at samples, where
//! joint limits are only checked, by finite differences. The user of such a planner lowers the
//! scaling factor until the check passes.

use iiwa_kin::{Joints, Robot};
use iiwasim_benches::Result;

use super::{straight::Straight, trapezoid::Trapezoid};

/// Samples per second.
const RATE_HZ: f64 = 1000.0;
/// Number of tested ratios of the ramp to the duration, from the smallest to a half.
const SHARES: u32 = 32;
const MIN_SHARE: f64 = 0.005;
/// Number of golden-section steps that then refine the best ratio.
const GOLDEN: usize = 16;
/// Relative precision of durations and factors.
const PRECISION: f64 = 1e-4;

/// Pilz' default TCP limits: m/s, m/s^2 and rad/s.
pub(crate) const PILZ_SPEED_M_S: f64 = 1.0;
pub(crate) const PILZ_ACCELERATION_M_S2: f64 = 2.25;
pub(crate) const PILZ_TURN_RAD_S: f64 = 1.57;

/// Compared profiles: the fastest trapezoid; Pilz' limits times the largest feasible factor; and
/// times the largest feasible factor up to 1.
pub(crate) const RIVALS: [&str; 3] =
    ["best trapezoid", "one factor, the largest", "one factor up to 1"];

/// Returns the durations of [`RIVALS`], in s.
pub(crate) fn durations_s(line: &Straight<'_>, robot: &Robot) -> Result<[f64; 3]> {
    let factor = largest_factor(line, robot)?;
    let motions = [best(line, robot)?, pilz(line, factor), pilz(line, factor.min(1.0))];
    Ok(motions.map(|motion| motion.duration_s()))
}

/// Returns the number of samples in a duration, at 1 kHz.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "durations are seconds, above zero"
)]
fn samples_in(duration_s: f64) -> usize {
    (duration_s * RATE_HZ).ceil() as usize
}

/// Returns the largest velocity and the largest acceleration of a joint relative to their limits,
/// by differences of samples at 1 kHz.
fn worst(line: &Straight<'_>, robot: &Robot, motion: &Trapezoid) -> Result<[f64; 2]> {
    let samples = samples_in(motion.duration_s());
    differences(line, robot, |k| motion.s(k as f64 / RATE_HZ), samples, RATE_HZ)
}

/// Returns these ratios for s at `samples` samples after the first. The arm is at rest before and
/// after.
fn differences(
    line: &Straight<'_>,
    robot: &Robot,
    s: impl Fn(usize) -> f64,
    samples: usize,
    rate_hz: f64,
) -> Result<[f64; 2]> {
    let limits = robot.limits();
    let mut worst = [0.0_f64; 2];
    let mut before = line.joints(s(0))?;
    let mut velocity: Joints = [0.0; 7];
    for k in 1..=samples + 1 {
        let q = line.joints(s(k.min(samples)))?;
        for j in 0..7 {
            let now = (q[j] - before[j]) * rate_hz;
            let acceleration = (now - velocity[j]) * rate_hz;
            worst[0] = worst[0].max(now.abs() / limits.velocity_rad_s[j]);
            worst[1] = worst[1].max(acceleration.abs() / limits.acceleration_rad_s2[j]);
            velocity[j] = now;
        }
        before = q;
    }
    Ok(worst)
}

fn passes(line: &Straight<'_>, robot: &Robot, motion: &Trapezoid) -> Result<bool> {
    Ok(worst(line, robot, motion)?.iter().all(|&share| share <= 1.0))
}

/// Returns the fastest feasible trapezoid. A trapezoid is given by ramp ratio and duration; for a
/// fixed ratio, velocity is inversely proportional to the duration and acceleration to its square,
/// so one evaluation determines the shortest duration.
fn best(line: &Straight<'_>, robot: &Robot) -> Result<Trapezoid> {
    let least_s = |share: f64| -> Result<f64> {
        let mut duration_s = 1.0;
        // Two passes, so that samples are one millisecond apart.
        for _ in 0..2 {
            let samples = samples_in(duration_s).max(20);
            let unit = Trapezoid::with_ramp(share, 1.0);
            let rate = samples as f64;
            let [velocity, acceleration] =
                differences(line, robot, |k| unit.s(k as f64 / rate), samples, rate)?;
            duration_s = velocity.max(acceleration.sqrt());
        }
        Ok(duration_s)
    };
    let share = |x: f64| MIN_SHARE * (0.5 / MIN_SHARE).powf(x.clamp(0.0, 1.0));
    let mut tried = Vec::new();
    for i in 0..SHARES {
        let x = f64::from(i) / f64::from(SHARES - 1);
        tried.push((least_s(share(x))?, x));
    }
    let (mut fastest_s, mut best) =
        tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).ok_or("nothing was tried")?;
    let step = f64::from(SHARES - 1).recip();
    let (mut low, mut high) = (best - step, best + step);
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..GOLDEN {
        let [a, b] = [high - golden * (high - low), low + golden * (high - low)];
        let [a_s, b_s] = [least_s(share(a))?, least_s(share(b))?];
        for (found_s, x) in [(a_s, a), (b_s, b)] {
            if found_s < fastest_s {
                (fastest_s, best) = (found_s, x);
            }
        }
        if a_s < b_s {
            high = b;
        } else {
            low = a;
        }
    }
    let profile = |duration_s: f64| Trapezoid::with_ramp(share(best), duration_s);
    // From here on with samples at exactly 1 kHz.
    let (mut slow_s, mut fast_s) = (fastest_s, 0.98 * fastest_s);
    while !passes(line, robot, &profile(slow_s))? {
        slow_s *= 1.01;
    }
    while slow_s - fast_s > PRECISION * slow_s {
        let middle_s = 0.5 * (slow_s + fast_s);
        if passes(line, robot, &profile(middle_s))? {
            slow_s = middle_s;
        } else {
            fast_s = middle_s;
        }
    }
    Ok(profile(slow_s))
}

/// Returns Pilz' trapezoid, with its limits times a factor. The path length is the TCP distance, or
/// the rotation angle times the radius at which both of Pilz' speeds are equal.
fn pilz(line: &Straight<'_>, factor: f64) -> Trapezoid {
    let [way_m, turn_rad] = line.way();
    let length_m = way_m.max(turn_rad * PILZ_SPEED_M_S / PILZ_TURN_RAD_S);
    Trapezoid::within(
        factor * PILZ_SPEED_M_S / length_m,
        factor * PILZ_ACCELERATION_M_S2 / length_m,
    )
}

fn largest_factor(line: &Straight<'_>, robot: &Robot) -> Result<f64> {
    let passes = |factor: f64| passes(line, robot, &pilz(line, factor));
    let (mut low, mut high) = (1.0, 1.0);
    while passes(high)? {
        low = high;
        high *= 2.0;
    }
    while !passes(low)? {
        high = low;
        low *= 0.5;
    }
    while high - low > PRECISION * low {
        let middle = 0.5 * (low + high);
        if passes(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(low)
}
