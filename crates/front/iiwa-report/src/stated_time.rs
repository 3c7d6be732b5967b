//! Stated cycle time of a recording, as text.

use iiwa_log::CycleClock;

/// Formats one line on a stated cycle time, in s, of a recording with a sample every `step_s`
/// seconds. The plan takes `plan_s`, of which the arm is at rest for `standing_s` at the start and
/// the end.
pub(crate) fn stated_time(
    stated_s: f64,
    timed_by: CycleClock,
    step_s: Option<f64>,
    [plan_s, standing_s]: [f64; 2],
) -> String {
    let cycles = step_s.map_or_else(String::new, |s| format!(", in cycles of {:.0} ms", 1e3 * s));
    match timed_by {
        CycleClock::CommandedPosition => format!(
            "{stated_s:.3} s from the first to the last change of the commanded positions{cycles}; \
             in the plan {:.3} s, without {standing_s:.3} s of standstill before and after",
            plan_s - standing_s
        ),
        _ => format!("{stated_s:.3} s by the robot program's clock{cycles}"),
    }
}
