//! Change of the path parameter from s to sigma.

/// First to third derivative of s by sigma in rad, from sigma and its derivatives by s in units of
/// `unit_rad`.
pub(crate) fn by_sigma([_, p, r, w]: [f64; 4], unit_rad: f64) -> [f64; 3] {
    let one = 1.0 / (p * unit_rad);
    let two = -r * one * one / p;
    let three = (3.0 * r * r - p * w) * one * one * one / (p * p);
    [one, two, three]
}

/// Returns the s in [0, 1] at which the increasing function `sigma` has a value, with the start
/// `s`.
///
/// Next to a much shorter neighbour, sigma is nearly flat and a Newton step overshoots far. The
/// bracket of the root bounds the steps; a step that leaves the bracket is replaced by bisection.
pub(crate) fn newton(sigma: impl Fn(f64) -> [f64; 4], value: f64, mut s: f64) -> f64 {
    let [mut low, mut high] = [0.0, 1.0];
    for _ in 0..NEWTON_STEPS {
        let [current, slope, ..] = sigma(s);
        if current < value {
            low = s;
        } else {
            high = s;
        }
        let next = s - (current - value) / slope;
        let next = if (low..=high).contains(&next) { next } else { f64::midpoint(low, high) };
        let step = next - s;
        s = next;
        if step.abs() < 1e-15 {
            break;
        }
    }
    s
}

/// Maximum number of steps. Blends take two to four; more if bisection is needed.
const NEWTON_STEPS: usize = 60;

#[cfg(test)]
mod tests {
    use super::*;

    /// Also between neighbours whose lengths differ a thousandfold and more.
    #[test]
    fn every_sigma_has_its_s() {
        // The integral of 1 + (ratio - 1) (3 s^2 - 2 s^3).
        for ratio in [1e-6, 1e-3, 0.1, 1.0, 30.0, 1e4] {
            let by = ratio - 1.0;
            let sigma = |s: f64| {
                [s + by * s * s * s * (1.0 - 0.5 * s), 1.0 + by * s * s * (3.0 - 2.0 * s), 0.0, 0.0]
            };
            let [end, ..] = sigma(1.0);
            for i in 0..=1_000 {
                let value = end * f64::from(i) / 1_000.0;
                let s = newton(sigma, value, (value / end).clamp(0.0, 1.0));
                let [actual, ..] = sigma(s);
                assert!((actual - value).abs() < 1e-14 * end, "{ratio} {i}: {actual} {value}");
            }
        }
    }
}
