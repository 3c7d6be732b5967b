//! Extrema of smooth curves from samples.

/// The largest magnitudes of three groups of `N` curves that are sampled at evenly spaced places, each where it is
/// sampled and where the parabola through three neighbouring samples has its vertex. What is not a number counts
/// as too much.
#[inline(always)]
pub(crate) fn peaks<const N: usize>(samples: impl Iterator<Item = [[f64; N]; 3]>) -> [f64; 3] {
    let mut largest = [[0.0; N]; 3];
    let mut before = None;
    for next in samples {
        for i in 0..3 {
            for j in 0..N {
                largest[i][j] = larger(largest[i][j], next[i][j].abs());
            }
        }
        if let Some((Some(first), middle)) = before {
            let (first, middle): ([[f64; N]; 3], [[f64; N]; 3]) = (first, middle);
            for i in 0..3 {
                for j in 0..N {
                    let vertex = vertex([first[i][j], middle[i][j], next[i][j]]);
                    largest[i][j] = larger(largest[i][j], vertex.abs());
                }
            }
        }
        before = Some((before.map(|(_, middle)| middle), next));
    }
    largest.map(|group| group.into_iter().fold(0.0, larger))
}

/// The extremum of the parabola through three values, or the middle one if it has none between the others.
#[inline(always)]
fn vertex([first, middle, last]: [f64; 3]) -> f64 {
    let slope = 0.5 * (last - first);
    let bend = last - 2.0 * middle + first;
    if slope.abs() < bend.abs() { middle - 0.5 * slope * slope / bend } else { middle }
}

/// The larger one, or the one that is not a number.
#[inline(always)]
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn are_found_between_samples_and_at_ends() {
        let curve = |x: f64| [[1.0 - (x - 0.3).powi(2), x], [-x * x, 0.0], [0.0, f64::NAN]];
        let [a, b, c] = peaks((0..=4).map(|i| curve(f64::from(i) / 4.0)));
        assert!((a - 1.0).abs() < 1e-15 && b == 1.0 && c.is_nan());
        // Two samples have no parabola.
        assert_eq!(
            peaks([[[1.0], [2.0], [3.0]], [[-4.0], [1.0], [0.0]]].into_iter()),
            [4.0, 2.0, 3.0]
        );
    }
}
