//! Limits at every instant, from the trajectory's own polynomials rather than by samples.
//!
//! Between two nodes, p is a polynomial of degree five in time. On lines, so are the joint
//! positions; velocity, acceleration and jerk have degree four at most. Blends are divided into
//! parts for which degree eight suffices, and the maximum of each part is computed exactly.

use iiwa_kin::{Joint, Joints};
use iiwa_path::Segment;
use iiwa_program::LimitKind;
use iiwa_traj::{Piece, Section, Timing, Trajectory};

use crate::{
    bernstein::{Bernstein, COEFFICIENTS, INTERPOLATION, Largest},
    intervals::Interval,
    jumps::jumps,
};

/// Point where a joint is closest to a limit, or exceeds it most.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    /// Ratio of the value to the limit; infinite for NaN.
    pub ratio: f64,
    /// Joint; `None` if all are at rest.
    pub joint: Option<Joint>,
    /// Time from the start of the program, in s.
    pub t_s: f64,
    /// Position in the segment: its share of sigma, 0 to 1.
    pub p: f64,
    /// Position between two nodes, relative to the time interval.
    pub share: f64,
    /// Index of the previous node in its piece, from 0.
    pub node: usize,
    /// Time from that node to the next, in s.
    pub interval_s: f64,
}

/// Threshold: an interval is blurred if rounding of s and of the stamps contributes more than this
/// share of a jerk limit.
pub const BLUR: f64 = 0.01;

/// Extreme limit ratios of a trajectory or a piece.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extremes {
    /// Ratios of each [kind](LimitKind::ALL) to the limits of the motion that the piece belongs to.
    /// Jerk is zero for acceleration-limited stamps, where it has no limit.
    pub clear: [Peak; 3],
    /// Ratios in intervals between nodes so close together that rounding of s and of the stamps
    /// affects the jerk by more than [`BLUR`].
    pub blurred: [Peak; 3],
    /// Largest backward speed along the path, relative to the velocity limit of a joint.
    pub backwards: f64,
    /// Largest jumps between adjacent pieces, rests or intervals: of velocity and, for jerk-limited
    /// stamps, of acceleration, relative to the larger limit of both sides.
    pub jumps: [f64; 2],
}

impl Extremes {
    /// Peaks of each kind, blurred or not.
    #[must_use]
    pub fn peaks(&self) -> [Peak; 3] {
        higher(&self.clear, &self.blurred)
    }

    /// Largest ratios of each kind.
    #[must_use]
    pub fn ratios(&self) -> [f64; 3] {
        self.peaks().map(|peak| peak.ratio)
    }

    /// Returns the worse of two results, for each kind.
    #[must_use]
    pub fn worse(&self, other: &Self) -> Self {
        Self {
            clear: higher(&self.clear, &other.clear),
            blurred: higher(&self.blurred, &other.blurred),
            backwards: self.backwards.max(other.backwards),
            jumps: std::array::from_fn(|i| self.jumps[i].max(other.jumps[i])),
        }
    }
}

fn higher(a: &[Peak; 3], b: &[Peak; 3]) -> [Peak; 3] {
    std::array::from_fn(|i| if b[i].ratio > a[i].ratio { b[i] } else { a[i] })
}

/// Returns the extremes of a trajectory that was planned with `timing`.
#[must_use]
pub fn extremes(trajectory: &Trajectory, timing: Timing) -> Extremes {
    let mut worst = Extremes::default();
    for section in trajectory.sections() {
        for piece in section.pieces() {
            worst = worst.worse(&piece_extremes(trajectory, section, piece, timing, &worst));
        }
        worst = worst.worse(&Extremes { jumps: jumps(trajectory, section, timing), ..worst });
    }
    worst
}

/// Returns the extremes of one piece without its seams. Ratios below those of `floor` are not
/// computed exactly, which is faster.
#[must_use]
pub fn piece_extremes(
    trajectory: &Trajectory,
    section: &Section,
    piece: &Piece,
    timing: Timing,
    floor: &Extremes,
) -> Extremes {
    let Some(segment) = section.segment(piece) else { return Extremes::default() };
    let limits = trajectory.path().limits_of(piece.step);
    let mut over = LimitKind::ALL.map(|kind| limits.of(kind).map(|limit| 1.0 / limit));
    if !matches!(timing, Timing::Jerk(_)) {
        over[2] = [0.0; 7];
    }
    let mut search = Search {
        segment,
        inverse_limits: over,
        peaks: [&floor.clear, &floor.blurred]
            .map(|peaks| peaks.map(|Peak { ratio, .. }| Peak { ratio, ..Peak::default() })),
        backwards: floor.backwards,
        node: 0,
        is_blurred: false,
    };
    let nodes = section.nodes(piece);
    for (node, pair) in nodes.windows(2).enumerate() {
        search.node = node;
        search.interval(&Interval::between(&pair[0], &pair[1]));
    }
    for peak in search.peaks.as_flattened_mut() {
        if peak.joint.is_none() {
            *peak = Peak::default();
            continue;
        }
        let from = &nodes[peak.node];
        peak.interval_s = from.dt_s;
        peak.t_s = section.start_s() + from.t_s + peak.share * peak.interval_s;
    }
    let [clear, blurred] = search.peaks;
    Extremes { clear, blurred, backwards: search.backwards, jumps: [0.0; 2] }
}

/// Precision at which degree eight suffices for a part: the error relative to the limit, or to the
/// magnitude of the function if larger.
const PRECISION: f64 = 1e-10;

/// Maximum number of bisections: no function in use needs more than a few.
const HALVINGS: u32 = 12;

/// Search for the extremes of one piece.
struct Search<'a> {
    segment: &'a dyn Segment,
    /// Reciprocals of the velocity, acceleration and jerk limits.
    inverse_limits: [Joints; 3],
    /// Clear and blurred peaks.
    peaks: [[Peak; 3]; 2],
    backwards: f64,
    /// Node before the interval.
    node: usize,
    /// `true` if rounding affects the interval.
    is_blurred: bool,
}

impl Search<'_> {
    fn interval(&mut self, interval: &Interval) {
        let dq = self.segment.at_share(interval.p(0.0)).dq;
        self.is_blurred = self.steepest(2, &dq).0 * interval.rounding() > BLUR;
        if self.segment.is_straight() {
            self.line(interval, &dq);
        } else {
            self.part(interval, 0.0, 1.0, HALVINGS);
        }
        let slope = self.steepest(0, &dq).0;
        if slope > 0.0
            && let Some(back) = interval.rate().largest(|v| -v, self.backwards / slope)
        {
            self.backwards = self.backwards.max(back.value * slope);
        }
    }

    /// Returns the joint whose derivative is the largest relative to its limit, and the ratio.
    fn steepest(&self, kind: usize, dq: &Joints) -> (f64, Option<Joint>) {
        let mut steepest = (0.0, None);
        for joint in Joint::ALL {
            let j = joint.index();
            let share = dq[j].abs() * self.inverse_limits[kind][j];
            if share > steepest.0 {
                steepest = (share, Some(joint));
            }
        }
        steepest
    }

    /// Searches a line, where all joints are proportional to p: one of them is critical.
    fn line(&mut self, interval: &Interval, dq: &Joints) {
        for (kind, powers) in interval.line().iter().enumerate() {
            let (slope, joint) = self.steepest(kind, dq);
            let polynomial = Bernstein::from_powers(&powers.map(|c| slope * c));
            if let Some(largest) = polynomial.largest(f64::abs, self.floor(kind)) {
                self.record_peak(interval, kind, joint, largest);
            }
        }
    }

    /// Searches a part of a curve, from `from` on for `width` of the interval's parameter.
    fn part(&mut self, interval: &Interval, from: f64, width: f64, halvings: u32) {
        let mut values = [[[0.0; 8]; COEFFICIENTS]; 3];
        let mut largest = [1.0_f64; 3];
        for (k, place) in INTERPOLATION.places.iter().enumerate() {
            let t = from + width * place;
            let rows = interval.functions(t, self.segment, &self.inverse_limits);
            for (kind, row) in rows.into_iter().enumerate() {
                largest[kind] = row.iter().fold(largest[kind], |max, v| max.max(v.abs()));
                values[kind][k] = row;
            }
        }
        let is_exact =
            || (0..3).all(|kind| INTERPOLATION.is_exact(&values[kind], PRECISION * largest[kind]));
        // NaN remains NaN, however short the part.
        let is_finite = values.iter().flatten().flatten().all(|v| v.is_finite());
        if is_finite && halvings > 0 && !is_exact() {
            let half = 0.5 * width;
            self.part(interval, from, half, halvings - 1);
            self.part(interval, from + half, half, halvings - 1);
            return;
        }
        for (kind, values) in values.iter().enumerate() {
            let polynomials = INTERPOLATION.polynomials(values);
            for (joint, polynomial) in Joint::ALL.into_iter().zip(&polynomials) {
                if let Some(Largest { value, parameter }) =
                    polynomial.largest(f64::abs, self.floor(kind))
                {
                    let located = Largest { value, parameter: from + width * parameter };
                    self.record_peak(interval, kind, Some(joint), located);
                }
            }
        }
    }

    /// Returns the largest ratio so far.
    fn floor(&self, kind: usize) -> f64 {
        self.peaks[usize::from(self.is_blurred)][kind].ratio
    }

    fn record_peak(
        &mut self,
        interval: &Interval,
        kind: usize,
        joint: Option<Joint>,
        largest: Largest,
    ) {
        self.peaks[usize::from(self.is_blurred)][kind] = Peak {
            ratio: largest.value,
            joint,
            p: interval.p(largest.parameter),
            share: largest.parameter,
            node: self.node,
            ..Peak::default()
        };
    }
}

#[cfg(test)]
mod tests {
    use iiwa_kin::Robot;
    use iiwa_path::{JointPath, Line};
    use iiwa_traj::{Node, SweepOptions};
    use proptest::{
        prelude::ProptestConfig,
        strategy::{Strategy, ValueTree},
        test_runner::{RngSeed, TestRunner},
    };

    use super::*;
    use crate::random::programs;

    fn node(t_s: f64, p: f64) -> Node {
        Node { t_s, p, dt_s: 2.0, dp: 1.0, ..Node::default() }
    }

    /// Tests a motion from rest to rest in 2 s: s = 10 f^3 - 15 f^4 + 6 f^5 with f = t / 2 s. By
    /// hand, its largest derivatives by f are 15/8 at 1/2, 10 / sqrt(3) at (1 - 1 / sqrt(3)) / 2,
    /// and 60 at the start.
    #[test]
    fn rest_to_rest_by_hand() {
        let line = Line::new([0.0; 7], [0.0, -0.5, 0.0, 0.25, 0.0, 0.0, 0.0]);
        let mut search = Search {
            segment: &line,
            inverse_limits: [[2.0; 7], [0.5; 7], [4.0; 7]],
            peaks: [[Peak::default(); 3]; 2],
            backwards: 0.0,
            node: 0,
            is_blurred: false,
        };
        search.interval(&Interval::between(&node(1.0, 0.0), &node(3.0, 1.0)));
        let root = 3.0_f64.sqrt();
        let expected = [
            (2.0 * 0.5 * 15.0 / 8.0 / 2.0, 0.5),
            (0.5 * 0.5 * 10.0 / root / 4.0, 0.5 * (1.0 - 1.0 / root)),
            (4.0 * 0.5 * 60.0 / 8.0, 0.0),
        ];
        for (actual, (ratio, share)) in search.peaks[0].iter().zip(expected) {
            assert_eq!(actual.joint, Some(Joint::A2));
            assert!((actual.ratio / ratio - 1.0).abs() < 1e-9, "{actual:?}, {ratio}");
            let mirrored = (actual.share - share).abs().min((1.0 - actual.share - share).abs());
            assert!(mirrored < 1e-4, "{actual:?}, {share}");
        }
        assert_eq!(search.backwards, 0.0);
    }

    /// Tests a polynomial that overshoots: its mean speed exceeds 2/s, but the acceleration of
    /// 0.9/s^2 from and to rest is too small.
    #[test]
    fn backward_motion_is_detected() {
        let line = Line::new([0.0; 7], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let mut search = Search {
            segment: &line,
            inverse_limits: [[1.0; 7]; 3],
            peaks: [[Peak::default(); 3]; 2],
            backwards: 0.0,
            node: 0,
            is_blurred: false,
        };
        // s = 8 f^3 - 7 f^4 ends at speed -4.
        let [mut from, mut to] = [node(0.0, 0.0), node(1.0, 1.0)];
        from.dt_s = 1.0;
        to.rate = -4.0;
        search.interval(&Interval::between(&from, &Node { u: [-36.0; 2], ..to }));
        assert!(search.backwards >= 4.0 * (1.0 - 1e-9), "{}", search.backwards);
    }

    /// Compares with a thousand samples of each interval, from the trajectory itself.
    #[test]
    fn as_sampling_says() {
        const SAMPLES: u32 = 1000;
        let config = ProptestConfig { rng_seed: RngSeed::Fixed(7), ..ProptestConfig::default() };
        let mut runner = TestRunner::new(config);
        for _ in 0..if std::env::var_os("IIWASIM_LONG").is_some() { 50 } else { 6 } {
            let program = programs(4).new_tree(&mut runner).unwrap().current();
            let path = JointPath::new(&program, &Robot::default()).unwrap();
            for timing in [Timing::jerk_limited(), Timing::Acceleration(SweepOptions::default())] {
                let trajectory = Trajectory::plan(&path, timing).unwrap();
                let actual = extremes(&trajectory, timing);
                let mut sampled = [0.0_f64; 3];
                for section in trajectory.sections() {
                    for piece in section.pieces() {
                        let limits = path.limits_of(piece.step);
                        for pair in section.nodes(piece).windows(2) {
                            let dt = pair[0].dt_s;
                            // Excludes the ends: rounding may put them into the next interval.
                            for i in 0..SAMPLES {
                                let share = (f64::from(i) + 0.5) / f64::from(SAMPLES);
                                let t_s = section.start_s() + pair[0].t_s + share * dt;
                                let state = section.at(t_s);
                                for j in 0..7 {
                                    let values = [state.dq[j], state.ddq[j], state.dddq[j]];
                                    for (i, kind) in LimitKind::ALL.into_iter().enumerate() {
                                        let ratio = values[i].abs() / limits.of(kind)[j];
                                        sampled[i] = sampled[i].max(ratio);
                                    }
                                }
                            }
                        }
                    }
                }
                let kinds = if matches!(timing, Timing::Jerk(_)) { 3 } else { 2 };
                for kind in 0..kinds {
                    let [actual, sampled] = [actual.ratios()[kind], sampled[kind]];
                    let kind_name = LimitKind::ALL[kind];
                    assert!(
                        sampled <= actual * (1.0 + 1e-7),
                        "{kind_name} {actual}, {sampled} by samples"
                    );
                    // Half a sample from the end of an interval, jerk differs by as much as it
                    // changes.
                    assert!(
                        actual <= sampled * 1.005,
                        "{kind_name} {actual}, {sampled} by samples"
                    );
                }
                assert!(actual.jumps.iter().all(|jump| *jump < 1e-6), "{:?}", actual.jumps);
            }
        }
    }

    /// Checks the position of the peak of a piece.
    #[test]
    fn the_peak_is_where_it_says() {
        let config = ProptestConfig { rng_seed: RngSeed::Fixed(8), ..ProptestConfig::default() };
        let program = programs(6).new_tree(&mut TestRunner::new(config)).unwrap().current();
        let path = JointPath::new(&program, &Robot::default()).unwrap();
        for timing in [Timing::jerk_limited(), Timing::Acceleration(SweepOptions::default())] {
            let trajectory = Trajectory::plan(&path, timing).unwrap();
            for section in trajectory.sections() {
                for piece in section.pieces().iter().filter(|piece| piece.kind.moves()) {
                    let limits = path.limits_of(piece.step);
                    let actual =
                        piece_extremes(&trajectory, section, piece, timing, &Extremes::default());
                    let [velocity, acceleration, _] = actual.peaks();
                    let state = section.at(velocity.t_s);
                    let j = velocity.joint.unwrap().index();
                    let velocity_ratio = state.dq[j].abs() / limits.velocity_rad_s()[j];
                    assert!(
                        (velocity_ratio / velocity.ratio - 1.0).abs() < 1e-6,
                        "{velocity:?}, {velocity_ratio}"
                    );
                    // With acceleration-limited stamps the acceleration jumps, and may be that of
                    // the next interval.
                    if matches!(timing, Timing::Jerk(_)) {
                        let state = section.at(acceleration.t_s);
                        let j = acceleration.joint.unwrap().index();
                        let acceleration_ratio =
                            state.ddq[j].abs() / limits.acceleration_rad_s2()[j];
                        let off = (acceleration_ratio / acceleration.ratio - 1.0).abs();
                        assert!(off < 1e-6, "{acceleration:?}, {acceleration_ratio}");
                    }
                }
            }
        }
    }
}
