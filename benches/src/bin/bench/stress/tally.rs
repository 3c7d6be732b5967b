//! Results of a family.

use std::{collections::BTreeMap, fmt, time::Duration};

use iiwasim_tests::{families::Family, plan_check::PlanCheck};

/// Largest number of motions of programs that count for the longest plan.
const FEW_MOTIONS: usize = 20;

/// Number of program numbers printed for each kind of failure.
const SHOWN: usize = 8;

/// Largest value of a quantity, and its program.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    value: f64,
    index: u64,
}

impl Worst {
    fn add(&mut self, value: f64, index: u64) {
        if value > self.value {
            *self = Self { value, index };
        }
    }
}

impl fmt::Display for Worst {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.4} ({})", self.value, self.index)
    }
}

/// Results of one family.
#[derive(Debug)]
pub(crate) struct Tally {
    family: Family,
    programs: u64,
    motions: usize,
    redraws: usize,
    instants: [Worst; 3],
    clear: [Worst; 3],
    means: [Worst; 3],
    swept: [Worst; 2],
    coarse: Worst,
    slowest: Worst,
    planning: Duration,
    judging: Duration,
    /// Planning times of programs with few motions, in s.
    plans_s: Vec<f64>,
    longest_s: Worst,
    failed: usize,
    refused: usize,
    /// Failed and rejected programs, by reason.
    failures: BTreeMap<String, Vec<u64>>,
}

impl Tally {
    pub(crate) fn new(family: Family) -> Self {
        Self {
            family,
            programs: 0,
            motions: 0,
            redraws: 0,
            instants: <_>::default(),
            clear: <_>::default(),
            means: <_>::default(),
            swept: <_>::default(),
            coarse: <_>::default(),
            slowest: <_>::default(),
            planning: Duration::ZERO,
            judging: Duration::ZERO,
            plans_s: Vec::new(),
            longest_s: <_>::default(),
            failed: 0,
            refused: 0,
            failures: BTreeMap::new(),
        }
    }

    /// Draws program `index` and judges it.
    pub(crate) fn add(&mut self, seed: u64, index: u64) {
        let drawn = self.family.program(seed, index);
        let verdict = PlanCheck::of(&drawn.program);
        let motions = drawn.program.motions.len();
        self.programs += 1;
        self.motions += motions;
        self.redraws += drawn.redraws;
        let add = |worst: &mut [Worst], ratios: &[f64]| {
            worst.iter_mut().zip(ratios).for_each(|(worst, ratio)| worst.add(*ratio, index));
        };
        add(&mut self.instants, &verdict.instants);
        add(&mut self.clear, &verdict.clear);
        add(&mut self.means, &verdict.means);
        add(&mut self.swept, &verdict.swept);
        self.coarse.add(verdict.coarse.abs(), index);
        self.slowest.add(verdict.slower, index);
        self.planning += verdict.planning;
        self.judging += verdict.judging;
        if motions <= FEW_MOTIONS {
            let seconds = verdict.planning.as_secs_f64();
            self.plans_s.push(seconds);
            self.longest_s.add(seconds, index);
        }
        self.failed += usize::from(!verdict.failures.is_empty());
        self.refused += usize::from(!verdict.refusals.is_empty());
        for failure in verdict.refusals.into_iter().chain(verdict.failures) {
            self.failures.entry(failure).or_default().push(index);
        }
    }

    /// Number of programs so far.
    pub(crate) fn programs(&self) -> u64 {
        self.programs
    }

    /// Number of programs rejected with an error.
    pub(crate) fn refused(&self) -> usize {
        self.refused
    }

    /// Number of programs with any failure.
    pub(crate) fn failed(&self) -> usize {
        self.failed
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { programs, motions, redraws, failed, refused, .. } = self;
        writeln!(
            f,
            "{}: {programs} programs, {motions} motions, {redraws} redraws; {failed} failed, \
             {refused} refused",
            self.family.name()
        )?;
        let list =
            |worst: &[Worst]| worst.iter().map(Worst::to_string).collect::<Vec<_>>().join(", ");
        writeln!(f, "  worst ratios at an instant {}", list(&self.instants))?;
        let clear = list(&self.clear);
        writeln!(f, "  worst ratios at an instant, rounding excluded, {clear}")?;
        writeln!(f, "  worst ratios over 1 ms {}", list(&self.means))?;
        writeln!(f, "  worst ratios without jerk limits {}", list(&self.swept))?;
        writeln!(
            f,
            "  without jerk limits, off a finer grid by {:.4} % ({})",
            100.0 * self.coarse.value,
            self.coarse.index
        )?;
        writeln!(f, "  jerk-limited over acceleration-limited time at most {}", self.slowest)?;
        let [planning, judging] = [self.planning, self.judging].map(|time| time.as_secs_f64());
        write!(f, "  planned in {planning:.1} s, judged in {judging:.1} s")?;
        let mut plans_s = self.plans_s.clone();
        plans_s.sort_by(f64::total_cmp);
        if let Some(median_s) = plans_s.get(plans_s.len() / 2) {
            write!(
                f,
                "; the longest plan of {FEW_MOTIONS} motions and less took {:.1} ms ({}), {:.0} \
                 times the median",
                1e3 * self.longest_s.value,
                self.longest_s.index,
                self.longest_s.value / median_s
            )?;
        }
        for (message, programs) in &self.failures {
            let some = &programs[..programs.len().min(SHOWN)];
            write!(f, "\n  {}: {message}, as {some:?}", programs.len())?;
        }
        Ok(())
    }
}
