//! A path parameter with a trapezoid of a speed, from rest to rest.

/// s from 0 to 1: its speed rises evenly, stays, and falls as it rose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trapezoid {
    /// How long the speed rises, at most half of the duration, in s.
    ramp_s: f64,
    duration_s: f64,
}

impl Trapezoid {
    /// The fastest one with ds/dt and d2s/dt2 up to these; a triangle if the speed is not reached.
    pub(crate) fn within(speed: f64, acceleration: f64) -> Self {
        let ramp_s = (speed / acceleration).min(acceleration.sqrt().recip());
        let top = acceleration * ramp_s;
        Self { ramp_s, duration_s: top.recip() + ramp_s }
    }

    /// One whose speed rises for a `share` of its duration, up to 0.5.
    pub(crate) fn with_ramp(share: f64, duration_s: f64) -> Self {
        Self { ramp_s: share * duration_s, duration_s }
    }

    pub(crate) fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// s at a time: 0 before its start, 1 after its end.
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
