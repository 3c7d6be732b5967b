//! Sampling density of a polyline along its length: as sparse as its corners allow.

/// Maximum slope of the spacing: neighbouring distances differ by at most this share of the arc
/// length in between.
const GRADE: f64 = 0.25;

/// Desired distances between samples, at places along the path; linear in between.
#[derive(Clone, Debug)]
pub(super) struct Spacing {
    /// Arc lengths from 0 to the total length, increasing.
    places: Vec<f64>,
    distances: Vec<f64>,
    /// Indices of the polyline points among the places.
    points: Vec<usize>,
}

/// Number of places per polyline segment, including its first point: in between, the distance may
/// be larger than at both ends.
const BETWEEN: usize = 4;

impl Spacing {
    /// Creates a uniform distance on a path with points at these arc lengths.
    pub(super) fn even(ways: &[f64], distance: f64) -> Self {
        let mut places = Vec::with_capacity(BETWEEN * ways.len());
        for two in ways.windows(2) {
            let way = two[1] - two[0];
            places.extend((0..BETWEEN).map(|k| two[0] + way * k as f64 / BETWEEN as f64));
        }
        places.extend(ways.last());
        let points = (0..ways.len()).map(|i| i * BETWEEN).collect();
        Self { distances: vec![distance; places.len()], places, points }
    }

    /// Halves the distance at a point, but not below `min_distance`. Returns true if the distance
    /// was reduced.
    pub(super) fn halve(&mut self, point: usize, min_distance: f64) -> bool {
        let distance = &mut self.distances[self.points[point]];
        let halved = (0.5 * *distance).max(min_distance);
        let smaller = halved < *distance;
        *distance = halved;
        smaller
    }

    /// Reduces distances until the slope of the spacing is within [`GRADE`].
    pub(super) fn grade(&mut self) {
        let count = self.places.len();
        for i in 1..count {
            let way = self.places[i] - self.places[i - 1];
            self.distances[i] = self.distances[i].min(self.distances[i - 1] + GRADE * way);
        }
        for i in (1..count).rev() {
            let way = self.places[i] - self.places[i - 1];
            self.distances[i - 1] = self.distances[i - 1].min(self.distances[i] + GRADE * way);
        }
    }

    /// Returns samples from the first place to the last, with approximately the desired distances;
    /// at least `min_count` steps.
    pub(super) fn samples(&self, min_count: usize) -> Vec<f64> {
        // Steps up to each place: the integral of 1 over the distance, which is linear in between.
        let mut steps = vec![0.0];
        for i in 1..self.places.len() {
            let way = self.places[i] - self.places[i - 1];
            let (a, b) = self.distances_between(i);
            let ratio = b / a;
            // Limit of the logarithm for equal distances.
            let mean = if (ratio - 1.0).abs() < 1e-6 { a } else { (b - a) / ratio.ln() };
            steps.push(steps[i - 1] + way / mean);
        }
        let all = steps.last().copied().unwrap_or_default();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a number of samples"
        )]
        let count = (all.ceil() as usize).max(min_count);
        let mut i = 1;
        (0..=count)
            .map(|k| {
                let step = all * k as f64 / count as f64;
                while i + 1 < steps.len() && steps[i] < step {
                    i += 1;
                }
                self.place_at(i, step - steps[i - 1])
            })
            .collect()
    }

    fn distances_between(&self, i: usize) -> (f64, f64) {
        (self.distances[i - 1], self.distances[i])
    }

    /// Returns the arc length after a number of steps from place `i - 1`, clamped to place `i`.
    fn place_at(&self, i: usize, steps: f64) -> f64 {
        let way = self.places[i] - self.places[i - 1];
        let (a, b) = self.distances_between(i);
        let slope = (b - a) / way;
        let distance = if (slope * steps).abs() < 1e-9 {
            a * steps
        } else {
            a * (slope * steps).exp_m1() / slope
        };
        self.places[i - 1] + distance.clamp(0.0, way)
    }
}
