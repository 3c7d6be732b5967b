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
/// path's own acceleration is down to a quarter there. Together they are at most 1.24 times the limits
/// of acceleration, if both are at their limits just where the stop begins.
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

#[cfg(test)]
mod tests {
    use iiwa_kin::Robot;
    use iiwa_path::{Blend, JointPath, Motion as Entry, Program, Ptp};
    use iiwa_traj::{Timing, Trajectory};

    use super::*;

    fn planned() -> Trajectory {
        let targets = [
            [0.8, 0.5, 0.0, -1.0, 0.4, 0.9, -1.0],
            [0.2, 1.0, 0.6, -0.4, -0.8, -0.5, 1.5],
            [-0.9, 0.2, -0.4, -1.5, 0.0, 1.2, 0.0],
        ];
        let mut motions: Vec<_> =
            targets.map(|target| Ptp::to(target).blend(Blend::Fraction(0.3))).into();
        motions[2].blend = None;
        let motions = motions.into_iter().map(Entry::Ptp).collect();
        let program = Program { robot: None, start_rad: [0.0; 7], motions };
        let path = JointPath::new(&program, &Robot::default()).unwrap();
        Trajectory::plan(&path, Timing::default()).unwrap()
    }

    /// Wherever the arm is stopped, it stays on its path and keeps its limits of speed; of acceleration
    /// it does not need much more.
    #[test]
    fn a_stop_keeps_to_path_and_limits() {
        const DT_S: f64 = 0.001;
        let plan = planned();
        let limits = *Robot::default().limits();
        let mut worst = [0.0_f64; 2];
        for tenth in 0..200 {
            let at_s = f64::from(tenth) / 200.0 * plan.cycle_time_s();
            let mut playback = Playback::new(plan.clone());
            playback.advance(at_s);
            let mut q = vec![playback.position(); 2];
            playback.stop(STOP_S);
            let mut cycles = 0;
            while !playback.is_over() {
                playback.advance(DT_S);
                q.push(playback.position());
                cycles += 1;
            }
            assert!(f64::from(cycles) * DT_S <= STOP_S + DT_S);
            assert_eq!(q.last(), Some(&plan.at(playback.at_s()).q));
            q.extend_from_within(q.len() - 1..);
            for three in q[2..].windows(3) {
                let [a, b, c] = [three[0], three[1], three[2]];
                for (j, b) in b.iter().enumerate() {
                    let speed = (b - a[j]).abs() / DT_S;
                    let bend = (c[j] - 2.0 * b + a[j]).abs() / DT_S / DT_S;
                    worst[0] = worst[0].max(speed / limits.velocity_rad_s[j]);
                    worst[1] = worst[1].max(bend / limits.acceleration_rad_s2[j]);
                }
            }
        }
        assert!(worst[0] < 1.01 && worst[1] < 1.24, "{worst:?}");
    }
}
