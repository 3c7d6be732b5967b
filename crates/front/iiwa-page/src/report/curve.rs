//! Curves of the seven joints, or of one number, reduced for the screen.

use serde::Serialize;

use crate::arm_look::Packed;

/// Maximum number of columns of a curve: more than any screen has, to allow zooming.
const COLUMNS: usize = 8000;

/// Samples of `N` values over time, by default one per joint. Unknown values are NaN.
#[derive(Debug, Default)]
pub(crate) struct TimeSeries<const N: usize = 7> {
    pub(crate) t_s: Vec<f64>,
    pub(crate) rows: Vec<[f64; N]>,
}

impl<const N: usize> TimeSeries<N> {
    pub(crate) fn with_capacity(count: usize) -> Self {
        Self { t_s: Vec::with_capacity(count), rows: Vec::with_capacity(count) }
    }

    pub(crate) fn push(&mut self, t_s: f64, row: [f64; N]) {
        self.t_s.push(t_s);
        self.rows.push(row);
    }

    /// Interpolates the values linearly at increasing times.
    pub(crate) fn at_times(&self, times: &[f64]) -> impl ExactSizeIterator<Item = [f64; N]> {
        let mut next = 0;
        times.iter().map(move |at_s| {
            while next + 1 < self.t_s.len() && self.t_s[next] < *at_s {
                next += 1;
            }
            let last = next.saturating_sub(1);
            let [from_s, to_s] = [self.t_s[last], self.t_s[next]];
            let share = if to_s > from_s { (at_s - from_s) / (to_s - from_s) } else { 0.0 };
            let share = share.clamp(0.0, 1.0);
            let [from, to] = [&self.rows[last], &self.rows[next]];
            std::array::from_fn(|j| from[j] + share * (to[j] - from[j]))
        })
    }
}

/// Start time of each column, and the lowest and highest value until the next column, so that peaks
/// are preserved.
#[derive(Debug, Default, Serialize)]
pub(crate) struct CurveColumns {
    columns: usize,
    /// Number of samples per column: one without reduction.
    samples_a_column: usize,
    /// Times, one double per column.
    t_s: Packed,
    /// Lowest values, one single per column and value.
    low: Packed,
    /// Highest values, in the same format; `None` if a column is one sample.
    #[serde(skip_serializing_if = "Option::is_none")]
    high: Option<Packed>,
}

impl CurveColumns {
    /// Converts samples to a curve, all times shifted by `shift_s`.
    pub(crate) fn new<const N: usize>(samples: &TimeSeries<N>, shift_s: f64) -> Self {
        Self::with_columns(samples, shift_s, COLUMNS)
    }

    fn with_columns<const N: usize>(
        samples: &TimeSeries<N>,
        shift_s: f64,
        max_columns: usize,
    ) -> Self {
        let count = samples.rows.len().div_ceil(max_columns).max(1);
        let chunks = || samples.rows.chunks(count);
        // Numbers have priority over NaN.
        let fold = |pick: fn(f64, f64) -> f64| {
            chunks().flat_map(move |rows| {
                rows.iter()
                    .fold([f64::NAN; N], |a, row| std::array::from_fn(|j| pick(a[j], row[j])))
            })
        };
        Self {
            columns: chunks().count(),
            samples_a_column: count,
            t_s: Packed::doubles(samples.t_s.iter().step_by(count).map(|t_s| t_s + shift_s)),
            low: Packed::singles(fold(f64::min)),
            high: (count > 1).then(|| Packed::singles(fold(f64::max))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_are_kept() {
        let mut samples = TimeSeries::<7>::default();
        for i in 0..1000_u32 {
            let mut row = [f64::NAN; 7];
            row[0] = if i == 777 { 5.0 } else { 0.0 };
            row[1] = if i == 333 { -5.0 } else { 0.0 };
            samples.push(f64::from(i), row);
        }
        let curve = CurveColumns::with_columns(&samples, 0.5, 10);
        let expected = |low: bool| {
            let value = |column: usize, j: usize| match (low, column, j) {
                (true, 3, 1) => -5.0,
                (false, 7, 0) => 5.0,
                (_, _, 0 | 1) => 0.0,
                _ => f64::NAN,
            };
            Packed::singles(
                (0..10)
                    .flat_map(|column| (0..7).map(move |j| (column, j)))
                    .map(|(column, j)| value(column, j)),
            )
        };
        let text = |packed: &Packed| serde_json::to_string(packed).unwrap();
        assert_eq!((curve.columns, curve.samples_a_column), (10, 100));
        assert_eq!(text(&curve.low), text(&expected(true)));
        assert_eq!(text(&curve.high.unwrap()), text(&expected(false)));
        let t_s = Packed::doubles((0..10).map(|i| f64::from(i) * 100.0 + 0.5));
        assert_eq!(text(&curve.t_s), text(&t_s));
    }

    #[test]
    fn values_are_even_between_samples() {
        let samples = TimeSeries { t_s: vec![0.0, 1.0, 3.0], rows: vec![[0.0], [1.0], [-1.0]] };
        let values = |times: &[f64]| samples.at_times(times).map(|[v]| v).collect::<Vec<_>>();
        assert_eq!(values(&[-1.0, 0.0, 0.25, 1.0, 2.5, 4.0]), [0.0, 0.0, 0.25, 1.0, -0.5, -1.0]);
        assert_eq!(values(&[2.0]), [0.0]);
    }

    #[test]
    fn short_curves_are_whole() {
        let samples = TimeSeries { t_s: vec![0.0, 1.0], rows: vec![[1.0; 7], [2.0; 7]] };
        let curve = CurveColumns::new(&samples, 0.0);
        assert_eq!((curve.columns, curve.samples_a_column), (2, 1));
        assert!(curve.high.is_none());
    }
}
