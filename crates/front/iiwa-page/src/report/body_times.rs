//! Shapes that a program carries at the flange, over time.

use iiwa_eval::MotionTime;
use iiwa_log::PlanPiece;
use iiwa_program::MotionIndex;
use iiwa_scene::CarriedBodies;
use serde::{Serialize, Serializer};

/// Difference of times below which they are equal, in s: rounding.
const SAME_S: f64 = 1e-9;

/// Bodies at the flange over time.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodyTimes {
    changes: Vec<BodyChange>,
}

/// Bodies at the flange from a time on.
#[derive(Clone, Debug, PartialEq)]
struct BodyChange {
    /// Time, in s of the page.
    from_s: f64,
    /// Motion of the program with these bodies.
    motion: MotionIndex,
    /// Indices of the bodies.
    bodies: Vec<usize>,
}

/// Motion, or rest of the program, at a time of the page.
#[derive(Clone, Copy, Debug)]
struct MotionSpan {
    motion: MotionIndex,
    /// Start and end, in s; none if unknown.
    start_s: Option<f64>,
    end_s: Option<f64>,
}

impl BodyTimes {
    /// Returns the times of a plan, from its pieces in page time. `is_whole` is false for a plan
    /// that is truncated after its last piece.
    pub(crate) fn of_plan(carried: &CarriedBodies, pieces: &[PlanPiece], is_whole: bool) -> Self {
        let motions = pieces.chunk_by(|a, b| a.motion == b.motion).map(|pieces| MotionSpan {
            motion: MotionIndex::new((pieces[0].motion as usize).saturating_sub(1)),
            start_s: Some(pieces[0].start_s),
            end_s: Some(pieces[pieces.len() - 1].end_s),
        });
        let motions = motions.collect::<Vec<_>>();
        let known = if is_whole { usize::MAX } else { motions.len() };
        // All times of a plan are known.
        Self::new(carried, &motions, known).unwrap_or_default()
    }

    /// Returns the measured times of a recording; none if the recording does not show when other
    /// bodies are at the flange.
    pub(crate) fn of_recording(carried: &CarriedBodies, motions: &[MotionTime]) -> Option<Self> {
        let mut before_s = None;
        let motions = motions.iter().map(|it| {
            // The robot rests in a wait that the recording does not show: at the position where the
            // motion before ends.
            let is_rest = !it.motion_type.moves();
            let start_s = it.real_start_s.or(before_s.filter(|_| is_rest));
            let measured_s = it.real_start_s.zip(it.real_s).map(|(start_s, s)| start_s + s);
            let end_s = measured_s.or(start_s.filter(|_| is_rest));
            before_s = end_s;
            MotionSpan { motion: it.motion, start_s, end_s }
        });
        Self::new(carried, &motions.collect::<Vec<_>>(), usize::MAX)
    }

    /// Creates the times from those of the motions, of which load changes have none: they happen at
    /// the start of the motion after them, or at the end of the last one. Changes after the first
    /// `known` motions are left out.
    fn new(carried: &CarriedBodies, motions: &[MotionSpan], known: usize) -> Option<Self> {
        let last_s = motions.last()?.end_s;
        let mut changes: Vec<BodyChange> = Vec::new();
        for (number, motion) in carried.changes().enumerate() {
            let next = motions.partition_point(|it| it.motion < motion);
            if next >= known {
                break;
            }
            let at_s = motions.get(next).map_or(last_s, |it| it.start_s);
            // The first bodies are at the flange from the start.
            let from_s = at_s.or((number == 0).then_some(0.0))?;
            // Measured times may be slightly out of order.
            let from_s = changes.last().map_or(from_s, |before| from_s.max(before.from_s));
            changes.push(BodyChange { from_s, motion, bodies: carried.during(motion).collect() });
        }
        Some(Self { changes })
    }

    /// Returns true without carried bodies.
    pub(crate) fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }

    /// Returns the motion whose bodies are at the flange at a time of the page. Without carried
    /// bodies, no program has this motion.
    pub(crate) fn at(&self, page_s: f64) -> MotionIndex {
        let place = self.changes.partition_point(|it| it.from_s <= page_s + SAME_S);
        let change = self.changes.get(place.saturating_sub(1));
        change.map_or(MotionIndex::new(usize::MAX), |it| it.motion)
    }

    /// Returns the times with bodies that another change replaces at once, with their motions.
    pub(crate) fn passing(&self) -> impl Iterator<Item = (f64, MotionIndex)> {
        let passing = self
            .changes
            .windows(2)
            .filter(|pair| pair[1].from_s <= pair[0].from_s + SAME_S && !pair[0].bodies.is_empty());
        passing.map(|pair| (pair[0].from_s, pair[0].motion))
    }
}

/// Serialises a list of times (`from_s`) with the indices of the bodies from then on.
impl Serialize for BodyTimes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct ChangeView<'a> {
            from_s: f64,
            bodies: &'a [usize],
        }
        serializer.collect_seq(
            self.changes.iter().map(|it| ChangeView { from_s: it.from_s, bodies: &it.bodies }),
        )
    }
}

#[cfg(test)]
mod tests {
    use iiwa_program::{MotionType, Program};
    use iiwa_traj::PieceKind;

    use super::*;

    /// Pick-up at number 3, release and a second pick-up at numbers 5 and 7, at the end.
    fn carried() -> CarriedBodies {
        let sphere = |radius_mm: u32| {
            format!(
                r#"{{ "type": "load", "load": {{ "mass_kg": 1, "shapes": [{{ "type": "sphere",
                    "center_mm": [0, 0, 50], "radius_mm": {radius_mm} }}] }} }}"#
            )
        };
        let text = format!(
            r#"{{ "version": 1, "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }}, "motions": [
                {{ "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 20] }},
                {{ "type": "wait", "seconds": 1 }}, {},
                {{ "type": "ptp", "joints_deg": [0, 0, 0, 0, 0, 0, 40] }},
                {}, {{ "type": "load", "load": null }}, {} ] }}"#,
            sphere(10),
            sphere(20),
            sphere(30)
        );
        let program = Program::from_json(&text).unwrap();
        CarriedBodies::new(&program, |_| Err("there are no files".to_owned())).unwrap()
    }

    fn numbers(times: &BodyTimes, at_s: &[f64]) -> Vec<usize> {
        at_s.iter().map(|at_s| times.at(*at_s).number()).collect()
    }

    fn passing(times: &BodyTimes) -> Vec<(f64, usize)> {
        times.passing().map(|(at_s, motion)| (at_s, motion.number())).collect()
    }

    #[test]
    fn plans_have_the_times_of_their_pieces() {
        let piece = |motion, kind, start_s, end_s| PlanPiece {
            motion,
            kind,
            start_s,
            end_s,
            joint: None,
            limit: String::new(),
        };
        let pieces = [
            piece(1, PieceKind::Line, 0.0, 1.0),
            piece(2, PieceKind::Wait, 1.0, 2.0),
            piece(4, PieceKind::Line, 2.0, 3.0),
            piece(4, PieceKind::Settle, 3.0, 3.1),
        ];
        let carried = carried();
        let times = BodyTimes::of_plan(&carried, &pieces, true);
        assert_eq!(numbers(&times, &[-1.0, 1.9, 2.0, 3.0, 3.1]), [1, 1, 3, 3, 7]);
        assert_eq!(passing(&times), [(3.1, 5)]);
        let times = BodyTimes::of_plan(&carried, &pieces, false);
        assert_eq!(numbers(&times, &[1.9, 2.0, 4.0]), [1, 3, 3]);
        assert_eq!(BodyTimes::default().at(0.0), MotionIndex::new(usize::MAX));
    }

    #[test]
    fn recordings_have_measured_times() {
        let motion = |number: usize, motion_type, real: Option<[f64; 2]>| MotionTime {
            motion: MotionIndex::new(number - 1),
            motion_type,
            planned_start_s: 0.0,
            planned_s: 1.0,
            real_start_s: real.map(|[start_s, _]| start_s),
            real_s: real.map(|[start_s, end_s]| end_s - start_s),
            error_s: None,
            error_percent: None,
        };
        let (ptp, wait) = (MotionType::Ptp, MotionType::Wait);
        let carried = carried();
        let of = |times: [Option<[f64; 2]>; 3]| {
            let [first, second, third] = times;
            let motions = [motion(1, ptp, first), motion(2, wait, second), motion(4, ptp, third)];
            BodyTimes::of_recording(&carried, &motions)
        };
        let times = of([Some([0.0, 1.0]), Some([1.0, 6.0]), Some([6.0, 7.0])]).unwrap();
        assert_eq!(numbers(&times, &[2.5, 5.9, 6.0, 6.9, 7.0]), [1, 1, 3, 3, 7]);
        assert_eq!(passing(&times), [(7.0, 5)]);
        // Neither the wait nor the first motion has to be known for the pick-up.
        assert!(of([None, None, Some([6.0, 7.0])]).is_some());
        assert!(of([Some([0.0, 1.0]), Some([1.0, 6.0]), None]).is_none());
    }
}
