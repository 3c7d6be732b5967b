//! The governor: the last thing before a set-point is put on the wire.
//!
//! Whatever comes before it (a trajectory, a stop, a fault in either), what the drive commands keeps
//! within bounds that the robot can follow:
//!
//! | of what goes out | bound |
//! |---|---|
//! | velocity | 1.02 of the limits |
//! | acceleration | 1.3 of the limits |
//! | position | the range |
//! | distance from where the controller has the arm | what a joint covers at full speed in 30 ms and three answers |
//!
//! **Measured on the wire.** An answer to the message of time `t` of the controller's clock holds a
//! position. The velocity is the difference of two answers over the time between their messages, the
//! acceleration the difference of two such velocities over the mean of their times. These are divided
//! differences: those of any selection of the answers are means of those of all, so that an answer that
//! gets lost on its way makes nothing faster. How often an answer is due changes nothing either: with a
//! multiplier, the steps are longer.
//!
//! **What comes before** is a motion that is followed in time ([`Playback`](crate::playback::Playback)):
//! time goes on as the controller's clock does, by no more than its counter explains, and slows down to
//! zero for a stop. So the arm stays on its path whatever messages get lost, and the governor has nothing
//! to do: it passes on set-points that keep the bounds to the last bit. That holds for gaps as well: the
//! controller goes on as the arm went, and finds it where the trajectory is by then.
//!
//! **What it does.** A set-point beyond the bounds is moved to them, joint by joint. As long as that
//! makes less than 0.001 rad, the next set-point makes up for it (a trajectory of rounded numbers has such
//! peaks). Where it makes more, what comes before is not to be trusted: the run ends, and the arm brakes.
//! Without a set-point, each joint brakes by 1.2 of its limit of acceleration and stands from then on. A
//! trajectory that stays in the range brakes by no more than its limit, so that this stays in the range as
//! well.
//!
//! **Where the arm is.** Each message says where the controller has the arm. When messages or answers
//! are lost, a controller may go on as the arm went, or stop it. If a set-point is further from the arm
//! than the distance above, it would make it leap. Then the run ends: the governor begins anew with where
//! the arm is, and with the velocity that it has had since the message before, and brakes.

use iiwa_kin::{Joints, Limits};

use crate::braking::fastest;

/// What is commanded, as a share of the limits, at most.
const VELOCITY: f64 = 1.02 * (1.0 - 1e-9);
const ACCELERATION: f64 = 1.3 * (1.0 - 1e-9);

/// Braking without a set-point, as a share of the limits of acceleration.
const BRAKING: f64 = 1.2;

/// Braking that would keep a joint within its range, as a share of the limits of acceleration.
const RANGE_BRAKING: f64 = 1.15;

/// A set-point that is moved by more than this, in rad, is not to be trusted.
const MOVED_RAD: f64 = 1e-3;

/// How far a set-point may be from the arm, as the time in which a joint at full speed gets there, in s.
/// Three answers come in addition: the one for the set-point, and two that may be under way.
const AWAY_S: f64 = 0.03;

/// The governor of a session that commands.
pub(super) struct Governor {
    limits: Limits,
    wire: Option<Wire>,
    /// Where the controller has had the arm by the last message, in rad.
    arm_rad: Option<Joints>,
    /// How fast it has moved since the one before, in rad/s.
    arm_speed: Joints,
}

/// What was sent last.
struct Wire {
    /// It was, or it is to be gone on from.
    is_sent: bool,
    at_rad: Joints,
    /// Since the set-point before, in rad/s.
    speed: Joints,
    /// Time from the set-point before, in s.
    step_s: f64,
    /// Time since then, in s.
    since_s: f64,
}

/// What is sent.
pub(super) struct Governed {
    pub(super) joints_rad: Joints,
    /// The joint (0 to 6) whose set-point was moved too far, and by how much in rad.
    pub(super) moved: Option<(usize, f64)>,
}

impl Governor {
    pub(super) fn new(limits: &Limits) -> Self {
        Self { limits: *limits, wire: None, arm_rad: None, arm_speed: [0.0; 7] }
    }

    /// The session does not command, or not any more.
    pub(super) fn release(&mut self) {
        (self.wire, self.arm_rad) = (None, None);
    }

    /// A message of a session that commands, `elapsed_s` after the one before, has the arm at `arm_rad`, if
    /// it says so; an answer is expected every `step_s`.
    pub(super) fn heard(&mut self, arm_rad: Option<&Joints>, elapsed_s: f64, step_s: f64) {
        if let Some(wire) = &mut self.wire {
            wire.since_s += elapsed_s;
        }
        let Some(arm_rad) = arm_rad else {
            self.arm_rad = None;
            return;
        };
        if self.wire.as_ref().is_none_or(|wire| !wire.is_sent) {
            self.wire = Some(Wire::at(*arm_rad, [0.0; 7], step_s));
        }
        let most = self.limits.velocity_rad_s;
        self.arm_speed = match self.arm_rad {
            Some(before) if elapsed_s > 0.0 => std::array::from_fn(|j| {
                ((arm_rad[j] - before[j]) / elapsed_s).clamp(-most[j], most[j])
            }),
            _ => [0.0; 7],
        };
        self.arm_rad = Some(*arm_rad);
    }

    /// The joint (0 to 6) that a set-point would make leap, and how far from the arm it is in rad. An answer
    /// is expected every `step_s`.
    pub(super) fn leap(&self, wanted: &Joints, step_s: f64) -> Option<(usize, f64)> {
        let arm_rad = self.arm_rad.as_ref()?;
        (0..7).find_map(|j| {
            let off = (wanted[j] - arm_rad[j]).abs();
            (off > self.limits.velocity_rad_s[j] * (AWAY_S + 3.0 * step_s)).then_some((j, off))
        })
    }

    /// Begins anew with where the controller has the arm, and with how fast it goes.
    pub(super) fn begin_anew(&mut self, step_s: f64) {
        if let Some(arm_rad) = self.arm_rad {
            let wire = Wire::at(arm_rad, self.arm_speed, step_s);
            self.wire = Some(Wire { is_sent: true, ..wire });
        }
    }

    /// Whether what was commanded last is rest.
    pub(super) fn is_at_rest(&self) -> bool {
        self.wire.as_ref().is_none_or(|wire| wire.speed == [0.0; 7])
    }

    /// The set-point to send for the one that is wanted; without one, braking. `None` before anything was
    /// heard of where the arm is.
    pub(super) fn command(&mut self, wanted: Option<&Joints>) -> Option<Governed> {
        let limits = &self.limits;
        let wire = self.wire.as_mut()?;
        let wanted = wanted.filter(|wanted| wanted.iter().all(|q| q.is_finite()));
        let step_s = if wire.since_s > 0.0 { wire.since_s } else { wire.step_s };
        let span_s = 0.5 * (step_s + wire.step_s);
        let mut moved: Option<(usize, f64)> = None;
        let mut speed = [0.0; 7];
        let joints_rad = std::array::from_fn(|j| {
            let (at, before) = (wire.at_rad[j], wire.speed[j]);
            let (most, range) = (VELOCITY * limits.velocity_rad_s[j], limits.position_rad[j]);
            let acceleration = limits.acceleration_rad_s2[j];
            let wish = match wanted {
                Some(wanted) => (wanted[j] - at) / step_s,
                None => before.signum() * (before.abs() - BRAKING * acceleration * span_s).max(0.0),
            };
            let change = ACCELERATION * acceleration * span_s;
            let stops = |room_rad| fastest(room_rad, RANGE_BRAKING * acceleration, step_s);
            speed[j] = wish
                .clamp(before - change, before + change)
                .clamp(-most, most)
                // The range comes last: it is not to be left, whatever that takes.
                .clamp(-stops(range + at), stops(range - at));
            if let Some(wanted) = wanted
                && speed[j] == wish
                && wanted[j].abs() <= range
            {
                // Not as a sum, which would be rounded.
                return wanted[j];
            }
            let governed = if speed[j] == 0.0 { at } else { at + speed[j] * step_s };
            let governed = governed.clamp(-range.max(at.abs()), range.max(at.abs()));
            if let Some(wanted) = wanted {
                let by = (governed - wanted[j]).abs();
                if moved.is_none_or(|(_, most)| by > most) {
                    moved = Some((j, by));
                }
            }
            governed
        });
        *wire = Wire { is_sent: true, at_rad: joints_rad, speed, step_s, since_s: 0.0 };
        Some(Governed { joints_rad, moved: moved.filter(|(_, by)| *by > MOVED_RAD) })
    }
}

impl Wire {
    fn at(at_rad: Joints, speed: Joints, step_s: f64) -> Self {
        Self { is_sent: false, at_rad, speed, step_s, since_s: step_s }
    }
}

#[cfg(test)]
mod tests {
    use fastrand::Rng;
    use iiwa_kin::Robot;

    use super::*;

    /// Positions, velocities and accelerations of what goes out keep the bounds, whatever comes in.
    #[test]
    fn nothing_gets_past_it() {
        let limits = *Robot::default().limits();
        let Limits { position_rad, velocity_rad_s, acceleration_rad_s2, .. } = limits;
        let mut random = Rng::with_seed(5);
        for step_s in [0.001, 0.005, 0.05] {
            let mut governor = Governor::new(&limits);
            let (mut at, mut speed, mut before_s) = ([0.0; 7], [0.0; 7], step_s);
            governor.heard(Some(&at), step_s, step_s);
            // Where to, for how long: places, noise, numbers that are not finite, nothing.
            let (mut target, mut left, mut noise) = (Some([0.0; 7]), 0, 0.0);
            for _ in 0..20_000 {
                if left == 0 {
                    left = random.u32(1..200);
                    noise = if random.bool() { 0.0 } else { 10.0_f64.powf(-6.0 * random.f64()) };
                    target = match random.u32(0..8) {
                        0 => None,
                        1 => Some([f64::NAN; 7]),
                        2 => Some([f64::INFINITY; 7]),
                        3 => Some([1e300; 7]),
                        4 => Some([-1e300; 7]),
                        _ => Some(position_rad.map(|q| q * (3.0 * random.f64() - 1.5))),
                    };
                }
                left -= 1;
                let wanted = target.map(|q| q.map(|q| q + noise * (random.f64() - 0.5)));
                let sent = governor.command(wanted.as_ref()).unwrap().joints_rad;
                for j in 0..7 {
                    let now = (sent[j] - at[j]) / step_s;
                    let bend = (now - speed[j]) / (0.5 * (step_s + before_s));
                    assert!(sent[j].abs() <= position_rad[j]);
                    assert!(now.abs() <= 1.02 * velocity_rad_s[j], "{now}");
                    assert!(bend.abs() <= 1.3 * acceleration_rad_s2[j] + 1e-6, "{bend}");
                    speed[j] = now;
                }
                (at, before_s) = (sent, step_s);
                governor.heard(Some(&at), step_s, step_s);
            }
        }
    }

    /// What keeps the bounds goes out to the last bit.
    #[test]
    fn it_changes_nothing_that_keeps_the_bounds() {
        let limits = *Robot::default().limits();
        let mut governor = Governor::new(&limits);
        governor.heard(Some(&[0.0; 7]), 0.004, 0.004);
        for i in 1..500 {
            // Up to full speed, and 0.8 of the acceleration.
            let t_s = f64::from(i) * 0.004;
            let wanted =
                limits.velocity_rad_s.map(|speed| speed * 0.25 * (1.0 - (4.0 * t_s).cos()));
            let governed = governor.command(Some(&wanted)).unwrap();
            assert_eq!((governed.joints_rad, governed.moved), (wanted, None));
            governor.heard(Some(&wanted), 0.004, 0.004);
        }
    }

    /// A leap is moved to the bounds, and said to be one.
    #[test]
    fn it_says_what_it_moves() {
        let mut governor = Governor::new(Robot::default().limits());
        governor.heard(Some(&[0.0; 7]), 0.005, 0.005);
        let mut wanted = [0.0; 7];
        wanted[4] = 0.01;
        let (joint, by_rad) = governor.command(Some(&wanted)).unwrap().moved.unwrap();
        assert!(joint == 4 && (0.009..0.01).contains(&by_rad), "joint {joint}, {by_rad} rad");
        assert!(!governor.is_at_rest());
        for _ in 0..100 {
            governor.heard(None, 0.005, 0.005);
            let _ = governor.command(None);
        }
        assert!(governor.is_at_rest());
    }
}
