//! Identified kappa over gamma, beside the model's.

use iiwa_eval::identify::Kappa;
use plotters::prelude::SeriesLabelPosition;

use super::plot::{Plot, PlotPoint};
use crate::picture::{COLOURS, MEASURED, PLANNED};

/// Plots kappa of each blend, the fitted polynomial and the model's polynomial; and the difference
/// from the model. The two texts are labels of the model and the difference.
pub(super) fn kappa_plots(
    kappa: &Kappa,
    observed: Vec<PlotPoint>,
    model: impl Fn(f64) -> f64,
    [words_of_model, words_of_difference]: [&str; 2],
) -> [Plot; 2] {
    let angles = || (0..=90).map(|i| 2.0 * f64::from(i));
    let limits_at = |edge: f64| {
        let point = |gamma| (gamma, kappa.at(gamma).value + edge * kappa.at(gamma).uncertainty);
        angles().map(point).collect::<Vec<PlotPoint>>()
    };
    let of_model: Vec<PlotPoint> = angles().map(|gamma| (gamma, model(gamma))).collect();
    let off: Vec<PlotPoint> =
        observed.iter().map(|(gamma, value)| (*gamma, value - model(*gamma))).collect();
    let zero = |edge: f64| {
        limits_at(edge).into_iter().map(|(gamma, k)| (gamma, k - model(gamma))).collect()
    };
    let (low, high): (Vec<PlotPoint>, Vec<PlotPoint>) = (zero(-1.0), zero(1.0));
    [
        Plot::new("kappa over gamma", "gamma deg", "kappa")
            .line(of_model, PLANNED, 4.0, words_of_model)
            .line(limits_at(0.0), COLOURS[1], 1.5, "polynomial found")
            .dots(observed, MEASURED, "observed")
            .legend_at(SeriesLabelPosition::UpperLeft),
        Plot::new("the same minus the model's", "gamma deg", words_of_difference)
            .band(&low, &high, COLOURS[1], "polynomial found, 95 %")
            .line(angles().map(|gamma| (gamma, 0.0)).collect(), PLANNED, 1.0, "")
            .dots(off, MEASURED, "observed"),
    ]
}
