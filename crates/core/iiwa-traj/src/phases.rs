//! Motion from rest to rest along a straight line under limits of speed, acceleration and jerk: the
//! profile of at most seven phases, in closed form.

use crate::interval::Node;

/// State between two phases of the profile. Lengths are in the unit of the line's parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ProfilePoint {
    pub(crate) t_s: f64,
    pub(crate) way: f64,
    pub(crate) speed: f64,
    pub(crate) acceleration: f64,
    /// Duration and way of the phase that begins here, without rounding by preceding phases.
    pub(crate) phase_s: f64,
    pub(crate) phase_way: f64,
}

impl ProfilePoint {
    /// Returns the way within a time `dt` of constant jerk.
    pub(crate) fn way_in(&self, dt: f64, jerk: f64) -> f64 {
        dt * (self.speed + dt * (self.acceleration / 2.0 + dt * jerk / 6.0))
    }

    /// Returns the state after a time `dt` of constant jerk.
    pub(crate) fn after(&self, dt: f64, jerk: f64) -> Self {
        Self {
            t_s: self.t_s + dt,
            way: self.way + self.way_in(dt, jerk),
            speed: self.speed + dt * (self.acceleration + dt * jerk / 2.0),
            acceleration: self.acceleration + dt * jerk,
            ..Self::default()
        }
    }

    /// Converts the state to the node of a segment whose sigma has this `length`.
    pub(crate) fn node(&self, length: f64) -> Node {
        Node {
            t_s: self.t_s,
            dt_s: self.phase_s,
            p: self.way / length,
            dp: self.phase_way / length,
            rate: self.speed / length,
            u: [self.acceleration / length; 2],
        }
    }
}

/// Returns the instants between the phases of constant jerk, including start and end; phases
/// without duration are dropped.
///
/// Three cases, by active limits: jerk alone, jerk and acceleration, and all three.
pub(crate) fn phases(way: f64, [speed, acceleration, jerk]: [f64; 3]) -> Vec<ProfilePoint> {
    // Half of the profile: positive jerk for `ramp`, constant acceleration for `push`, negative
    // jerk for `ramp`, then half of the cruise.
    let full = acceleration / jerk;
    // Way of acceleration and deceleration without a cruise, for the top speed `v`.
    let way_to = |v: f64| {
        if v * jerk >= acceleration * acceleration {
            v * (v / acceleration + full)
        } else {
            2.0 * v * (v / jerk).sqrt()
        }
    };
    let (ramp, push, cruise) = if way_to(speed) <= way {
        let (ramp, push) = if speed * jerk >= acceleration * acceleration {
            (full, speed / acceleration - full)
        } else {
            ((speed / jerk).sqrt(), 0.0)
        };
        (ramp, push, (way - way_to(speed)) / speed)
    } else if way >= 2.0 * acceleration * full * full {
        // v (v / a + full) = way with v = a (full + push) gives a (full + push) (2 full + push) =
        // way. The root is written without cancellation.
        let push = 2.0 * (way / acceleration - 2.0 * full * full)
            / (3.0 * full + (full * full + 4.0 * way / acceleration).sqrt());
        (full, push, 0.0)
    } else {
        ((0.5 * way / jerk).cbrt(), 0.0, 0.0)
    };
    let mut point = ProfilePoint::default();
    let mut instants = vec![point];
    let durations = [ramp, push, ramp, cruise, ramp, push, ramp];
    let jerks = [1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0].map(|sign| sign * jerk);
    for (t, jerk) in std::iter::zip(durations, jerks) {
        if t > 0.0 {
            let phase_way = point.way_in(t, jerk);
            if let Some(last) = instants.last_mut() {
                (last.phase_s, last.phase_way) = (t, phase_way);
            }
            point = point.after(t, jerk);
            instants.push(point);
        }
    }
    // The end is set to the exact way and to rest, without rounding.
    if let Some(last) = instants.last_mut() {
        *last = ProfilePoint { t_s: last.t_s, way, ..ProfilePoint::default() };
    }
    instants
}

#[cfg(test)]
mod tests {
    use super::*;

    fn duration(way: f64, limits: [f64; 3]) -> f64 {
        phases(way, limits).last().unwrap().t_s
    }

    #[test]
    fn joint_1_at_full_speed() {
        // Limits of Larsen 2019, Tables 2 and 5, in degrees.
        let actual = duration(40.0, [98.0, 490.0, 10384.86]);
        let expected = 40.0 / 98.0 + 98.0 / 490.0 + 490.0 / 10384.86;
        assert!((actual / expected - 1.0).abs() < 1e-14);
        assert!((actual - 0.655_347).abs() < 1e-6);
    }

    #[test]
    fn each_limit_may_be_out_of_reach() {
        // Jerk alone: four phases of (way / 2 / jerk)^(1/3).
        assert!((duration(2.0, [1e9, 1e9, 1.0]) - 4.0).abs() < 1e-14);
        assert_eq!(phases(2.0, [1e9, 1e9, 1.0]).len(), 5);
        // Jerk and speed: two phases of 1 s reach speed 1.
        assert!((duration(5.0, [1.0, 1e9, 1.0]) - 7.0).abs() < 1e-14);
        assert_eq!(phases(5.0, [1.0, 1e9, 1.0]).len(), 6);
        // Jerk and acceleration: (1 + p) (2 + p) = 12 has p = 2.
        assert!((duration(12.0, [1e9, 1.0, 1.0]) - 8.0).abs() < 1e-14);
        assert_eq!(phases(12.0, [1e9, 1.0, 1.0]).len(), 7);
        // All three.
        assert_eq!(phases(100.0, [4.0, 1.0, 1.0]).len(), 8);
    }

    /// The phases join, end at rest at the end of the way, and keep the limits.
    #[test]
    fn phases_join() {
        for way in [1e-9, 1e-3, 0.1, 1.0, 3.0, 100.0] {
            for limits in [[1.0, 1.0, 1.0], [1.0, 10.0, 1.0], [1.0, 0.1, 10.0], [10.0, 1.0, 100.0]]
            {
                let instants = phases(way, limits);
                for instant in &instants {
                    assert!(instant.speed >= 0.0 && instant.speed <= limits[0] * (1.0 + 1e-12));
                    assert!(instant.acceleration.abs() <= limits[1] * (1.0 + 1e-12));
                }
                for pair in instants.windows(2) {
                    let t = pair[1].t_s - pair[0].t_s;
                    let jerk = (pair[1].acceleration - pair[0].acceleration) / t;
                    assert!(jerk.abs() <= limits[2] * (1.0 + 1e-9));
                    let end = pair[0].way
                        + t * (pair[0].speed + t * (pair[0].acceleration / 2.0 + t * jerk / 6.0));
                    assert!((end - pair[1].way).abs() < 1e-12 * way, "{way} {limits:?}");
                }
            }
        }
    }
}
