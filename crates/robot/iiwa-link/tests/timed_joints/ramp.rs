//! Motions in closed form.

use iiwa_link::TimedJoints;

/// A motion by `angle_rad` with given peak velocity, acceleration and jerk, in seven phases of
/// constant jerk, in closed form.
pub(crate) struct Ramp {
    angle_rad: f64,
    jerk: f64,
    /// Durations of constant jerk, constant acceleration and constant velocity, in s.
    phases_s: [f64; 3],
}

impl Ramp {
    pub(crate) fn new(angle_rad: f64, speed: f64, acceleration: f64, jerk: f64) -> Self {
        let jerks_s = acceleration / jerk;
        let ramp_s = speed / acceleration;
        let cruise_s = angle_rad / speed - ramp_s - jerks_s;
        let phases_s = [jerks_s, ramp_s - jerks_s, cruise_s];
        assert!(phases_s.iter().all(|phase_s| *phase_s > 0.0), "{phases_s:?}");
        Self { angle_rad, jerk, phases_s }
    }

    pub(crate) fn duration_s(&self) -> f64 {
        let [jerks_s, ramp_s, cruise_s] = self.phases_s;
        4.0 * jerks_s + 2.0 * ramp_s + cruise_s
    }

    pub(crate) fn at(&self, t_s: f64) -> f64 {
        let [jerks_s, ramp_s, cruise_s] = self.phases_s;
        // The second half mirrors the first one.
        let whole_s = self.duration_s();
        if t_s > whole_s / 2.0 {
            return self.angle_rad - self.at(whole_s - t_s);
        }
        let (mut q, mut dq, mut ddq, mut left_s) = (0.0, 0.0, 0.0, t_s.max(0.0));
        for (phase_s, jerk) in
            [(jerks_s, self.jerk), (ramp_s, 0.0), (jerks_s, -self.jerk), (cruise_s, 0.0)]
        {
            let dt = left_s.min(phase_s);
            q += dt * (dq + dt * (ddq / 2.0 + dt * jerk / 6.0));
            dq += dt * (ddq + dt * jerk / 2.0);
            ddq += dt * jerk;
            left_s -= dt;
        }
        q
    }

    /// Samples a motion of joint `joint`; the other joints are at rest.
    pub(crate) fn sampled(&self, joint: usize, step_s: f64) -> TimedJoints {
        let count = (self.duration_s() / step_s).ceil() as u32;
        let t_s: Vec<_> = (0..=count).map(|i| f64::from(i) * step_s).collect();
        let point = |t_s: &f64| {
            let mut q = [0.0; 7];
            q[joint] = self.at(*t_s);
            q
        };
        let joints_rad = t_s.iter().map(point).collect();
        TimedJoints { t_s, joints_rad }
    }
}
