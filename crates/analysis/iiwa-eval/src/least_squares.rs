//! Least-squares fit of a model with few parameters to many samples.

use nalgebra::{SMatrix, SVector};

/// Model with `N` parameters. Samples are visited one by one, so that residuals need no memory.
pub(crate) trait FitModel<const N: usize> {
    /// Calls `each` for every sample with its residual (observed minus model) and the derivatives
    /// of the model with respect to its parameters.
    fn samples(&self, parameters: &[f64; N], each: impl FnMut(f64, [f64; N]));

    /// Returns the lower bound of each parameter.
    fn lower_bounds(&self) -> [f64; N] {
        [f64::NEG_INFINITY; N]
    }
}

/// Result of a fit.
#[derive(Clone, Debug)]
pub(crate) struct Fit<const N: usize> {
    pub(crate) parameters: [f64; N],
    /// Covariance of the parameters, from the scatter of the residuals; zero for fixed parameters.
    pub(crate) covariance: SMatrix<f64, N, N>,
    /// Sum of squared residuals.
    pub(crate) squares: f64,
    /// Root mean square of the residuals.
    pub(crate) residual: f64,
}

impl<const N: usize> Fit<N> {
    /// Returns the standard deviation of a parameter.
    pub(crate) fn deviation(&self, parameter: usize) -> f64 {
        self.covariance[(parameter, parameter)].max(0.0).sqrt()
    }

    /// Returns the standard deviation of a function of the parameters.
    pub(crate) fn deviation_of(&self, function: impl Fn(&[f64; N]) -> f64) -> f64 {
        let gradient = SVector::<f64, N>::from_fn(|i, _| {
            let step = self.deviation(i) * 1e-2;
            if step == 0.0 {
                return 0.0;
            }
            let at = |step: f64| {
                let mut parameters = self.parameters;
                parameters[i] += step;
                function(&parameters)
            };
            (at(step) - at(-step)) / (2.0 * step)
        });
        gradient.dot(&(self.covariance * gradient)).max(0.0).sqrt()
    }
}

/// Removes a parameter from the equations.
fn hold<const N: usize>(normal: &mut SMatrix<f64, N, N>, parameter: usize) {
    normal.row_mut(parameter).fill(0.0);
    normal.column_mut(parameter).fill(0.0);
    normal[(parameter, parameter)] = 1.0;
}

/// Sums over all samples.
#[derive(Clone)]
struct NormalSums<const N: usize> {
    normal: SMatrix<f64, N, N>,
    gradient: SVector<f64, N>,
    squares: f64,
    count: usize,
}

impl<const N: usize> NormalSums<N> {
    fn of(model: &impl FitModel<N>, parameters: &[f64; N]) -> Self {
        let mut sums =
            Self { normal: SMatrix::zeros(), gradient: SVector::zeros(), squares: 0.0, count: 0 };
        model.samples(parameters, |residual, derivatives| {
            let derivatives = SVector::from(derivatives);
            sums.normal.ger(1.0, &derivatives, &derivatives, 1.0);
            sums.gradient.axpy(residual, &derivatives, 1.0);
            sums.squares += residual * residual;
            sums.count += 1;
        });
        sums
    }

    /// Fixes some parameters at their present values.
    fn hold(mut self, held: &[bool; N]) -> Self {
        for i in (0..N).filter(|&i| held[i]) {
            hold(&mut self.normal, i);
            self.gradient[i] = 0.0;
        }
        self
    }

    /// Returns the damped Gauss-Newton step. Parameters that would exceed their bounds are set to
    /// the bounds, and the step of the others is optimal for these values.
    fn step(
        &self,
        parameters: &[f64; N],
        lower_bounds: &[f64; N],
        damping: f64,
    ) -> Option<SVector<f64, N>> {
        let mut bound: [Option<f64>; N] = [None; N];
        loop {
            let mut normal = self.normal;
            let mut gradient = self.gradient;
            for i in 0..N {
                normal[(i, i)] *= 1.0 + damping;
            }
            let bounded = || bound.iter().enumerate().filter_map(|(i, step)| Some((i, (*step)?)));
            for (i, step) in bounded() {
                gradient.axpy(-step, &normal.column(i), 1.0);
            }
            for (i, step) in bounded() {
                hold(&mut normal, i);
                gradient[i] = step;
            }
            let step = normal.cholesky()?.solve(&gradient);
            let beyond =
                (0..N).find(|&i| bound[i].is_none() && parameters[i] + step[i] < lower_bounds[i]);
            match beyond {
                Some(i) => bound[i] = Some(lower_bounds[i] - parameters[i]),
                None => return Some(step),
            }
        }
    }
}

/// Returns the factor by which the variance grows because residuals are correlated, as for an
/// imperfect model, so that several of them count as one: the factor of a first-order
/// autoregression, 1 for white noise.
fn dependence<const N: usize>(
    model: &impl FitModel<N>,
    parameters: &[f64; N],
    squares: f64,
    count: usize,
) -> f64 {
    let mut before = 0.0;
    let mut products = 0.0;
    model.samples(parameters, |residual, _| {
        products += before * residual;
        before = residual;
    });
    let correlation = products / squares.max(f64::MIN_POSITIVE);
    // White noise shows this correlation by chance.
    let count = count as f64;
    if correlation < 2.0 / count.sqrt() {
        return 1.0;
    }
    let correlation = correlation.min(1.0 - 2.0 / count);
    (1.0 + correlation) / (1.0 - correlation)
}

const MAX_STEPS: usize = 60;

/// Lower bound of the residual, in rad: some recorders store positions as 32-bit numbers.
const MIN_RESIDUAL: f64 = 1e-9;

/// Fits by least squares with the method of Levenberg and Marquardt, with some parameters fixed;
/// none with too few samples, or if the samples do not determine the parameters.
pub(crate) fn fit<const N: usize>(
    model: &impl FitModel<N>,
    start: [f64; N],
    held: [bool; N],
) -> Option<Fit<N>> {
    let mut parameters = start;
    let mut damping = 1e-4;
    let mut sums = NormalSums::of(model, &parameters).hold(&held);
    let lower_bounds = model.lower_bounds();
    for _ in 0..MAX_STEPS {
        let next = sums.step(&parameters, &lower_bounds, damping).map(|step| {
            let next: [f64; N] =
                std::array::from_fn(|i| (parameters[i] + step[i]).max(lower_bounds[i]));
            (next, NormalSums::of(model, &next).hold(&held))
        });
        match next {
            Some((next, candidate)) if candidate.squares <= sums.squares => {
                let gain = sums.squares - candidate.squares;
                parameters = next;
                sums = candidate;
                damping = (damping * 0.1).max(1e-12);
                // The gain is far below the parameter changes within the residuals' scatter.
                let variance = (sums.squares / sums.count as f64).max(MIN_RESIDUAL.powi(2));
                if damping < 1e-3 && gain <= 1e-6 * variance {
                    break;
                }
            }
            _ if damping > 1e8 => break,
            _ => damping *= 10.0,
        }
    }
    // Parameters at their bounds have no variance.
    let held: [bool; N] = std::array::from_fn(|i| held[i] || parameters[i] <= lower_bounds[i]);
    let sums = sums.hold(&held);
    let free = held.iter().filter(|held| !**held).count();
    let degrees = sums.count.checked_sub(free).filter(|&degrees| degrees > 0)?;
    let variance = (sums.squares / degrees as f64).max(MIN_RESIDUAL.powi(2));
    let dependence = dependence(model, &parameters, sums.squares, sums.count);
    let mut covariance = sums.normal.cholesky()?.inverse() * (variance * dependence);
    for i in (0..N).filter(|&i| held[i]) {
        covariance.row_mut(i).fill(0.0);
        covariance.column_mut(i).fill(0.0);
    }
    let finite = parameters.iter().chain(covariance.iter()).all(|v| v.is_finite());
    finite.then_some(Fit {
        parameters,
        covariance,
        squares: sums.squares,
        residual: variance.sqrt(),
    })
}
