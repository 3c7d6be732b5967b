//! Laws of a start from standstill: time as a function of the way.
//!
//! | acceleration | way |
//! |---|---|
//! | with constant jerk, then constant | t^3, then t^2: plans with jerk limits |
//! | with constant snap, then slower | t^4, then t^3: an LBR iiwa under Sunrise, see [`RampLaw`](iiwa_kin::RampLaw) |

/// Law of a start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StartLaw {
    /// `true` if the jerk grows from 0; `false` if it begins with its constant value.
    is_soft: bool,
    /// Way at the end of the first phase, in rad.
    bend_rad: f64,
}

/// Candidates for the way at the end of the first phase, in rad: from a start with full
/// acceleration to one of which only the first phase is visible.
const BENDS_RAD: [f64; 18] = [
    1e-9, 3e-6, 1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 3e-4, 5e-4, 8e-4, 1.3e-3, 2e-3, 3e-3, 5e-3, 8e-3,
    1.3e-2, 2e-2, 1.0,
];

/// Way in rad below which friction hides the first phase.
const SEEN_RAD: f64 = 1e-3;

/// Jerk after a phase of constant snap, as a share of the jerk at its end. Measured: 0.06 to 0.61.
const JERK_SHARE: f64 = 0.35;

impl StartLaw {
    /// Returns the candidate laws, soft or not; with `seen` only those whose first phase is visible
    /// on a robot that does not track exactly: friction hides a short one.
    pub(super) fn all(is_soft: bool, seen: bool) -> impl Iterator<Item = Self> {
        let all = BENDS_RAD.into_iter().map(move |bend_rad| Self { is_soft, bend_rad });
        all.filter(move |law| !seen || law.bend_rad >= SEEN_RAD)
    }

    /// Returns the time for a way from standstill, in units of the time to the end of the first
    /// phase, and the speed there, in rad per unit.
    pub(super) fn time(self, way_rad: f64) -> (f64, f64) {
        let y = way_rad / self.bend_rad;
        let (tau, slope) = match (self.is_soft, y <= 1.0) {
            // y = tau^3
            (false, true) => (y.cbrt(), 3.0 * y.cbrt().powi(2)),
            (false, false) => {
                // y = tau^3 - (tau - 1)^3
                let tau = 0.5 + (12.0 * y - 3.0).sqrt() / 6.0;
                (tau, 3.0 * (2.0 * tau - 1.0))
            }
            // y = tau^4
            (true, true) => (y.sqrt().sqrt(), 4.0 * y.powf(0.75)),
            (true, false) => after_snap(y),
        };
        (tau, self.bend_rad * slope)
    }
}

/// Returns the time for the way `y` (1 at the end of the phase of constant snap) and the slope: y =
/// 1 + 4 x + 6 x^2 + 4 share x^3 for tau = 1 + x.
fn after_snap(y: f64) -> (f64, f64) {
    let slope = |x: f64| 4.0 + x * (12.0 + 12.0 * JERK_SHARE * x);
    // The start value without the cubic term is above the root, so that Newton's method descends to
    // the root.
    let mut x = ((16.0 + 24.0 * (y - 1.0)).sqrt() - 4.0) / 12.0;
    for _ in 0..40 {
        let step = (1.0 + x * (4.0 + x * (6.0 + 4.0 * JERK_SHARE * x)) - y) / slope(x);
        x -= step;
        if step.abs() <= 1e-14 * x.abs() {
            break;
        }
    }
    (1.0 + x, slope(x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_have_their_powers_and_no_steps() {
        for law in [false, true].into_iter().flat_map(|soft| StartLaw::all(soft, false)) {
            let at = |way: f64| law.time(way);
            let power = if law.is_soft { 0.25 } else { 1.0 / 3.0 };
            let early = law.bend_rad * 1e-4;
            assert!((at(16.0 * early).0 / at(early).0 - 16_f64.powf(power)).abs() < 1e-9);
            for i in -40..40 {
                let way = law.bend_rad * 10_f64.powf(f64::from(i) / 10.0);
                let step = 1e-6 * way;
                let (tau, speed) = at(way);
                let slope = 2.0 * step / (at(way + step).0 - at(way - step).0);
                assert!((slope / speed - 1.0).abs() < 1e-4, "{law:?} {way}");
                assert!(tau > 0.0);
            }
        }
    }
}
