//! Location of a program's motions in a recording: from stop to stop, by the targets.

use std::ops::Range;

use iiwa_kin::{
    Joints,
    vector::{add_scaled, distance, dot, norm, sub},
};
use iiwa_log::JointLog;
use iiwa_path::{JointPath, Segment, Step};
use iiwa_program::MotionIndex;

/// Distance from a stop, in rad, within which the robot is about to leave or to arrive: above
/// tracking and measurement errors, and a small part of a motion.
const NEAR_RAD: f64 = 2e-3;

/// Distance from the path, in rad, above which the robot performs another motion. Without this
/// check, a robot that reaches the target in another way would be evaluated as if it had followed
/// the path.
const ASTRAY_RAD: f64 = 0.1;

/// Section of a path from one stop to the next, with its samples.
#[derive(Clone, Debug)]
pub(super) struct Passage {
    /// Steps of the path.
    pub(super) steps: Range<usize>,
    pub(super) from: Joints,
    pub(super) to: Joints,
    /// Samples from the rest before the section to the rest after it.
    pub(super) samples: Range<usize>,
    /// First sample near the end of the section.
    pub(super) arrives: usize,
    /// Number of settlings at the end, and additional waiting time, in s.
    pub(super) settles: u32,
    pub(super) waits_s: f64,
}

/// Sections of a path, as far as the recording follows it.
#[derive(Debug)]
pub(super) struct FollowedStops {
    pub(super) passages: Vec<Passage>,
    /// Motion in which the recording leaves the path.
    pub(super) lost_in: Option<MotionIndex>,
}

/// Planned section.
struct PlannedSection {
    steps: Range<usize>,
    from: Joints,
    to: Joints,
    settles: u32,
    waits_s: f64,
}

/// Divides a path into sections from stop to stop.
fn planned(path: &JointPath) -> Vec<PlannedSection> {
    let mut sections: Vec<PlannedSection> = Vec::new();
    let mut pose_rad = *path.start_rad();
    let mut moving = false;
    let overlaps = |motion: &MotionIndex| {
        path.overlapping_waits().binary_search_by_key(motion, |wait| wait.motion).is_ok()
    };
    // The real time of an input or output is unknown, whichever time is assumed.
    let is_signal = |motion: &MotionIndex| path.io(*motion).is_some();
    for (i, step) in path.steps().iter().enumerate() {
        match step {
            Step::Move { segment, .. } => {
                let end = segment.at(1.0).q;
                match sections.last_mut().filter(|_| moving) {
                    Some(section) => (section.steps.end, section.to) = (i + 1, end),
                    None => sections.push(PlannedSection {
                        steps: i..i + 1,
                        from: pose_rad,
                        to: end,
                        settles: 0,
                        waits_s: 0.0,
                    }),
                }
                (pose_rad, moving) = (end, true);
                continue;
            }
            Step::Settle { .. } => {
                if let Some(section) = sections.last_mut() {
                    section.settles += 1;
                }
            }
            Step::Wait { motion, .. } if overlaps(motion) || is_signal(motion) => {
                // The rest for this wait depends on the start times of motions, or on a signal: the
                // settle time cannot be separated.
                if let Some(section) = sections.last_mut() {
                    section.settles = 0;
                }
            }
            Step::Wait { seconds, .. } => {
                if let Some(section) = sections.last_mut() {
                    section.waits_s += seconds;
                }
            }
            _ => {}
        }
        moving = false;
    }
    sections
}

/// Finds the sections of `path` in `log`, from the sample `from` on; none if the robot is never at
/// the start of the path.
pub(super) fn follow(path: &JointPath, log: &JointLog, from: usize) -> Option<FollowedStops> {
    let q = &log.q_rad;
    let find = |from: usize, holds: &dyn Fn(&Joints) -> bool| {
        q[from..].iter().position(holds).map(|offset| from + offset)
    };
    let mut offset = find(from, &|q| distance(q, path.start_rad()) < NEAR_RAD)?;
    let mut lost_in = None;
    // Samples from leaving each stop to arriving near the next one.
    let mut cores = Vec::new();
    let sections = planned(path);
    for section in &sections {
        let core = (|| {
            // The distance is smaller for short ways. A section may end at its start.
            let near = NEAR_RAD.min(0.1 * farthest(path, section)).max(1e-9);
            let leaves = find(offset, &|q| distance(q, &section.from) > near)?;
            let mut passed = leaves;
            for step in &path.steps()[section.steps.clone()] {
                if let Step::Move { segment, blend: Some(_), .. } = step {
                    let middle = segment.at(0.5).q;
                    let reach = distance(&middle, &segment.at(0.0).q).max(NEAR_RAD);
                    passed = find(passed, &|q| distance(q, &middle) < 0.7 * reach)?;
                }
            }
            let core = leaves..find(passed, &|q| distance(q, &section.to) < near)?;
            let astray = match &path.steps()[section.steps.clone()] {
                [Step::Move { segment, blend: None, .. }] if segment.is_straight() => q
                    [core.clone()]
                .iter()
                .any(|q| beside(q, &section.from, &section.to) > ASTRAY_RAD),
                [Step::Move { segment, blend: None, .. }] => {
                    let chords = chords(segment.as_ref());
                    q[core.clone()].iter().any(|q| off(q, &chords) > ASTRAY_RAD)
                }
                _ => false,
            };
            (!astray).then_some(core)
        })();
        let Some(core) = core else {
            lost_in = Some(match &path.steps()[section.steps.start] {
                Step::Move { motion, .. } => *motion,
                _ => MotionIndex::default(),
            });
            break;
        };
        offset = core.end;
        cores.push(core);
    }
    let mut begin =
        cores.first().map_or(0, |core| standing_before(log, core.start, path.start_rad()));
    let mut passages = Vec::with_capacity(cores.len());
    for (i, (section, core)) in sections.into_iter().zip(&cores).enumerate() {
        let end = match cores.get(i + 1) {
            Some(next) => slowest(log, core.end..next.start),
            None => standing_after(log, core.end, &section.to),
        };
        let PlannedSection { steps, from, to, settles, waits_s } = section;
        let (samples, arrives) = (begin..end, core.end);
        passages.push(Passage { steps, from, to, samples, arrives, settles, waits_s });
        begin = end;
    }
    Some(FollowedStops { passages, lost_in })
}

/// Returns the largest distance of a section from its start.
fn farthest(path: &JointPath, section: &PlannedSection) -> f64 {
    const PLACES: u32 = 8;
    let away = |segment: &dyn Segment| {
        let places = (1..=PLACES).map(|i| segment.at(f64::from(i) / f64::from(PLACES)).q);
        places.map(|q| distance(&q, &section.from)).fold(0.0, f64::max)
    };
    let segments = path.steps()[section.steps.clone()].iter().filter_map(|step| match step {
        Step::Move { segment, .. } => Some(away(segment.as_ref())),
        _ => None,
    });
    segments.fold(0.0, f64::max)
}

/// Returns the distance from the line through two points.
fn beside(q: &Joints, from: &Joints, to: &Joints) -> f64 {
    let (way, off) = (sub(to, from), sub(q, from));
    let along = dot(&off, &way) / dot(&way, &way).max(f64::MIN_POSITIVE);
    norm(&add_scaled(&off, -along, &way))
}

/// Number of chords of a curve in joint space, which are much closer to the curve than
/// [`ASTRAY_RAD`].
const CHORDS: usize = 48;

fn chords(segment: &dyn Segment) -> Vec<Joints> {
    (0..=CHORDS).map(|i| segment.at(i as f64 / CHORDS as f64).q).collect()
}

/// Returns the distance from the nearest chord of a curve.
fn off(q: &Joints, chords: &[Joints]) -> f64 {
    let from_chord = |ends: &[Joints]| {
        let (way, to) = (sub(&ends[1], &ends[0]), sub(q, &ends[0]));
        let along = dot(&to, &way) / dot(&way, &way).max(f64::MIN_POSITIVE);
        norm(&add_scaled(&to, -along.clamp(0.0, 1.0), &way))
    };
    chords.windows(2).map(from_chord).fold(f64::INFINITY, f64::min)
}

/// Evaluated time at rest before the first motion and after the last one, in s.
const STANDING_S: f64 = 0.5;

/// Returns the first sample of the rest at `from`; other motions before that rest are excluded.
fn standing_before(log: &JointLog, leaves: usize, from: &Joints) -> usize {
    let from_s = log.t_s[leaves] - STANDING_S;
    let is_at_start =
        |i: &usize| log.t_s[*i] >= from_s && distance(&log.q_rad[*i], from) < AWAY_RAD;
    let first = leaves - (0..leaves).rev().take_while(is_at_start).count();
    let came = first > 0 && log.t_s[first - 1] >= from_s;
    if came { slowest(log, first..leaves) } else { first }
}

/// Returns the end of the samples at rest at `to`; other motions after that rest are excluded.
fn standing_after(log: &JointLog, arrives: usize, to: &Joints) -> usize {
    let until_s = log.t_s[arrives] + STANDING_S;
    let is_at_end = |i: &usize| log.t_s[*i] <= until_s && distance(&log.q_rad[*i], to) < AWAY_RAD;
    let end = arrives + (arrives..log.t_s.len()).take_while(is_at_end).count();
    let went = log.t_s.get(end).is_some_and(|t_s| *t_s <= until_s);
    if went { slowest(log, arrives..end) } else { end }
}

/// Distance from a stop, in rad, above which the robot is not at rest there, for any noise.
const AWAY_RAD: f64 = 2.0 * NEAR_RAD;

/// Averaging time that distinguishes rest from creeping, in s.
const MEAN_S: f64 = 0.008;

/// Returns the sample around which the robot moves least.
fn slowest(log: &JointLog, within: Range<usize>) -> usize {
    let Some(last) = within.clone().last() else { return within.start };
    let period_s = (log.t_s[last] - log.t_s[within.start]) / within.len().max(1) as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count")]
    let width = ((MEAN_S / period_s) as usize).clamp(1, within.len());
    let sum = |from: usize| {
        let mut sum = [0.0; 7];
        for q in &log.q_rad[from..from + width] {
            sum = std::array::from_fn(|j| sum[j] + q[j]);
        }
        sum
    };
    let begin = within.start.saturating_sub(width);
    let end = (within.end + width).min(log.q_rad.len());
    let way = |middle: usize| distance(&sum(middle - width), &sum(middle));
    (begin + width..(end + 1).saturating_sub(width))
        .min_by(|a, b| way(*a).total_cmp(&way(*b)))
        .unwrap_or(within.start)
}

#[cfg(test)]
mod tests {
    use iiwa_kin::Robot;
    use iiwa_program::{IoEntry, IoValue, Motion, Program, Ptp};

    use super::*;

    #[test]
    fn the_rest_at_a_signal_is_not_a_settling() {
        let value = IoValue::Boolean(true);
        for (entry, settles) in [
            (Motion::Wait { seconds: 0.2, overlap: 0 }, [1, 1]),
            (Motion::Io(IoEntry::wait_for("A.B", value, 0.4)), [0, 1]),
            (Motion::Io(IoEntry::wait_for("A.B", value, 0.0)), [0, 1]),
            (Motion::Io(IoEntry::set("A.B", value)), [0, 1]),
        ] {
            let ptp = |a1_rad: f64| Motion::Ptp(Ptp::to([a1_rad, 0.5, 0.0, -1.0, 0.0, 1.5, 0.0]));
            let program = Program {
                motions: vec![ptp(0.5), entry.clone(), ptp(0.0)],
                ..Program::from_deg([0.0, 30.0, 0.0, -60.0, 0.0, 90.0, 0.0]).build()
            };
            let path = JointPath::new(&program, &Robot::default()).unwrap();
            let found: Vec<u32> = planned(&path).iter().map(|section| section.settles).collect();
            assert_eq!(found, settles, "{entry:?}");
        }
    }
}
