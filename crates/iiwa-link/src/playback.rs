//! Following a trajectory in time, and stopping on its path.

use iiwa_kin::Joints;

/// A motion that can be followed: positions over time, from rest to rest.
pub(crate) trait Motion {
    /// Where the joints are `t_s` after the start, in rad; after the end, there.
    fn at(&self, t_s: f64) -> Joints;
    /// How long it takes, in s.
    fn duration_s(&self) -> f64;
}

impl Motion for iiwa_traj::Trajectory {
    fn at(&self, t_s: f64) -> Joints {
        Self::at(self, t_s).q
    }

    fn duration_s(&self) -> f64 {
        self.cycle_time_s()
    }
}

/// How long a stop on the path takes, in s.
///
/// The limits of acceleration are five times those of speed (Larsen 2019, Table 4). Time that slows
/// down as it does here within half a second takes 3.75/s of them at most, at half the speed; the
/// path's own acceleration is down to a quarter there. So the arm keeps its limits of acceleration.
pub(crate) const STOP_S: f64 = 0.5;

/// How long an emergency stop on the path takes, in s: half as long, whatever the limits say.
pub(crate) const EMERGENCY_STOP_S: f64 = 0.25;

/// Follows a motion cycle by cycle.
#[derive(Debug)]
pub(crate) struct Playback<M> {
    motion: M,
    /// Time along the motion, in s.
    at_s: f64,
    braking: Option<Braking>,
}

#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_field_names, reason = "the unit is part of a name")]
struct Braking {
    /// Where along the motion it began, in s.
    began_at_s: f64,
    /// For how long it has braked, in s.
    lasted_s: f64,
    /// How long it takes, in s.
    duration_s: f64,
}

impl<M: Motion> Playback<M> {
    pub(crate) fn new(motion: M) -> Self {
        Self { motion, at_s: 0.0, braking: None }
    }

    /// Goes on by `dt_s`.
    pub(crate) fn advance(&mut self, dt_s: f64) {
        match &mut self.braking {
            None => self.at_s += dt_s,
            Some(braking) => {
                braking.lasted_s = (braking.lasted_s + dt_s).min(braking.duration_s);
                let x = braking.lasted_s / braking.duration_s;
                // The integral of 1 - (10 x^3 - 15 x^4 + 6 x^5).
                let way = x - x.powi(4) * (2.5 - 3.0 * x + x * x);
                self.at_s = braking.began_at_s + way * braking.duration_s;
            }
        }
    }

    /// From now on slows down to a stop, which takes `duration_s`.
    pub(crate) fn stop(&mut self, duration_s: f64) {
        if self.braking.is_none() {
            self.braking = Some(Braking { began_at_s: self.at_s, lasted_s: 0.0, duration_s });
        }
    }

    /// Where the joints are, in rad.
    pub(crate) fn position(&self) -> Joints {
        self.motion.at(self.at_s)
    }

    /// Whether the arm has come to rest, at the motion's end or before.
    pub(crate) fn is_over(&self) -> bool {
        let stands = self.braking.is_some_and(|braking| braking.lasted_s >= braking.duration_s);
        stands || self.at_s >= self.motion.duration_s()
    }

    /// Whether it stops, or has stopped, before the motion's end.
    pub(crate) fn is_cut_short(&self) -> bool {
        self.braking.is_some() && self.at_s < self.motion.duration_s()
    }

    /// Time along the motion, in s.
    pub(crate) fn at_s(&self) -> f64 {
        self.at_s.min(self.motion.duration_s())
    }

    /// How long the motion takes, in s.
    pub(crate) fn duration_s(&self) -> f64 {
        self.motion.duration_s()
    }
}
