//! Division of a section into cells.
//!
//! Cells have to be small where the optimum switches: around the instants at which the
//! acceleration-limited stamps switch from one limit to another, in blends, at the ends of blends,
//! and next to rest, where sigma is proportional to t^3. Elsewhere they may be long.

use std::{cell::Cell as Cursor, ops::Range};

use crate::{
    cell::{Cell, CellRows},
    geometry::Geometry,
    limited_segment::{LimitedSegment, SweptNode},
    settings::MeshSettings,
};

const SETTINGS: MeshSettings = crate::settings::SETTINGS.mesh;

/// Cells of a window.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Mesh {
    /// The cell that touches rest at the start of the window, if any: its jerk is constant.
    pub from_rest: Option<Cell>,
    /// The cells in between.
    pub cells: Vec<Cell>,
    /// The cell that touches rest at the end of the window, if any: its jerk is constant.
    pub to_rest: Option<Cell>,
    /// The curve at [`SHARES`] of `cells`.
    pub(crate) geometry: Vec<Geometry>,
    /// The rows of further limits in `cells`.
    pub(crate) rows: CellRows,
}

impl MeshSettings {
    /// Returns sizes for a mesh that is `refinement` times as fine.
    fn refined(self, refinement: f64) -> Self {
        let per = 1.0 / refinement;
        Self {
            switch: self.switch * per,
            fade: self.fade * per,
            blend: self.blend * per,
            blend_end: self.blend_end * per,
            blend_end_growth: self.blend_end_growth * per,
            line: self.line * per,
            turn: self.turn * per,
            turn_growth: self.turn_growth * per,
            rest: self.rest * per,
            rest_growth: self.rest_growth * per,
            rest_bend: self.rest_bend * per,
            row_rad: self.row_rad * per,
            ..self
        }
    }

    /// Upper bound on cell lengths in a segment along which limits change, in rad.
    fn max_length(&self, segment: &LimitedSegment<'_>) -> f64 {
        if segment.has_rows() { self.row_rad } else { f64::INFINITY }
    }
}

/// An instant at which the acceleration-limited stamps switch, and the longest duration of a cell
/// there, in s.
struct Switch {
    t_s: f64,
    longest_s: f64,
}

/// A place in a segment, in rad from its start and from its end. The smaller distance has full
/// precision: next to one end, cells may be shorter than the rounding error of the distance from
/// the other.
#[derive(Clone, Copy, Debug)]
struct MeshPlace {
    start: f64,
    end: f64,
}

impl MeshPlace {
    fn is_nearer_to_start(self) -> bool {
        self.start < self.end
    }

    /// Returns the place `way` further along a segment of this `length`.
    fn after(self, way: f64, length: f64) -> Self {
        if self.is_nearer_to_start() {
            let start = self.start + way;
            Self { start, end: length - start }
        } else {
            let end = self.end - way;
            Self { start: length - end, end }
        }
    }

    /// Distance to `other`, further along the segment.
    fn way_to(self, other: Self) -> f64 {
        if self.is_nearer_to_start() { other.start - self.start } else { self.end - other.end }
    }

    /// The same place on the reversed segment.
    fn reversed(self) -> Self {
        Self { start: self.end, end: self.start }
    }
}

/// The acceleration-limited stamps of a segment by the distance from its start, or from its end if
/// `from_end`.
struct Swept {
    samples: Vec<SweptSample>,
    /// Index of the sample after the last distance that was looked up: the next one is near.
    next: Cursor<usize>,
}

#[derive(Clone, Copy)]
struct SweptSample {
    way: f64,
    x: f64,
    t_s: f64,
}

impl Swept {
    fn new(segment: &LimitedSegment<'_>, from_end: bool) -> Self {
        let sample = |node: &SweptNode| SweptSample {
            way: segment.length * if from_end { 1.0 - node.p } else { node.p },
            x: segment.swept_x(node),
            t_s: node.t_s,
        };
        let samples = if from_end {
            segment.swept.iter().rev().map(sample).collect()
        } else {
            segment.swept.iter().map(sample).collect()
        };
        Self { samples, next: Cursor::new(1) }
    }

    /// x and time at the distance `way`, for constant acceleration between samples.
    fn at(&self, way: f64) -> SweptSample {
        let samples = &self.samples;
        let mut next = self.next.get();
        while next + 1 < samples.len() && samples[next].way <= way {
            next += 1;
        }
        while next > 1 && samples[next - 1].way > way {
            next -= 1;
        }
        self.next.set(next);
        let (a, b) = (samples[next - 1], samples[next]);
        let share = ((way - a.way) / (b.way - a.way)).clamp(0.0, 1.0);
        let x = a.x + share * (b.x - a.x);
        let mean = 0.5 * (a.x.sqrt() + x.sqrt());
        let seconds = share * (b.way - a.way) / mean.max(f64::MIN_POSITIVE);
        SweptSample { way, x, t_s: a.t_s + seconds.copysign(b.t_s - a.t_s) }
    }
}

/// Builds the mesh of the segments in `part`. Each of its ends is at rest or continues in the
/// neighbouring segment. Returns `None` if all cells touch rest, or if there are far too many
/// cells.
pub(crate) fn mesh(
    segments: &[LimitedSegment<'_>],
    part: Range<usize>,
    [starts_at_rest, ends_at_rest]: [bool; 2],
    refinement: f64,
) -> Option<Mesh> {
    let sizes = SETTINGS.refined(refinement);
    let switches = switches(&segments[part.clone()], sizes.switch);
    let mut cells = Vec::new();
    let mut near = 0..0;
    for index in part.clone() {
        let segment = &segments[index];
        let backwards = ends_at_rest && index + 1 == part.end;
        let swept = &Swept::new(segment, backwards);
        // Two more switches on either side of the segment, for looking ahead.
        let [start, .., end] = segment.swept else { return None };
        near.start += switches[near.start..].partition_point(|switch| switch.t_s < start.t_s);
        near.end = near.end.max(near.start);
        near.end += switches[near.end..].partition_point(|switch| switch.t_s <= end.t_s);
        let near = &switches[near.start.saturating_sub(2)..(near.end + 2).min(switches.len())];

        let rest = |rests: bool, s: f64| {
            let [_, _, jerk] = segment.straight(s);
            let build_up = jerk * segment.build_up_s(s).powi(3) / 6.0;
            let way = sizes.rest * build_up.min(segment.length / 6.0);
            rests.then(|| way.min(segment.even_way(s, sizes.rest_bend)))
        };
        let from_rest = rest(starts_at_rest && index == part.start, 0.0);
        let to_rest = rest(backwards, 1.0);
        let end_size = |neighbour: Option<&LimitedSegment<'_>>| {
            let end_length = |segment: &LimitedSegment<'_>| {
                let size = if segment.is_line() { sizes.line } else { sizes.blend_end };
                (size * segment.length).min(sizes.max_length(segment))
            };
            end_length(segment).min(neighbour.map_or(f64::INFINITY, end_length))
        };
        let at_start = end_size(index.checked_sub(1).map(|before| &segments[before]));
        let at_end = end_size(segments.get(index + 1));
        let size = if segment.is_line() { sizes.line } else { sizes.blend };
        let max_length = (size * segment.length).min(sizes.max_length(segment));
        // Never reached with valid stamps; faulty stamps could make the number of cells unbounded
        // without this bound.
        let min_length =
            1e-3 * [from_rest, to_rest].iter().flatten().fold(max_length, |a, b| a.min(*b));
        let min_length = min_length.min(at_start).min(at_end);
        // The march from the end arrives at the cell that touches rest at the start, which has its
        // largest permitted length.
        let floor = |place: MeshPlace| match from_rest {
            Some(rest) if backwards && place.start <= rest => rest,
            _ => min_length,
        };
        let turn = segment.turn_back();
        let swept_at = |place: MeshPlace| swept.at(if backwards { place.end } else { place.start });
        let size = |place: MeshPlace| {
            let SweptSample { x, t_s, .. } = swept_at(place);
            let duration_s = near
                .iter()
                .map(|near| near.longest_s + sizes.fade * (t_s - near.t_s).abs())
                .fold(f64::INFINITY, f64::min);
            let grown = |rest: Option<f64>, size: f64, way: f64| match rest {
                Some(_) => sizes.rest_growth * way,
                None => size + sizes.blend_end_growth * way,
            };
            max_length
                .min(grown(from_rest, at_start, place.start))
                .min(grown(to_rest, at_end, place.end))
                .min(x.sqrt() * duration_s)
                .min(sizes.turn * turn + sizes.turn_growth * 0.5 * (place.start - place.end).abs())
                .max(floor(place))
        };
        let size = |place: MeshPlace| size(if backwards { place.reversed() } else { place });
        let first = if backwards { to_rest } else { from_rest };
        let mut nodes = march(segment.length, first, size)?;
        if backwards {
            nodes.reverse();
            for node in &mut nodes {
                *node = node.reversed();
            }
        }
        cells.extend(nodes.windows(2).map(|pair| {
            let (from, length) = (pair[0].start, pair[0].way_to(pair[1]));
            let jerk_rel = segment.jerk_rel(from + 0.5 * length);
            Cell { segment: index, from, length, x: swept_at(pair[0]).x, jerk_rel }
        }));
    }
    let to_rest = if ends_at_rest { cells.pop() } else { None };
    let from_rest = if starts_at_rest { Some(cells.remove(0)) } else { None };
    let geometry: Vec<_> = cells.iter().map(|cell| cell.geometry(segments, [0.0, 1.0])).collect();
    let rows = CellRows::new(segments, &cells, &geometry);
    (!cells.is_empty()).then_some(Mesh { from_rest, cells, to_rest, geometry, rows })
}

/// Ratio of the cell size at the end of a step to that at its start, below which the step is
/// halved.
const MIN_SHRINKING: f64 = 0.125;

/// Nodes along `length` at distances of about `size`, which changes little from one node to the
/// next. The first distance is given if the robot is at rest there. Returns `None` if there are too
/// many nodes.
fn march(
    length: f64,
    rest: Option<f64>,
    size: impl Fn(MeshPlace) -> f64,
) -> Option<Vec<MeshPlace>> {
    let mut place = MeshPlace { start: 0.0, end: length };
    let mut nodes = vec![place];
    if let Some(rest) = rest {
        place = place.after(rest, length);
        nodes.push(place);
    }
    let end = MeshPlace { start: length, end: 0.0 };
    let mut size_here = size(place);
    while place.end > 0.0 {
        let after =
            |step: f64| if step < place.way_to(end) { place.after(step, length) } else { end };
        // The step is the smallest of the sizes at its start, middle and end. Its end must not be
        // too far ahead: a small size there would not apply here.
        let mut step = size_here;
        let mut at_end = size(after(step));
        while at_end < MIN_SHRINKING * step {
            step *= 0.5;
            at_end = size(after(step));
        }
        let whole = step;
        step = step.min(at_end);
        step = step.min(size(after(0.5 * step)));
        place = place.after(step, length);
        nodes.push(place);
        // At the place that was looked at before, unless the step was shortened.
        size_here = if step == whole { at_end } else { size(place) };
        if nodes.len() > SETTINGS.max_nodes {
            return None;
        }
    }
    // The last node overshoots: that node, or the one before, is moved to the end, and the others
    // in proportion.
    let n = nodes.len();
    if n > 3 && -nodes[n - 1].end > 0.5 * nodes[n - 2].way_to(nodes[n - 1]) {
        nodes.pop();
    }
    let missing = nodes[nodes.len() - 1].end;
    let fit = length / (length - missing);
    for node in &mut nodes {
        *node = if node.is_nearer_to_start() {
            let start = node.start * fit;
            MeshPlace { start, end: length - start }
        } else {
            let end = (node.end - missing) * fit;
            MeshPlace { start: length - end, end }
        };
    }
    Some(nodes)
}

/// Instants at which the acceleration-limited stamps switch, in order. Cells there last at most
/// `share` of the time in which jerk builds up acceleration.
fn switches(segments: &[LimitedSegment<'_>], share: f64) -> Vec<Switch> {
    let mut switches = Vec::new();
    for segment in segments {
        let mut add = |node: &SweptNode| {
            let build_up_s = segment.build_up_s(segment.s(node.p * segment.length));
            switches.push(Switch { t_s: node.t_s, longest_s: share * build_up_s });
        };
        if segment.is_line() && !segment.has_rows() {
            // The stamps of a line are the instants between its phases: each of them is a switch.
            segment.swept.iter().for_each(add);
            continue;
        }
        let inner = &segment.swept[..segment.swept.len() - 1];
        let largest = inner.iter().map(|n| n.u[0].abs().max(n.u[1].abs())).fold(0.0, f64::max);
        add(&segment.swept[0]);
        for pair in inner.windows(2) {
            if (pair[1].u[0] - pair[0].u[1]).abs() > SETTINGS.switch_jump * largest {
                add(&pair[1]);
            }
        }
        add(&segment.swept[segment.swept.len() - 1]);
    }
    switches
}

#[cfg(test)]
mod tests {
    use iiwa_kin::Robot;
    use iiwa_path::{JointPath, Step};
    use iiwa_program::{Blend, Program};

    use super::*;

    fn lengths(nodes: &[MeshPlace]) -> Vec<f64> {
        nodes.windows(2).map(|pair| pair[0].way_to(pair[1])).collect()
    }

    /// Next to a stop at the end of a segment of length 1, cells are as small as next to a stop at
    /// its start: far below the rounding error of the distance from the start.
    #[test]
    fn both_ends_keep_full_precision() {
        let size = |place: MeshPlace| 1e-20 + 0.25 * place.start.min(place.end);
        let nodes = march(1.0, Some(1e-20), size).unwrap();
        let lengths = lengths(&nodes);
        assert!((lengths[0] / 1e-20 - 1.0).abs() < 0.3, "{:e}", lengths[0]);
        for pair in lengths.windows(2) {
            let ratio = pair[1] / pair[0];
            assert!((0.5..2.0).contains(&ratio), "{:e}, then {:e}", pair[0], pair[1]);
        }
        assert!((lengths.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        let last = nodes[nodes.len() - 1];
        assert!(last.end == 0.0 && lengths[lengths.len() - 1] < 3e-20, "{last:?}");
    }

    /// The size is tiny at the end, and a step reaches beyond it: cells shrink near the end only.
    #[test]
    fn a_tiny_size_ahead_does_not_make_all_cells_tiny() {
        let nodes = march(1.0, None, |place| (1.1 * place.end).max(1e-9)).unwrap();
        assert!(nodes.len() < 100, "{}", nodes.len());
    }

    #[test]
    fn places_keep_the_digits_of_the_nearer_end() {
        let length = 1.0;
        let near_start = MeshPlace { start: 1e-20, end: 1.0 }.after(2e-20, length);
        let near_end = MeshPlace { start: 1.0, end: 3e-20 }.after(2e-20, length);
        assert!((near_start.start / 3e-20 - 1.0).abs() < 1e-14, "{near_start:?}");
        assert!((near_end.end / 1e-20 - 1.0).abs() < 1e-14, "{near_end:?}");
        let way = MeshPlace { start: 1.0, end: 3e-20 }.way_to(near_end);
        assert!((way / 2e-20 - 1.0).abs() < 1e-14, "{way:e}");
    }

    /// Two lines and a blend from rest to rest.
    #[test]
    fn cells_fill_each_segment_and_are_short_next_to_rest() {
        let program = Program::from_deg([0.0; 7])
            .ptp_deg([20.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
            .blend(Blend::Fraction(0.5))
            .ptp_deg([20.0, 20.0, 0.0, 0.0, 0.0, 0.0, 0.0])
            .build();
        let path = JointPath::new(&program, &Robot::default()).unwrap();
        // For brevity, the times start again at 0 in each segment.
        let swept = [0.0, 0.5, 1.0].map(|p| SweptNode { t_s: p, p, rate: 1.0, u: [0.0; 2] });
        let segments: Vec<_> = path
            .steps()
            .iter()
            .filter_map(|step| match step {
                Step::Move { segment, motion, .. } => {
                    let limits = &path.limits()[motion.index()];
                    LimitedSegment::new(segment.as_ref(), limits, &swept)
                }
                _ => None,
            })
            .collect();
        assert_eq!(segments.len(), 3);
        let count = |refinement| {
            let mesh = mesh(&segments, 0..3, [true; 2], refinement).unwrap();
            let [from, to] = [mesh.from_rest.unwrap(), mesh.to_rest.unwrap()];
            let cells: Vec<_> = [from].into_iter().chain(mesh.cells).chain([to]).collect();
            for (index, segment) in segments.iter().enumerate() {
                let segment_cells: Vec<_> =
                    cells.iter().filter(|cell| cell.segment == index).collect();
                let mut sum = 0.0;
                for cell in segment_cells {
                    assert!(cell.length > 0.0 && (cell.from - sum).abs() < 1e-12, "{cell:?}");
                    sum += cell.length;
                }
                let length = segment.length_rad();
                assert!((sum / length - 1.0).abs() < 1e-12, "{index}: {sum} {length}");
                let lengths = cells.iter().filter(|cell| cell.segment == index);
                let longest = lengths.map(|cell| cell.length).fold(0.0, f64::max);
                if index != 1 {
                    let rest = if index == 0 { &from } else { &to };
                    assert!(rest.length < 0.5 * longest, "{index}: {rest:?} {longest}");
                }
            }
            cells.len()
        };
        // Half the cell size doubles the number of cells.
        let (coarse, fine) = (count(1.0), count(2.0));
        assert!((1.7..2.3).contains(&(fine as f64 / coarse as f64)), "{coarse} {fine}");
    }
}
