//! Playback of a motion over time, with stops on its path.

use iiwa_kin::Joints;

/// Joint positions over time, from rest to rest.
pub trait TimedMotion {
    /// Returns the joint positions `t_s` after the start, in rad; after the end, those of the end.
    fn at(&self, t_s: f64) -> Joints;
    /// Returns the duration, in s.
    fn duration_s(&self) -> f64;
}

/// Duration of a stop on the path, in s.
///
/// The acceleration limits are five times the velocity limits per second (Larsen 2019, Table 4).
/// Slowing down time within half a second takes a deceleration of at most 3.75/s times the
/// velocity, at half the velocity, where the acceleration of the path itself has decreased to a
/// quarter. Together, they are at most 1.24 times the acceleration limits if both are at their
/// limits when the stop begins.
pub const STOP_S: f64 = 0.5;

/// Duration of an emergency stop on the path, in s, which may exceed the acceleration limits.
pub const EMERGENCY_STOP_S: f64 = 0.25;

/// Playback of a motion, cycle by cycle.
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
    /// Time along the motion at the start of the stop, in s.
    began_at_s: f64,
    /// Time since the start of the stop, in s.
    lasted_s: f64,
    /// Duration of the stop, in s.
    duration_s: f64,
}

impl<M: TimedMotion> Playback<M> {
    /// Starts the playback of a motion.
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
                // Integral of the time rate, 1 - (10 x^3 - 15 x^4 + 6 x^5), which starts and ends
                // with zero slope.
                let progress = x - x.powi(4) * (2.5 - 3.0 * x + x * x);
                self.at_s = stop_on_path.began_at_s + progress * stop_on_path.duration_s;
            }
        }
    }

    /// Starts a stop of duration `duration_s`; an earlier stop continues.
    pub fn stop(&mut self, duration_s: f64) {
        if self.stop_on_path.is_none() {
            self.stop_on_path = Some(PathStop { began_at_s: self.at_s, lasted_s: 0.0, duration_s });
        }
    }

    /// Returns the current joint positions, in rad.
    pub fn position(&self) -> Joints {
        self.motion.at(self.at_s)
    }

    /// Returns the motion.
    pub fn motion(&self) -> &M {
        &self.motion
    }

    /// Returns the time rate along the motion, and its derivative in 1/s: 1 and 0 without a stop.
    pub fn time_rate(&self) -> (f64, f64) {
        let Some(PathStop { lasted_s, duration_s, .. }) = self.stop_on_path else {
            return (1.0, 0.0);
        };
        let x = lasted_s / duration_s;
        let rest = 1.0 - x;
        (1.0 - x.powi(3) * (10.0 - 15.0 * x + 6.0 * x * x), -30.0 * (x * rest).powi(2) / duration_s)
    }

    /// Returns true if the robot is at rest, at the end of the motion or before.
    pub fn is_over(&self) -> bool {
        let is_stopped = self
            .stop_on_path
            .is_some_and(|stop_on_path| stop_on_path.lasted_s >= stop_on_path.duration_s);
        is_stopped || self.at_s >= self.motion.duration_s()
    }

    /// Returns true if the motion stops, or has stopped, before its end.
    pub fn is_cut_short(&self) -> bool {
        self.stop_on_path.is_some() && self.at_s < self.motion.duration_s()
    }

    /// Returns the time along the motion, in s.
    pub fn at_s(&self) -> f64 {
        self.at_s.min(self.motion.duration_s())
    }

    /// Returns the duration of the motion, in s.
    pub fn duration_s(&self) -> f64 {
        self.motion.duration_s()
    }
}
