//! The governor: a rate limiter for set-points, the last stage before they are sent.
//!
//! The commanded motion satisfies these bounds, regardless of the preceding stages (a trajectory, a
//! stop, a fault in either):
//!
//! | quantity | bound |
//! |---|---|
//! | velocity | 1.02 of the limits |
//! | acceleration | 1.3 of the limits |
//! | position | the joint range |
//! | distance to the position commanded by the controller | joint displacement at full speed in 30 ms plus three answer periods |
//!
//! **Definition of velocity and acceleration.** The answer to a message with controller time `t`
//! contains a position. The velocity is the difference of two answers over the time between their
//! messages; the acceleration is the difference of two such velocities over the mean of their
//! times. Divided differences of a subset of the answers are weighted averages of those of all
//! answers, so that lost answers do not increase them. A receive multiplier only lengthens the
//! steps.
//!
//! **Normal operation.** The stage before the governor
//! ([`Playback`](iiwa_traj::playback::Playback)) samples a motion. Its time advances with the time
//! stamps of the controller, but by no more than the sequence counter indicates. For a stop, the
//! rate of this time decreases to zero. So the robot stays on its path even if messages are lost,
//! and the governor passes set-points within the bounds unchanged, bit for bit. The same holds
//! after a gap in the messages if the controller has extrapolated the motion: the trajectory
//! continues at the position for the current time.
//!
//! **Intervention.** A set-point beyond the bounds is clamped to them, joint by joint. A correction
//! of up to 0.001 rad is tolerated, and the next set-points make up for it: trajectories with
//! rounded numbers exceed the bounds briefly. A larger correction aborts the run, and the robot
//! brakes. Without a set-point, each joint brakes at 1.2 of its acceleration limit and then holds
//! its position. A trajectory within the joint range can stop within the range at 1.0 of the limit;
//! braking at 1.2 stops sooner, and therefore also within the range.
//!
//! **Deviation from the controller.** Each message contains the joint position that the controller
//! commands, called controller position here. If messages or answers are lost, a controller may
//! extrapolate the motion or stop the robot. A set-point beyond the distance bound above would
//! cause a jump. In this case the run is aborted: the governor restarts at the controller position,
//! with the velocity since the previous message, and brakes.

use iiwa_kin::{Joints, Limits};

use iiwa_fri::braking::fastest;

/// Velocity and acceleration bounds, as shares of the limits.
const VELOCITY: f64 = 1.02 * (1.0 - 1e-9);
const ACCELERATION: f64 = 1.3 * (1.0 - 1e-9);

/// Deceleration without a set-point, as a share of the acceleration limits.
const BRAKING: f64 = 1.2;

/// Deceleration towards the end of the joint range, as a share of the acceleration limits.
const RANGE_BRAKING: f64 = 1.15;

/// Maximum correction of a set-point that does not abort the run, in rad.
const MAX_CORRECTION_RAD: f64 = 1e-3;

/// Maximum distance of a set-point from the controller position, as the time in s in which a joint
/// at full speed covers it. Three answer periods are added: for the answer with the set-point, and
/// for two that may be in transit.
const MAX_DISTANCE_S: f64 = 0.03;

/// The governor of a commanding session.
pub(super) struct Governor {
    limits: Limits,
    last: Option<LastSetpoint>,
    /// Controller position in the last message, in rad.
    arm_rad: Option<Joints>,
    /// Velocity of the controller position since the previous message, in rad/s.
    arm_speed: Joints,
}

/// The last set-point.
struct LastSetpoint {
    /// `true` if the set-point was sent, or counts as sent after a restart.
    is_sent: bool,
    at_rad: Joints,
    /// Velocity since the previous set-point, in rad/s.
    speed: Joints,
    /// Time from the previous set-point, in s.
    step_s: f64,
    /// Time since this set-point, in s.
    since_s: f64,
}

/// A set-point within the bounds.
pub(super) struct LimitedSetpoint {
    pub(super) joints_rad: Joints,
    /// The joint (0 to 6) with a correction beyond [`MAX_CORRECTION_RAD`], and the correction in
    /// rad.
    pub(super) moved: Option<(usize, f64)>,
}

impl Governor {
    pub(super) fn new(limits: &Limits) -> Self {
        Self { limits: *limits, last: None, arm_rad: None, arm_speed: [0.0; 7] }
    }

    /// Resets the state, because the session does not command.
    pub(super) fn release(&mut self) {
        (self.last, self.arm_rad) = (None, None);
    }

    /// Observes a message of a commanding session, `elapsed_s` after the previous one, with the
    /// controller position `arm_rad`, if stated. An answer is expected every `step_s`.
    pub(super) fn observe(&mut self, arm_rad: Option<&Joints>, elapsed_s: f64, step_s: f64) {
        if let Some(last) = &mut self.last {
            last.since_s += elapsed_s;
        }
        let Some(arm_rad) = arm_rad else {
            self.arm_rad = None;
            return;
        };
        // Until the first set-point is sent, the reference follows the controller.
        if self.last.as_ref().is_none_or(|last| !last.is_sent) {
            self.last = Some(LastSetpoint::at(*arm_rad, [0.0; 7], step_s));
        }
        let max_speed = self.limits.velocity_rad_s;
        // Clamped to the limits, because braking starts at this velocity after `restart`.
        self.arm_speed = match self.arm_rad {
            Some(before) if elapsed_s > 0.0 => std::array::from_fn(|j| {
                ((arm_rad[j] - before[j]) / elapsed_s).clamp(-max_speed[j], max_speed[j])
            }),
            _ => [0.0; 7],
        };
        self.arm_rad = Some(*arm_rad);
    }

    /// Returns the first joint (0 to 6) that a set-point would make jump, and the distance of the
    /// set-point from the controller position in rad. An answer is expected every `step_s`.
    pub(super) fn jump(&self, requested: &Joints, step_s: f64) -> Option<(usize, f64)> {
        let arm_rad = self.arm_rad.as_ref()?;
        (0..7).find_map(|j| {
            let off = (requested[j] - arm_rad[j]).abs();
            (off > self.limits.velocity_rad_s[j] * (MAX_DISTANCE_S + 3.0 * step_s))
                .then_some((j, off))
        })
    }

    /// Restarts at the controller position and its velocity.
    pub(super) fn restart(&mut self, step_s: f64) {
        if let Some(arm_rad) = self.arm_rad {
            let last = LastSetpoint::at(arm_rad, self.arm_speed, step_s);
            self.last = Some(LastSetpoint { is_sent: true, ..last });
        }
    }

    /// Returns true if the last commanded velocity is zero.
    pub(super) fn is_at_rest(&self) -> bool {
        self.last.as_ref().is_none_or(|last| last.speed == [0.0; 7])
    }

    /// Returns the set-point to send for a requested one; without a request, the set-point of a
    /// braking motion. `None` before the first controller position.
    pub(super) fn command(&mut self, requested: Option<&Joints>) -> Option<LimitedSetpoint> {
        let limits = &self.limits;
        let last = self.last.as_mut()?;
        // A non-finite set-point counts as missing, so that the joints brake.
        let requested = requested.filter(|requested| requested.iter().all(|q| q.is_finite()));
        // Never zero, because displacements are divided by it: messages may have equal time stamps.
        let step_s = if last.since_s > 0.0 { last.since_s } else { last.step_s };
        let span_s = 0.5 * (step_s + last.step_s);
        let mut moved: Option<(usize, f64)> = None;
        let mut speed = [0.0; 7];
        let joints_rad = std::array::from_fn(|j| {
            let (position, before) = (last.at_rad[j], last.speed[j]);
            let max_speed = VELOCITY * limits.velocity_rad_s[j];
            let (lower, upper) = (limits.lower_rad[j], limits.upper_rad[j]);
            let acceleration = limits.acceleration_rad_s2[j];
            let target_speed = match requested {
                Some(requested) => (requested[j] - position) / step_s,
                None => before.signum() * (before.abs() - BRAKING * acceleration * span_s).max(0.0),
            };
            let change = ACCELERATION * acceleration * span_s;
            let stops = |room_rad| fastest(room_rad, RANGE_BRAKING * acceleration, step_s);
            speed[j] = target_speed
                .clamp(before - change, before + change)
                .clamp(-max_speed, max_speed)
                // The range is applied last, because it has priority over the acceleration.
                .clamp(-stops(position - lower), stops(upper - position));
            if let Some(requested) = requested
                && speed[j] == target_speed
                && (lower..=upper).contains(&requested[j])
            {
                // Returned exactly: a sum would be rounded.
                return requested[j];
            }
            let limited = if speed[j] == 0.0 { position } else { position + speed[j] * step_s };
            // A joint that is outside its range does not jump into it.
            let limited = limited.clamp(lower.min(position), upper.max(position));
            if let Some(requested) = requested {
                let by = (limited - requested[j]).abs();
                if moved.is_none_or(|(_, max_shift)| by > max_shift) {
                    moved = Some((j, by));
                }
            }
            limited
        });
        *last = LastSetpoint { is_sent: true, at_rad: joints_rad, speed, step_s, since_s: 0.0 };
        Some(LimitedSetpoint {
            joints_rad,
            moved: moved.filter(|(_, by)| *by > MAX_CORRECTION_RAD),
        })
    }
}

impl LastSetpoint {
    fn at(at_rad: Joints, speed: Joints, step_s: f64) -> Self {
        Self { is_sent: false, at_rad, speed, step_s, since_s: step_s }
    }
}

#[cfg(test)]
mod tests {
    use fastrand::Rng;
    use iiwa_kin::Robot;

    use super::*;

    /// Output positions, velocities and accelerations satisfy the bounds for any input.
    #[test]
    fn the_output_keeps_the_bounds() {
        let limits = *Robot::default().limits();
        let Limits { lower_rad, upper_rad, velocity_rad_s, acceleration_rad_s2, .. } = limits;
        let mut random = Rng::with_seed(5);
        for step_s in [0.001, 0.005, 0.05] {
            let mut governor = Governor::new(&limits);
            let (mut position, mut speed, mut before_s) = ([0.0; 7], [0.0; 7], step_s);
            governor.observe(Some(&position), step_s, step_s);
            // Target and number of steps: positions, noise, non-finite numbers, no request.
            let (mut target, mut remaining, mut noise) = (Some([0.0; 7]), 0, 0.0);
            for _ in 0..20_000 {
                if remaining == 0 {
                    remaining = random.u32(1..200);
                    noise = if random.bool() { 0.0 } else { 10.0_f64.powf(-6.0 * random.f64()) };
                    target = match random.u32(0..8) {
                        0 => None,
                        1 => Some([f64::NAN; 7]),
                        2 => Some([f64::INFINITY; 7]),
                        3 => Some([1e300; 7]),
                        4 => Some([-1e300; 7]),
                        _ => Some(upper_rad.map(|q| q * (3.0 * random.f64() - 1.5))),
                    };
                }
                remaining -= 1;
                let requested = target.map(|q| q.map(|q| q + noise * (random.f64() - 0.5)));
                let setpoint = governor.command(requested.as_ref()).unwrap().joints_rad;
                for j in 0..7 {
                    let now = (setpoint[j] - position[j]) / step_s;
                    let bend = (now - speed[j]) / (0.5 * (step_s + before_s));
                    assert!((lower_rad[j]..=upper_rad[j]).contains(&setpoint[j]));
                    assert!(now.abs() <= 1.02 * velocity_rad_s[j], "{now}");
                    assert!(bend.abs() <= 1.3 * acceleration_rad_s2[j] + 1e-6, "{bend}");
                    speed[j] = now;
                }
                (position, before_s) = (setpoint, step_s);
                governor.observe(Some(&position), step_s, step_s);
            }
        }
    }

    /// Set-points within the bounds are not changed.
    #[test]
    fn setpoints_within_the_bounds_are_unchanged() {
        let limits = *Robot::default().limits();
        let mut governor = Governor::new(&limits);
        governor.observe(Some(&[0.0; 7]), 0.004, 0.004);
        for i in 1..500 {
            // Up to full speed, and 0.8 of the acceleration.
            let t_s = f64::from(i) * 0.004;
            let requested =
                limits.velocity_rad_s.map(|speed| speed * 0.25 * (1.0 - (4.0 * t_s).cos()));
            let limited = governor.command(Some(&requested)).unwrap();
            assert_eq!((limited.joints_rad, limited.moved), (requested, None));
            governor.observe(Some(&requested), 0.004, 0.004);
        }
    }

    /// A jump is limited and reported.
    #[test]
    fn corrections_are_reported() {
        let mut governor = Governor::new(Robot::default().limits());
        governor.observe(Some(&[0.0; 7]), 0.005, 0.005);
        let mut requested = [0.0; 7];
        requested[4] = 0.01;
        let (joint, by_rad) = governor.command(Some(&requested)).unwrap().moved.unwrap();
        assert!(joint == 4 && (0.009..0.01).contains(&by_rad), "joint {joint}, {by_rad} rad");
        assert!(!governor.is_at_rest());
        for _ in 0..100 {
            governor.observe(None, 0.005, 0.005);
            let _ = governor.command(None);
        }
        assert!(governor.is_at_rest());
    }

    /// Velocities change over the mean of the times of two steps.
    #[test]
    fn unequal_steps_keep_the_acceleration() {
        let limits = *Robot::default().limits();
        for [first_s, second_s] in [[0.001, 0.01], [0.01, 0.001], [0.005, 0.005]] {
            let mut governor = Governor::new(&limits);
            governor.observe(Some(&[0.0; 7]), first_s, first_s);
            let setpoint = governor.command(Some(&[0.0; 7])).unwrap().joints_rad;
            assert_eq!(setpoint, [0.0; 7]);
            governor.observe(None, second_s, first_s);
            let setpoint = governor.command(Some(&[2.0; 7])).unwrap().joints_rad;
            let mean_s = 0.5 * (first_s + second_s);
            for (setpoint, limit) in setpoint.iter().zip(limits.acceleration_rad_s2) {
                let share = setpoint / second_s / mean_s / limit;
                assert!((share - 1.3).abs() < 1e-6, "{first_s} s, {second_s} s: {share}");
            }
            // Braking, with the two step lengths swapped.
            governor.observe(None, first_s, first_s);
            let braked = governor.command(None).unwrap().joints_rad;
            for j in 0..7 {
                let change = setpoint[j] / second_s - (braked[j] - setpoint[j]) / first_s;
                let share = change / mean_s / limits.acceleration_rad_s2[j];
                assert!((share - 1.2).abs() < 1e-6, "{first_s} s, {second_s} s: {share}");
            }
        }
    }
}
