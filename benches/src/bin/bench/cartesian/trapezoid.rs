//! Path parameter with a trapezoidal speed profile, from rest to rest.

/// Profile of s from 0 to 1: the speed rises linearly, is constant, and falls like it rose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trapezoid {
    /// Duration of the ramp, at most half of the total, in s.
    ramp_s: f64,
    duration_s: f64,
}

impl Trapezoid {
    /// Returns the fastest profile within bounds on ds/dt and d2s/dt2; a triangle if the speed is
    /// not reached.
    pub(crate) fn within(speed: f64, acceleration: f64) -> Self {
        let ramp_s = (speed / acceleration).min(acceleration.sqrt().recip());
        let top = acceleration * ramp_s;
        Self { ramp_s, duration_s: top.recip() + ramp_s }
    }

    /// Returns a profile whose ramp is a `share` of its duration, up to 0.5.
    pub(crate) fn with_ramp(share: f64, duration_s: f64) -> Self {
        Self { ramp_s: share * duration_s, duration_s }
    }

    pub(crate) fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Returns s at a time: 0 before its start, 1 after its end.
    pub(crate) fn s(&self, t_s: f64) -> f64 {
        let Self { ramp_s, duration_s } = *self;
        let t_s = t_s.clamp(0.0, duration_s);
        let top = (duration_s - ramp_s).recip();
        let risen = |t_s: f64| 0.5 * top * t_s * t_s / ramp_s;
        if t_s < ramp_s {
            risen(t_s)
        } else if t_s > duration_s - ramp_s {
            1.0 - risen(duration_s - t_s)
        } else {
            top * (t_s - 0.5 * ramp_s)
        }
    }
}
