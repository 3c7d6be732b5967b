//! Playback of a motion over time, with stops on its path.

use iiwa_kin::Joints;

/// Joint positions over time, from rest to rest.
pub trait TimedMotion {
    /// Joint positions `t_s` after the start, in rad; after the end, those of the end.
    fn at(&self, t_s: f64) -> Joints;
    /// Its duration, in s.
    fn duration_s(&self) -> f64;
}

/// Duration of a stop on the path, in s.
///
/// The acceleration limits are five times the velocity limits per second (Larsen 2019, Table 4). Slowing down
/// time within half a second takes a deceleration of at most 3.75/s times the velocity, at half the velocity,
/// where the acceleration of the path itself has decreased to a quarter. Together, they are at most 1.24 times
/// the acceleration limits if both are at their limits when the stop begins.
pub const STOP_S: f64 = 0.5;

/// Duration of an emergency stop on the path, in s, which may exceed the acceleration limits.
pub const EMERGENCY_STOP_S: f64 = 0.25;

/// Plays back a motion cycle by cycle.
#[derive(Debug)]
pub struct Playback<M> {
    motion: M,
    /// Time along the motion, in s.
    at_s: f64,
    stop_on_path: Option<PathStop>,
}

#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_field_names, reason = "the unit is part of a name")]
struct PathStop {
    /// Time along the motion when the stop began, in s.
    began_at_s: f64,
    /// Time since then, in s.
    lasted_s: f64,
    /// Duration of the stop, in s.
    duration_s: f64,
}

impl<M: TimedMotion> Playback<M> {
    /// Begins at the start of a motion.
    pub fn new(motion: M) -> Self {
        Self { motion, at_s: 0.0, stop_on_path: None }
    }

    /// Advances by `dt_s`.
    pub fn advance(&mut self, dt_s: f64) {
        match &mut self.stop_on_path {
            None => self.at_s += dt_s,
            Some(stop_on_path) => {
                stop_on_path.lasted_s = (stop_on_path.lasted_s + dt_s).min(stop_on_path.duration_s);
                let x = stop_on_path.lasted_s / stop_on_path.duration_s;
                // The integral of 1 - (10 x^3 - 15 x^4 + 6 x^5).
                let progress = x - x.powi(4) * (2.5 - 3.0 * x + x * x);
                self.at_s = stop_on_path.began_at_s + progress * stop_on_path.duration_s;
            }
        }
    }

    /// Begins a stop that takes `duration_s`.
    pub fn stop(&mut self, duration_s: f64) {
        if self.stop_on_path.is_none() {
            self.stop_on_path = Some(PathStop { began_at_s: self.at_s, lasted_s: 0.0, duration_s });
        }
    }

    /// The current joint positions, in rad.
    pub fn position(&self) -> Joints {
        self.motion.at(self.at_s)
    }

    /// The motion.
    pub fn motion(&self) -> &M {
        &self.motion
    }

    /// How fast time goes by along the motion, and the derivative of that, in 1/s: 1 and 0 unless it stops.
    pub fn time_rate(&self) -> (f64, f64) {
        let Some(PathStop { lasted_s, duration_s, .. }) = self.stop_on_path else {
            return (1.0, 0.0);
        };
        let x = lasted_s / duration_s;
        let rest = 1.0 - x;
        (1.0 - x.powi(3) * (10.0 - 15.0 * x + 6.0 * x * x), -30.0 * (x * rest).powi(2) / duration_s)
    }

    /// Whether the arm is at rest, at the end of the motion or before.
    pub fn is_over(&self) -> bool {
        let is_stopped = self
            .stop_on_path
            .is_some_and(|stop_on_path| stop_on_path.lasted_s >= stop_on_path.duration_s);
        is_stopped || self.at_s >= self.motion.duration_s()
    }

    /// Whether it stops, or has stopped, before the end of the motion.
    pub fn is_cut_short(&self) -> bool {
        self.stop_on_path.is_some() && self.at_s < self.motion.duration_s()
    }

    /// Time along the motion, in s.
    pub fn at_s(&self) -> f64 {
        self.at_s.min(self.motion.duration_s())
    }

    /// Duration of the motion, in s.
    pub fn duration_s(&self) -> f64 {
        self.motion.duration_s()
    }
}
