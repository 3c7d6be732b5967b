//! Noise of measurement.

use fastrand_contrib::RngExt;

/// Normally distributed numbers: the same ones in each run.
#[derive(Clone, Debug)]
pub(super) struct Noise {
    deviation: f64,
    random: fastrand::Rng,
}

impl Noise {
    /// With this standard deviation.
    pub(super) fn new(deviation: f64) -> Self {
        Self { deviation, random: fastrand::Rng::with_seed(1) }
    }

    /// The next number.
    pub(super) fn next(&mut self) -> f64 {
        if self.deviation == 0.0 { 0.0 } else { self.random.f64_normal(0.0, self.deviation) }
    }
}
