//! Comparison of TCP paths and the blends at their ends with the assumptions about them: positions,
//! orientations and E1, regardless of time.

use std::ops::Range;

use iiwa_kin::{
    Pose,
    rotation::{dot, log, norm, product, sub, transposed},
};
use iiwa_path::{JointPath, Segment, Step};
use iiwa_program::MotionIndex;

use crate::identify::{
    observation::{CourseObservation, CoursePart, FEWEST, LeftOut, Why},
    watched::{CornerSpace, Watched},
};

/// Number of chords of a segment.
const CHORDS: usize = 256;

/// Number of chords ahead that are searched for a nearer one.
const AHEAD: usize = 12;

/// Minimum length of a TCP path, in m: on a shorter one, the TCP position does not determine the
/// path parameter.
const MIN_WAY_M: f64 = 1e-3;

/// Distance from the path, in m, above which the robot counts as performing another motion.
const ASTRAY_M: f64 = 0.02;

/// Section of a recording: steps of its path, and samples.
#[derive(Clone, Debug)]
pub(super) struct RecordedSection {
    pub(super) steps: Range<usize>,
    pub(super) samples: Range<usize>,
}

/// Observations, and parts that were not used.
#[derive(Debug, Default)]
pub(super) struct Courses {
    pub(super) observed: Vec<CourseObservation>,
    pub(super) left_out: Vec<LeftOut>,
}

/// Segment that is matched with samples.
struct FollowedStep<'a> {
    segment: &'a dyn Segment,
    /// Motion that defines the TCP.
    motion: MotionIndex,
    part: Option<CoursePart>,
    /// TCP positions at the ends of the chords, in m.
    places: Vec<[f64; 3]>,
}

impl Courses {
    /// Evaluates one section; `path` is the path of the program under the assumptions, with the
    /// identified kappa.
    pub(super) fn observe(
        &mut self,
        watched: &Watched<'_>,
        path: &JointPath,
        section: &RecordedSection,
    ) {
        let steps = path.steps().get(section.steps.clone()).unwrap_or_default();
        let followed: Vec<_> = steps.iter().filter_map(|step| follow(watched, step)).collect();
        if followed.iter().all(|step| step.part.is_none()) {
            return;
        }
        let mut observed: Vec<_> = followed.iter().map(|step| step.observation(watched)).collect();
        let (mut index, mut chord) = (0, 0);
        for joints in &watched.log.q_rad[section.samples.clone()] {
            let flange = watched.path.robot().flange_pose(joints);
            // The TCP depends on the motion of each step.
            let tcp = |step: &FollowedStep<'_>| flange.then(watched.path.tcp(step.motion));
            (index, chord) = nearest(&followed, (index, chord), |step| tcp(step).position_m);
            let tcp = tcp(&followed[index]);
            let (step, observed) = (&followed[index], &mut observed[index]);
            let Some(s) = step.parameter(chord, &tcp.position_m) else { continue };
            let assumed_rad = step.segment.at(s).q;
            let assumed = watched.tcp(step.motion, &assumed_rad);
            let off_m = step.across(chord, &sub(&tcp.position_m, &assumed.position_m));
            observed.off_m = observed.off_m.max(off_m);
            observed.turn_off_rad = observed.turn_off_rad.max(angle(&assumed, &tcp));
            observed.e1_off_rad = observed.e1_off_rad.max((joints[2] - assumed_rad[2]).abs());
            observed.samples += 1;
        }
        for (step, observed) in followed.iter().zip(observed) {
            if step.part.is_none() || step.way_m() < MIN_WAY_M {
                continue;
            }
            let reason = if observed.samples < FEWEST {
                Why::TooFewSamples
            } else if observed.off_m > ASTRAY_M {
                Why::OffCourse(observed.off_m)
            } else {
                self.observed.push(observed);
                continue;
            };
            let (recording, motion) = (watched.recording, step.motion);
            self.left_out.push(LeftOut { recording, motion, why: reason });
        }
    }
}

fn follow<'a>(watched: &Watched<'_>, step: &'a Step) -> Option<FollowedStep<'a>> {
    let Step::Move { motion, segment, blend, .. } = step else { return None };
    let (motion, part) = match blend {
        None => (*motion, watched.is_course(*motion).then_some(CoursePart::Path)),
        Some(corner) => {
            let part = match watched.corner_space(corner.motion) {
                CornerSpace::Joints => None,
                CornerSpace::StraightWays | CornerSpace::Ways => Some(CoursePart::TcpBlend),
                CornerSpace::Mixed => Some(CoursePart::JointBlend),
            };
            (corner.motion, part)
        }
    };
    let at = |i: usize| segment.at(i as f64 / CHORDS as f64).q;
    let places = (0..=CHORDS).map(|i| watched.tcp(motion, &at(i)).position_m).collect();
    Some(FollowedStep { segment: &**segment, motion, part, places })
}

/// Finds the nearest chord by descending from a given one.
fn nearest(
    followed: &[FollowedStep<'_>],
    mut best: (usize, usize),
    place: impl Fn(&FollowedStep<'_>) -> [f64; 3],
) -> (usize, usize) {
    let distance =
        |(step, chord): (usize, usize)| followed[step].distance(chord, &place(&followed[step]));
    let after = |(step, chord): (usize, usize)| {
        if chord + 1 < CHORDS {
            Some((step, chord + 1))
        } else {
            (step + 1 < followed.len()).then_some((step + 1, 0))
        }
    };
    let mut min_distance = distance(best);
    let (mut next, mut ahead) = (after(best), 0);
    while let Some(candidate_index) = next
        && ahead < AHEAD
    {
        let candidate = distance(candidate_index);
        ahead += 1;
        if candidate <= min_distance {
            (best, min_distance, ahead) = (candidate_index, candidate, 0);
        }
        next = after(candidate_index);
    }
    best
}

/// Returns the angle between two orientations, in rad.
fn angle(a: &Pose, b: &Pose) -> f64 {
    norm(&log(&product(&transposed(&a.rotation), &b.rotation)))
}

impl FollowedStep<'_> {
    fn chord(&self, chord: usize) -> [f64; 3] {
        sub(&self.places[chord + 1], &self.places[chord])
    }

    /// Returns the position of a point along a chord, as a share of its length.
    fn along(&self, chord: usize, place: &[f64; 3]) -> f64 {
        let way = self.chord(chord);
        dot(&sub(place, &self.places[chord]), &way) / dot(&way, &way).max(f64::MIN_POSITIVE)
    }

    fn distance(&self, chord: usize, place: &[f64; 3]) -> f64 {
        let share = self.along(chord, place).clamp(0.0, 1.0);
        let way = self.chord(chord);
        norm(&std::array::from_fn(|i| place[i] - self.places[chord][i] - share * way[i]))
    }

    /// Returns the path parameter of a point; none before the start and beyond the end.
    fn parameter(&self, chord: usize, place: &[f64; 3]) -> Option<f64> {
        let share = self.along(chord, place);
        let is_outside = (chord == 0 && share < 0.0) || (chord + 1 == CHORDS && share > 1.0);
        (!is_outside).then(|| (chord as f64 + share.clamp(0.0, 1.0)) / CHORDS as f64)
    }

    /// Returns the length of the part of `off` perpendicular to a chord.
    fn across(&self, chord: usize, off: &[f64; 3]) -> f64 {
        let way = self.chord(chord);
        let share = dot(off, &way) / dot(&way, &way).max(f64::MIN_POSITIVE);
        norm(&std::array::from_fn(|i| off[i] - share * way[i]))
    }

    fn way_m(&self) -> f64 {
        self.places.windows(2).map(|ends| norm(&sub(&ends[1], &ends[0]))).sum()
    }

    /// Creates the observation without samples.
    fn observation(&self, watched: &Watched<'_>) -> CourseObservation {
        let ends = [0.0, 1.0].map(|s| self.segment.at(s).q);
        let [start, end] = ends.each_ref().map(|joints| watched.tcp(self.motion, joints));
        CourseObservation {
            recording: watched.recording,
            motion: self.motion,
            part: self.part.unwrap_or(CoursePart::Path),
            turn_rad: angle(&start, &end),
            e1_rad: (ends[1][2] - ends[0][2]).abs(),
            off_m: 0.0,
            turn_off_rad: 0.0,
            e1_off_rad: 0.0,
            samples: 0,
        }
    }
}
