//! Receding horizon for sections that are too long to be solved as a whole.

use std::sync::atomic::AtomicBool;

use iiwa_solver::{LimitedSegment, Solution, SolveError, Window};

use super::stamps::{Stamper, Stamps};
use crate::timing::JerkOptions;

/// Segments whose stamps are settled by one part.
const SETTLED: usize = 30;

/// Numbers of segments by which a part is shortened, in this order, until the next part has a
/// solution: the given state at its start may be infeasible.
const FEWER: [usize; 6] = [0, 1, 2, 3, 5, 8];

/// Minimum number of look-ahead segments beyond the settled ones.
const AHEAD: usize = 10;

/// Minimum look-ahead distance, as a multiple of the stopping distance.
const STOPS: f64 = 1.5;

/// Finds the stamps of a section that is not one line.
pub(crate) fn stamps(
    segments: &[LimitedSegment<'_>],
    start_s: f64,
    options: JerkOptions,
    stop: &AtomicBool,
) -> Result<Stamps, SolveError> {
    if !options.general
        && let Some(stamps) = receding(segments, start_s, options, stop)?
    {
        return Ok(stamps);
    }
    let whole = Window { segments, range: 0..segments.len(), entry: None, exit: None };
    let solution = Solution::find(&whole, options.refinement, stop)?;
    let mut stamper = Stamper::new(start_s, 0);
    stamper.add(&solution, &whole, segments.len());
    Ok(stamper.finish())
}

/// Solves part by part, each with some segments of look-ahead, on the last of which the robot could
/// stop. A feasible continuation from the end of every part therefore exists, and far enough from
/// that stop the stamps do not depend on it. None if the section cannot be divided like this, or if
/// a part has no solution.
fn receding(
    segments: &[LimitedSegment<'_>],
    start_s: f64,
    options: JerkOptions,
    stop: &AtomicBool,
) -> Result<Option<Stamps>, SolveError> {
    let mut stamper = Stamper::new(start_s, 0);
    let Some(first) =
        // The caller solves the section as a whole if it is not longer than one part.
        part(segments, 0, None).filter(|first| first.window.range.end < segments.len())
    else {
        return Ok(None);
    };
    let Some(solution) = solve(&first.window, options, stop)? else { return Ok(None) };
    let (mut before, mut solution) = (first, solution);
    while before.settled < segments.len() {
        let mut next = None;
        for fewer in FEWER {
            let start = before.settled - fewer;
            let Some(part) = part(segments, start, solution.entry(start)) else { break };
            if let Some(solution) = solve(&part.window, options, stop)? {
                next = Some((start, part, solution));
                break;
            }
        }
        let Some((start, part, next_solution)) = next else { return Ok(None) };
        stamper.add(&solution, &before.window, start);
        (before, solution) = (part, next_solution);
    }
    stamper.add(&solution, &before.window, segments.len());
    Ok(Some(stamper.finish()))
}

/// Window that is solved in one call.
struct SolvedWindow<'a, 'b> {
    window: Window<'a, 'b>,
    /// Index of the segment up to which the part's solution is final for the section.
    settled: usize,
}

/// Returns the part that starts at the segment `start`.
fn part<'a, 'b>(
    segments: &'a [LimitedSegment<'b>],
    start: usize,
    entry: Option<[f64; 2]>,
) -> Option<SolvedWindow<'a, 'b>> {
    // Finds the first segment at least `count` segments and some stopping distances beyond `from`.
    let beyond = |from: usize, count: usize| {
        let before = from.checked_sub(1).map(|before| &segments[before]);
        let mut way = STOPS * segments.get(from)?.stop_rad(before);
        let mut index = from;
        while index < from + count || way > 0.0 {
            way -= segments.get(index)?.length_rad();
            index += 1;
        }
        Some(index)
    };
    // Without an entry state the part would start at rest, which only the first one does.
    if start > 0 && entry.is_none() {
        return None;
    }
    let settled = beyond(start, SETTLED);
    let end = settled.and_then(|settled| {
        let end = beyond(settled, AHEAD)?;
        let stop = segments[end - 1..].iter().position(LimitedSegment::is_stop)?;
        // The rest after the stop should be worth a part of its own.
        Some(end + stop).filter(|end| end + (settled - start) / 2 < segments.len())
    });
    let (settled, end) = settled.zip(end).unwrap_or((segments.len(), segments.len()));
    Some(SolvedWindow {
        window: Window { segments, range: start..end, entry, exit: None },
        settled,
    })
}

/// Solves a window; none if the solution had to be slowed down, since its end states are then not
/// the given ones.
pub(super) fn solve(
    window: &Window<'_, '_>,
    options: JerkOptions,
    stop: &AtomicBool,
) -> Result<Option<Solution>, SolveError> {
    match Solution::find(window, options.refinement, stop) {
        Ok(solution) => Ok(Some(solution).filter(|solution| solution.time_scale() == 1.0)),
        Err(SolveError::NotConverged) => Ok(None),
        Err(error) => Err(error),
    }
}
