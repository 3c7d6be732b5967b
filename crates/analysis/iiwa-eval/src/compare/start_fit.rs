//! Start time of a motion, from the samples after the start.

use super::line::WeightedLine;
use super::start_law::StartLaw;

/// Number of times that the fitted part of the way is halved to find a part with one law.
const TOPS: usize = 8;

/// Minimum number of samples of a part of the way.
const FEWEST: usize = 15;

/// Residual in rad up to which the plan counts as the exact motion.
const EXACT_RAD: f64 = 1e-9;

/// Increase of chi squared that occurs by chance once in a thousand times, or less.
const CLEARLY: f64 = 12.0;

/// Samples of a start from standstill. For an arrival, time runs backwards.
pub(super) struct StartFit<'a> {
    /// Way in rad and time in s, in order of the way.
    pub(super) points: &'a [(f64, f64)],
    /// Standard deviation of the ways, in rad.
    pub(super) sigma: f64,
    /// `true` if the robot deviates from its set-points, so that residuals are correlated from
    /// sample to sample.
    pub(super) tracks: bool,
}

impl StartFit<'_> {
    /// Returns the line whose zero is the start. `plan` returns the planned time and speed for a
    /// way, and is preferred.
    pub(super) fn best(&self, plan: &dyn Fn(f64) -> Option<(f64, f64)>) -> Option<WeightedLine> {
        let whole = self.points.last()?.0;
        let planned = self.fit(plan, whole);
        // Soft starts look like hard ones that begin later: only the whole way shows the
        // difference.
        let on_whole = |is_soft| self.any(std::iter::once(whole), is_soft);
        let hard = if self.tracks { None } else { on_whole(false) };
        let soft = on_whole(true);
        let is_soft = match (&hard, &soft) {
            (Some(hard), Some(soft)) => self.is_worse(hard, soft),
            (hard, _) => hard.is_none(),
        };
        let Some(other) = (if is_soft { soft } else { hard }) else { return planned };
        match planned {
            Some(planned) if !self.is_worse(&planned, &other) => Some(planned),
            _ => self.any(self.tops(), is_soft),
        }
    }

    /// Returns true if a line fits significantly worse than another one through the same points.
    fn is_worse(&self, line: &WeightedLine, other: &WeightedLine) -> bool {
        if self.tracks {
            return other.miss() < 0.8 * line.miss();
        }
        line.misfit(self.sigma.max(other.miss()).max(EXACT_RAD)) > CLEARLY
    }

    /// Returns the ways up to which the points are evaluated.
    fn tops(&self) -> impl Iterator<Item = f64> {
        let whole = self.points.last().map(|point| point.0);
        let tops = std::iter::successors(whole, |top| Some(0.5 * top));
        let min_top = 50.0 * self.sigma;
        let first = whole.unwrap_or_default();
        tops.take_while(move |top| *top == first || *top > min_top).take(if self.tracks {
            1
        } else {
            TOPS
        })
    }

    /// Returns the best fit of all soft or of all other laws.
    fn any(&self, tops: impl Iterator<Item = f64>, is_soft: bool) -> Option<WeightedLine> {
        let whole = self.points.last()?.0;
        let laws =
            tops.flat_map(|top| StartLaw::all(is_soft, self.tracks).map(move |law| (law, top)));
        let lines = laws.filter_map(|(law, top)| {
            let min_points = if top < whole { FEWEST } else { 4 };
            let line = self.fit(&|p| Some(law.time(p)), top)?;
            Some(line).filter(|line| line.points >= min_points)
        });
        let rank = |line: &WeightedLine| {
            if self.tracks { line.miss() } else { line.error(self.sigma) }
        };
        lines.reduce(|a, b| if rank(&b) < rank(&a) { b } else { a })
    }

    fn fit(&self, law: &dyn Fn(f64) -> Option<(f64, f64)>, top: f64) -> Option<WeightedLine> {
        let points = self.points.iter().filter(|point| point.0 <= top);
        WeightedLine::fit(points.filter_map(|&(p, t_s)| {
            let (tau, speed) = law(p)?;
            Some((tau, t_s, speed * speed))
        }))
    }
}
