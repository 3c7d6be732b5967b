//! Measurement noise.

use fastrand_contrib::RngExt;

/// Normally distributed numbers from a seed.
#[derive(Clone, Debug)]
pub(crate) struct Noise {
    deviation: f64,
    random: fastrand::Rng,
}

impl Noise {
    /// Creates noise with a standard deviation.
    pub(crate) fn new(deviation: f64, seed: u64) -> Self {
        Self { deviation, random: fastrand::Rng::with_seed(seed) }
    }

    /// Returns the next number.
    pub(crate) fn next(&mut self) -> f64 {
        if self.deviation == 0.0 { 0.0 } else { self.random.f64_normal(0.0, self.deviation) }
    }
}
