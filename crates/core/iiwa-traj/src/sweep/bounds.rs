//! Constraints at one node of the sweep: the bounds of u are straight lines in x.
//!
//! In the notation of TOPP-RA, a constraint `a u + b x + c <= 0` is an upper bound
//! `u <= -(b x + c) / a` for positive a and a lower bound for negative a.

use iiwa_solver::PathRow;
use pulp::Simd;

pub(super) type Row = [f64; 8];

/// One number for each line: first the joints and the tool with their acceleration limits, then, in
/// groups of eight, the rows of further limits.
pub(super) type Lines<const R: usize> = [Row; R];

/// Largest number of groups of eight lines: one for accelerations and two for rows of further
/// limits.
pub(crate) const MAX_GROUPS: usize = 3;

/// Value above any x or u within the limits.
pub(super) const UNLIMITED: f64 = 1e30;

/// Coefficient a of a further limit, by p in s^2, below which it is rounding. It also keeps the
/// quotients finite.
const MIN_INERTIA: f64 = 1e-12;

/// Constraints at one node: x is at most `cap`, and for each line u is between `-(fall x + below)`
/// and `rise x + above`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds<const R: usize> {
    pub(super) fall: Lines<R>,
    pub(super) rise: Lines<R>,
    pub(super) below: Lines<R>,
    pub(super) above: Lines<R>,
    /// Largest x within the velocity limits.
    pub(super) cap: f64,
    /// Largest |q''| of any joint.
    pub(super) bend: f64,
    /// Usable share of the acceleration limits.
    pub(super) share: f64,
}

impl<const R: usize> Default for Bounds<R> {
    fn default() -> Self {
        let none = [[0.0; 8]; R];
        Self { fall: none, rise: none, below: none, above: none, cap: 0.0, bend: 0.0, share: 0.0 }
    }
}

impl<const R: usize> Bounds<R> {
    /// Sets the lines of the acceleration limits and the velocity cap. `velocity` holds the
    /// acceleration limits over the velocity limits, in 1/s; `h` is the length of the longer
    /// neighbouring interval.
    #[inline(always)]
    pub(super) fn set<S: Simd>(&mut self, simd: S, dq: &Row, ddq: &Row, velocity: &Row, h: f64) {
        let row = |row| S::as_simd_f64s(row).0;
        let (dq, ddq, velocity) = (row(dq), row(ddq), row(velocity));
        let fall = S::as_mut_simd_f64s(&mut self.fall[0]).0;
        let rise = S::as_mut_simd_f64s(&mut self.rise[0]).0;
        let below = S::as_mut_simd_f64s(&mut self.below[0]).0;
        let above = S::as_mut_simd_f64s(&mut self.above[0]).0;
        let [zero, one, tiny, near, beside] =
            [0.0, 1.0, 1.0 / UNLIMITED, 0.5 * h, 1.25 * h].map(|value| simd.splat_f64s(value));
        let (mut fastest, mut bent) = (zero, zero);
        for k in 0..dq.len() {
            let (p, bend) = (simd.abs_f64s(dq[k]), simd.abs_f64s(ddq[k]));
            bent = simd.max_f64s(bent, bend);
            // Where q' changes its sign next to the node, the constraints at the node alone would
            // leave x and u unbounded, and with them speed and acceleration beside the node. q' at
            // a distance of one and a quarter intervals bounds the speed, q' at half an interval in
            // both directions the acceleration.
            let speed = simd.max_f64s(p, simd.mul_f64s(beside, bend));
            fastest = simd.max_f64s(fastest, simd.mul_f64s(velocity[k], speed));
            let nearby = simd.mul_f64s(near, bend);
            let turns = simd.less_than_f64s(p, nearby);
            let (back, against) = (simd.less_than_f64s(dq[k], zero), simd.neg_f64s(ddq[k]));
            let slopes =
                [simd.select_f64s(back, against, ddq[k]), simd.select_f64s(back, ddq[k], against)];
            let half = simd.div_f64s(one, simd.max_f64s(simd.max_f64s(p, nearby), tiny));
            (below[k], above[k]) = (half, half);
            let [down, up] =
                slopes.map(|slope| simd.select_f64s(turns, simd.neg_f64s(bend), slope));
            fall[k] = simd.mul_f64s(down, half);
            rise[k] = simd.mul_f64s(up, half);
        }
        let fastest = simd.reduce_max_f64s(fastest);
        self.cap = if fastest > 1e-15 { 1.0 / (fastest * fastest) } else { UNLIMITED };
        self.bend = simd.reduce_max_f64s(bent);
        self.share = 1.0;
    }

    /// Sets the lines of further limits, after those of accelerations, from their `rows` by p.
    pub(super) fn set_rows(&mut self, rows: &[PathRow]) {
        let Self { fall, rise, below, above, bend, cap, .. } = self;
        let [fall, rise, below, above] =
            [fall, rise, below, above].map(|lines| &mut lines.as_flattened_mut()[8..]);
        // Lines without a row do not constrain u.
        fall.fill(0.0);
        rise.fill(0.0);
        below.fill(UNLIMITED);
        above.fill(UNLIMITED);
        for (line, row) in rows.iter().enumerate() {
            let PathRow { acceleration, square, offset } = *row;
            *bend = max(*bend, square.abs());
            if acceleration == 0.0 {
                // The limit of a speed.
                if square != 0.0 {
                    let room = 1.0 - offset.copysign(offset * square);
                    *cap = cap.min(room / square.abs());
                }
                continue;
            }
            let inverse = 1.0 / acceleration.abs().max(MIN_INERTIA);
            let by_x = square.copysign(square * acceleration) * inverse;
            let offset = offset.copysign(offset * acceleration);
            (fall[line], rise[line]) = (by_x, -by_x);
            (below[line], above[line]) = ((1.0 + offset) * inverse, (1.0 - offset) * inverse);
        }
    }

    /// Lowers the usable share of the acceleration limits and, for further limits, of the limit
    /// minus its offset.
    pub(super) fn lower(&mut self, share: f64) {
        if share != self.share {
            let factor = share / self.share;
            for offset in self.below.iter_mut().chain(&mut self.above).flatten() {
                *offset *= factor;
            }
            self.share = share;
        }
    }

    /// Returns the upper bound of u at `x`.
    #[inline(always)]
    pub(super) fn u_max<S: Simd>(&self, simd: S, x: f64) -> f64 {
        lowest(simd, &self.rise, x, &self.above)
    }

    /// Returns the lower bound of u at `x`.
    #[inline(always)]
    pub(super) fn u_min<S: Simd>(&self, simd: S, x: f64) -> f64 {
        -lowest(simd, &self.fall, x, &self.below)
    }

    /// Returns the largest x, at most `x`, with a feasible u: at which the lower bound of u is not
    /// above the upper bound.
    ///
    /// The width of the feasible range of u is a concave, piecewise linear function of x. Newton's
    /// method approaches its root from the right and ends after a few pieces. `pair` holds the
    /// lines (upper, lower) of the piece to try first and, on return, those of the last piece.
    #[inline(always)]
    pub(super) fn possible<S: Simd>(&self, simd: S, mut x: f64, pair: &mut [usize; 2]) -> f64 {
        const STEPS: usize = 64;
        for _ in 0..STEPS {
            let [j, k] = *pair;
            let at = |lines: &Lines<R>, line: usize| lines.as_flattened()[line];
            let root = (at(&self.above, j) + at(&self.below, k))
                / -(at(&self.rise, j) + at(&self.fall, k));
            if root > 0.0 && root < x {
                x = root;
            }
            let (u_max, brake) = (self.u_max(simd, x), -self.u_min(simd, x));
            if u_max + brake >= 0.0 {
                break;
            }
            let narrowest = [
                place(simd, &self.rise, x, &self.above, u_max),
                place(simd, &self.fall, x, &self.below, brake),
            ];
            if narrowest == *pair {
                break;
            }
            *pair = narrowest;
        }
        x
    }
}

/// Reinterprets the lines as vector registers.
#[inline(always)]
fn flat<S: Simd, const R: usize>(lines: &Lines<R>) -> &[S::f64s] {
    S::as_simd_f64s(lines.as_flattened()).0
}

/// Returns the minimum of the lines `slope x + offset` at `x`.
#[inline(always)]
fn lowest<S: Simd, const R: usize>(simd: S, slopes: &Lines<R>, x: f64, offsets: &Lines<R>) -> f64 {
    let (slopes, offsets) = (flat::<S, R>(slopes), flat::<S, R>(offsets));
    let x = simd.splat_f64s(x);
    let mut lowest = simd.mul_add_e_f64s(slopes[0], x, offsets[0]);
    for k in 1..slopes.len() {
        lowest = simd.min_f64s(lowest, simd.mul_add_e_f64s(slopes[k], x, offsets[k]));
    }
    simd.reduce_min_f64s(lowest)
}

/// Returns the same value as [`lowest`], with `line` as a guess of the minimal line; on return,
/// `line` is that line.
///
/// Each step of a sweep depends on the result of the last one. The active constraint is most often
/// that of the last node: with its line as a guess, the processor continues speculatively while it
/// compares all lines.
#[inline(always)]
fn lowest_by<S: Simd, const R: usize>(
    simd: S,
    slopes: &Lines<R>,
    x: f64,
    offsets: &Lines<R>,
    line: &mut usize,
) -> f64 {
    let (slope, offset) = (slopes.as_flattened()[*line], offsets.as_flattened()[*line]);
    // Rounds as `lowest` does, so that equal lines compare equal.
    let likely = if S::IS_SCALAR { slope * x + offset } else { slope.mul_add(x, offset) };
    let lowest = lowest(simd, slopes, x, offsets);
    if lowest < likely {
        *line = place(simd, slopes, x, offsets, lowest);
        return lowest;
    }
    likely
}

/// Returns the largest x, at most `cap`, with `x - h lowest(x) <= c`, and the minimum of the lines
/// there.
///
/// `lines` holds guesses of the line that limits x and of the minimal line there, which are the
/// same unless x is `cap`; on return it holds the actual lines. With any line as the limiting one,
/// x is too large or exact, as in Newton's method.
#[inline(always)]
pub(super) fn largest<S: Simd, const R: usize>(
    simd: S,
    [slopes, offsets]: [&Lines<R>; 2],
    h: f64,
    c: f64,
    cap: f64,
    lines: &mut [usize; 2],
) -> (f64, f64) {
    // Up to rounding, each line is the limiting one at most once.
    const STEPS: usize = 16;
    let mut limit = (0.0, 0.0);
    for _ in 0..STEPS {
        let limiting = lines[0];
        // Without a positive factor the line does not limit x.
        let inverse = 1.0 / max(1.0 - h * slopes.as_flattened()[limiting], 1e-9);
        let x = min((c + h * offsets.as_flattened()[limiting]) * inverse, cap);
        let lowest = lowest_by(simd, slopes, x, offsets, &mut lines[1]);
        limit = (x, lowest);
        if lines[1] == limiting || x - h * lowest <= c {
            break;
        }
        lines[0] = lines[1];
    }
    limit
}

/// Indices of lines as floating-point numbers, so that the minimum can be taken in vector
/// registers.
const PLACES: [f64; 8 * MAX_GROUPS] = {
    let mut places = [0.0; 8 * MAX_GROUPS];
    let mut i = 1;
    while i < places.len() {
        places[i] = places[i - 1] + 1.0;
        i += 1;
    }
    places
};

/// Returns the index of the first line whose value is `lowest` at `x`; 0 if the values are not
/// numbers.
#[inline(always)]
fn place<S: Simd, const R: usize>(
    simd: S,
    slopes: &Lines<R>,
    x: f64,
    offsets: &Lines<R>,
    lowest: f64,
) -> usize {
    let (slopes, offsets) = (flat::<S, R>(slopes), flat::<S, R>(offsets));
    let (x, lowest) = (simd.splat_f64s(x), simd.splat_f64s(lowest));
    let none = simd.splat_f64s((8 * R) as f64);
    let mut first = none;
    for (k, places) in S::as_simd_f64s(&PLACES).0.iter().enumerate().take(slopes.len()) {
        let value = simd.mul_add_e_f64s(slopes[k], x, offsets[k]);
        let is_lowest = simd.less_than_or_equal_f64s(value, lowest);
        first = simd.min_f64s(first, simd.select_f64s(is_lowest, *places, none));
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "it is one of the places, or as many as there are"
    )]
    let first = simd.reduce_min_f64s(first) as usize;
    first % (8 * R)
}

/// Returns the lesser of two numbers, in one instruction (`f64::min` also handles NaN).
#[inline(always)]
pub(crate) fn min(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Returns the greater of two numbers, in one instruction (`f64::max` also handles NaN).
#[inline(always)]
pub(crate) fn max(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
