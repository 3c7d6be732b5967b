//! The change of the path parameter from s to sigma.

/// First to third derivative of s by sigma in rad, from sigma and its derivatives by s in units of `unit_rad`.
pub(crate) fn by_sigma([_, p, r, w]: [f64; 4], unit_rad: f64) -> [f64; 3] {
    let one = 1.0 / (p * unit_rad);
    let two = -r * one * one / p;
    let three = (3.0 * r * r - p * w) * one * one * one / (p * p);
    [one, two, three]
}

/// The s in [0, 1] at which `sigma`, which rises, has a value, starting from `s`.
pub(crate) fn newton(sigma: impl Fn(f64) -> [f64; 4], value: f64, mut s: f64) -> f64 {
    for _ in 0..NEWTON_STEPS {
        let [at, slope, ..] = sigma(s);
        let step = (at - value) / slope;
        s = (s - step).clamp(0.0, 1.0);
        if step.abs() < 1e-15 {
            break;
        }
    }
    s
}

/// Blends take two to four.
const NEWTON_STEPS: usize = 20;
