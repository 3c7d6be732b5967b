//! Noise of measurement.

/// Normally distributed numbers: the same ones in each run.
#[derive(Clone, Debug)]
pub(super) struct Noise {
    deviation: f64,
    random: fastrand::Rng,
    spare: Option<f64>,
}

impl Noise {
    /// With this standard deviation.
    pub(super) fn new(deviation: f64) -> Self {
        Self { deviation, random: fastrand::Rng::with_seed(1), spare: None }
    }

    /// The next number (Box and Muller 1958).
    pub(super) fn next(&mut self) -> f64 {
        if self.deviation == 0.0 {
            return 0.0;
        }
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let radius = self.deviation * (-2.0 * (1.0 - self.random.f64()).ln()).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * self.random.f64()).sin_cos();
        self.spare = Some(radius * sin);
        radius * cos
    }
}
