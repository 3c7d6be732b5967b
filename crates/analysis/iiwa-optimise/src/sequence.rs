//! The fastest sequence of tasks, by the times between them.

use std::ops::Range;

/// Smaller differences of times are rounding.
const ROUNDING_S: f64 = 1e-12;

/// Times of the parts of a sequence of tasks, in s; infinite for those that are not possible.
#[derive(Clone, Debug)]
#[expect(clippy::exhaustive_structs, reason = "the times are written out in full")]
pub struct SequenceTimes {
    /// Of each task as the first one.
    pub first_s: Vec<f64>,
    /// Of each task (second index) directly after another one (first index).
    pub next_s: Vec<Vec<f64>>,
    /// Of what follows the last task, for each task as the last one.
    pub last_s: Vec<f64>,
    /// For each task, the tasks that have to be before it.
    pub after: Vec<Vec<usize>>,
}

impl SequenceTimes {
    /// Largest number of tasks whose sequences are all compared in a search for an order. The
    /// memory for them doubles with each task.
    pub const EXACT_TASKS: usize = 16;

    /// Returns the fastest of all sequences, by a dynamic program over sets of tasks (Held and
    /// Karp, 1962). `None` if none is possible, or if there are more than 20 tasks, which would
    /// take too much memory.
    #[must_use]
    pub fn fastest(&self) -> Option<Vec<usize>> {
        const MOST: usize = 20;

        let count = self.first_s.len();
        if count > MOST {
            return None;
        }
        let bits = |tasks: &Vec<usize>| tasks.iter().fold(0_usize, |bits, task| bits | 1 << task);
        let after: Vec<usize> = self.after.iter().map(bits).collect();
        // Shortest time of a set of tasks (its bits) that ends with a certain one, and the task
        // before that.
        let mut best = vec![(f64::INFINITY, usize::MAX); count << count];
        for task in (0..count).filter(|task| after[*task] == 0) {
            best[(1 << task) * count + task].0 = self.first_s[task];
        }
        for done in 1..1_usize << count {
            for last in (0..count).filter(|last| done & 1 << last != 0) {
                let (time_s, _) = best[done * count + last];
                if !time_s.is_finite() {
                    continue;
                }
                let is_next = |next: &usize| done & 1 << next == 0 && after[*next] & !done == 0;
                for next in (0..count).filter(is_next) {
                    let entry = &mut best[(done | 1 << next) * count + next];
                    let next_s = time_s + self.next_s[last][next];
                    if next_s < entry.0 {
                        *entry = (next_s, last);
                    }
                }
            }
        }
        let mut done = (1 << count) - 1;
        let end_s = |last: &usize| best[done * count + last].0 + self.last_s[*last];
        let mut last = (0..count).min_by(|a, b| end_s(a).total_cmp(&end_s(b)))?;
        if !end_s(&last).is_finite() {
            return None;
        }
        let mut order = vec![last];
        while let (_, before) = best[done * count + last]
            && before != usize::MAX
        {
            done &= !(1 << last);
            last = before;
            order.push(last);
        }
        order.reverse();
        Some(order)
    }

    /// Improves a sequence that [is allowed](Self::is_allowed), and the sequence in which each task
    /// follows in the shortest time, by moving and reversing parts of it (2-opt and Or-opt); then
    /// again from sequences that are similar to the best one. `None` if no possible sequence is
    /// found.
    #[must_use]
    pub fn improved(&self, given: &[usize]) -> Option<Vec<usize>> {
        /// Number of times that the search starts from a similar sequence.
        const RESTARTS: usize = 60;
        /// Largest number of times that are added up: about a second of work.
        const MOST: usize = 400_000_000;

        let mut left = MOST;
        let mut best = self.descended(given.to_vec(), &mut left);
        if let Some(start) = self.nearest() {
            let other = self.descended(start, &mut left);
            if self.total_s(&other) < self.total_s(&best) {
                best = other;
            }
        }
        let mut random = Random(1);
        for _ in 0..RESTARTS {
            if left == 0 {
                break;
            }
            let other = self.descended(self.shaken(&best, &mut random), &mut left);
            if self.total_s(&other) < self.total_s(&best) - ROUNDING_S {
                best = other;
            }
        }
        self.total_s(&best).is_finite().then_some(best)
    }

    /// Total time of a sequence, in s.
    #[must_use]
    pub fn total_s(&self, order: &[usize]) -> f64 {
        let (Some(first), Some(last)) = (order.first(), order.last()) else { return 0.0 };
        let between: f64 = order.windows(2).map(|pair| self.next_s[pair[0]][pair[1]]).sum();
        self.first_s[*first] + between + self.last_s[*last]
    }

    /// Returns true if each task is after those that have to be before it.
    #[must_use]
    pub fn is_allowed(&self, order: &[usize]) -> bool {
        let mut place = vec![0; order.len()];
        for (at, task) in order.iter().enumerate() {
            place[*task] = at;
        }
        let is_after =
            |task: &usize| self.after[*task].iter().all(|before| place[*before] < place[*task]);
        order.iter().all(is_after)
    }

    /// Returns the sequence in which each task is the one that takes the shortest time there.
    fn nearest(&self) -> Option<Vec<usize>> {
        let count = self.first_s.len();
        let mut order: Vec<usize> = Vec::with_capacity(count);
        while order.len() < count {
            let time_s = |task: &usize| match order.last() {
                Some(last) => self.next_s[*last][*task],
                None => self.first_s[*task],
            };
            let is_next = |task: &usize| {
                !order.contains(task) && self.after[*task].iter().all(|it| order.contains(it))
            };
            let next = (0..count).filter(is_next).min_by(|a, b| time_s(a).total_cmp(&time_s(b)))?;
            order.push(next);
        }
        Some(order)
    }

    /// Moves parts of up to three tasks elsewhere, also reversed, and reverses parts of any length,
    /// until no such step saves time, or until `left` times are added up.
    fn descended(&self, mut order: Vec<usize>, left: &mut usize) -> Vec<usize> {
        let count = order.len();
        let mut total_s = self.total_s(&order);
        loop {
            let mut is_better = false;
            for from in 0..count {
                for to in from + 1..=count {
                    // Only short parts are moved.
                    let places = if to - from <= 3 { 0..=count - (to - from) } else { from..=from };
                    for place in places {
                        for is_reversed in [false, true] {
                            if place == from && !is_reversed {
                                continue;
                            }
                            let candidate = moved(&order, from..to, place, is_reversed);
                            *left = left.saturating_sub(count);
                            let candidate_s = self.total_s(&candidate);
                            if candidate_s < total_s - ROUNDING_S && self.is_allowed(&candidate) {
                                (order, total_s, is_better) = (candidate, candidate_s, true);
                            }
                        }
                    }
                }
            }
            if !is_better || *left == 0 {
                return order;
            }
        }
    }

    /// Exchanges two neighbouring parts at a random place, if the result is allowed.
    fn shaken(&self, order: &[usize], random: &mut Random) -> Vec<usize> {
        let count = order.len();
        for _ in 0..20 {
            let mut cuts = [0; 3].map(|_: usize| random.below(count + 1));
            cuts.sort_unstable();
            let [a, b, c] = cuts;
            let shaken = [&order[..a], &order[b..c], &order[a..b], &order[c..]].concat();
            if self.is_allowed(&shaken) {
                return shaken;
            }
        }
        order.to_vec()
    }
}

/// Returns a sequence whose part at `part` is moved to `place` in the rest, and reversed.
fn moved(order: &[usize], part: Range<usize>, place: usize, is_reversed: bool) -> Vec<usize> {
    let mut rest: Vec<usize> = order[..part.start].to_vec();
    rest.extend_from_slice(&order[part.end..]);
    let mut moving = order[part].to_vec();
    if is_reversed {
        moving.reverse();
    }
    rest.splice(place..place, moving);
    rest
}

/// Linear congruential generator (Knuth's constants): the same numbers on each machine.
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        ((self.0 >> 33) as usize) % end
    }
}
