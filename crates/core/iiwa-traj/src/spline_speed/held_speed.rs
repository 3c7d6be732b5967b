//! Speeds that are held around minima.

/// Largest speed by sigma along the way from rest to rest: the limits at some points, each minimum
/// of which is held for a time.
#[derive(Debug)]
pub(super) struct HeldSpeed {
    /// Points by sigma from the previous rest, in rad, and the largest speed of y there.
    places: Vec<[f64; 2]>,
}

impl HeldSpeed {
    /// Holds each speed for `hold_s` seconds, half of the time before its point and half after;
    /// `places` are sigma in rad and, there, the speeds of y and of sigma.
    pub(super) fn new(places: &[[f64; 3]], hold_s: f64) -> Self {
        let mut points: Vec<[f64; 2]> = places.iter().map(|[sigma, y, _]| [*sigma, *y]).collect();
        for (k, [sigma, y, rate]) in places.iter().enumerate() {
            let reach = 0.5 * hold_s * rate;
            let mut hold = |place: &mut [f64; 2]| {
                let is_near = (place[0] - sigma).abs() <= reach;
                if is_near {
                    place[1] = place[1].min(*y);
                }
                is_near
            };
            let (before, from) = points.split_at_mut(k);
            // `all` ends at the first point out of reach.
            let _ = before.iter_mut().rev().all(&mut hold);
            let _ = from.iter_mut().all(&mut hold);
        }
        Self { places: points }
    }

    /// Returns the speed of y at a sigma: linear between points.
    pub(super) fn at(&self, sigma: f64) -> f64 {
        let next = self.places.partition_point(|[place, _]| *place <= sigma);
        let next = next.clamp(1, self.places.len() - 1);
        let ([from, slow], [to, fast]) = (self.places[next - 1], self.places[next]);
        // Adjacent segments have a point at the same sigma.
        let share = if to > from { ((sigma - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        slow + share * (fast - slow)
    }
}
