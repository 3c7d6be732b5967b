//! A coordinate for the translation and rotation of the TCP.

use crate::segment::{Segment, ToolWay, by_sigma};
use iiwa_program::{ByKind, LimitKind, ToolLimits};

/// A value for each coordinate that has limits: the seven joints and, last, the [coordinate of the
/// tool](ToolCoordinate), which is zero where none of its limits holds.
pub type Coordinates = [f64; 8];

/// Tool coordinate w along one segment, which planners limit in the same way as the joints.
///
/// It is one of
/// - s, if the tool moves [evenly](Segment::has_even_tool_way): its limits are those of path length
///   and angle over their rates, whichever is less;
/// - the path length or the angle, if only one of them is limited, or the other is constant;
/// - otherwise an integral of the rate `(l'^8 + (r theta')^8)^(1/8)`, with l the path length,
///   theta the angle and r the ratio of their limits, of velocity if both are limited. The rate
///   bounds both speeds, and exceeds the larger by at most 9 %. Its derivatives bound acceleration
///   and jerk only approximately: where one rate overtakes the other, the smaller one may exceed
///   its acceleration limit.
///
/// ```
/// use iiwa_kin::Joints;
/// use iiwa_path::{Derivatives, Line, Segment, ToolCoordinate, ToolWay};
/// use iiwa_program::{LimitKind, ToolLimits};
///
/// /// A line over which the TCP moves by 0.5 m.
/// #[derive(Debug)]
/// struct Straight(Line);
///
/// impl Segment for Straight {
///     fn at(&self, s: f64) -> Derivatives {
///         self.0.at(s)
///     }
///     fn bend_bound_rad(&self) -> Joints {
///         self.0.bend_bound_rad()
///     }
///     fn tool_way(&self, _: f64) -> ToolWay {
///         ToolWay { way_m: [0.5, 0.0, 0.0], ..ToolWay::default() }
///     }
///     fn has_even_tool_way(&self) -> bool {
///         true
///     }
/// }
///
/// let segment = Straight(Line::new([0.0; 7], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]));
/// assert!(ToolCoordinate::new(&segment, &ToolLimits::NONE).is_none());
/// let mut limits = ToolLimits::NONE;
/// limits.way[LimitKind::Velocity] = 0.25;
/// let coordinate = ToolCoordinate::new(&segment, &limits).expect("its speed is limited");
/// assert_eq!(coordinate.limits()[LimitKind::Velocity], 0.5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolCoordinate {
    form: CoordinateForm,
    limits: ByKind<f64>,
    of_turn: ByKind<bool>,
}

/// Definition of the coordinate on a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
enum CoordinateForm {
    /// s.
    Even,
    Way,
    Turn,
    /// Path length plus angle, in which a rad counts as this many m.
    Both(f64),
}

/// Power p of `(l'^p + (r theta')^p)^(1/p)`.
const POWER: i32 = 8;

/// Number of intervals at whose ends the segment is checked for translation and rotation.
const PLACES: u32 = 16;

impl ToolCoordinate {
    /// Creates the coordinate of `segment` under `limits`. Returns `None` if no limit applies.
    #[must_use]
    pub fn new(segment: &dyn Segment, limits: &ToolLimits) -> Option<Self> {
        let is_limited = |limits: &ByKind<f64>| limits.values().any(|limit| limit.is_finite());
        if !is_limited(&limits.way) && !is_limited(&limits.turn) {
            return None;
        }
        if segment.has_even_tool_way() {
            let ToolWay { way_m: [way, ..], turn_rad: [turn, ..] } = segment.tool_way(0.0);
            // Without motion, a limit is never active.
            let over =
                |limit: f64, rate: f64| if rate > 0.0 { limit / rate } else { f64::INFINITY };
            let lengths = |kind| [over(limits.way[kind], way), over(limits.turn[kind], turn)];
            let coordinate = Self {
                form: CoordinateForm::Even,
                limits: ByKind::from_fn(|kind| {
                    lengths(kind).into_iter().fold(f64::INFINITY, f64::min)
                }),
                of_turn: ByKind::from_fn(|kind| lengths(kind)[1] < lengths(kind)[0]),
            };
            return is_limited(&coordinate.limits).then_some(coordinate);
        }
        let rates = (0..=PLACES).map(|i| segment.tool_way(f64::from(i) / f64::from(PLACES)));
        let [mut way, mut turn] = [0.0_f64; 2];
        for ToolWay { way_m, turn_rad } in rates {
            (way, turn) = (way.max(way_m[0]), turn.max(turn_rad[0]));
        }
        let (form, combined) =
            match (way > 0.0 && is_limited(&limits.way), turn > 0.0 && is_limited(&limits.turn)) {
                (false, false) => return None,
                (true, false) => (CoordinateForm::Way, limits.way),
                (false, true) => (CoordinateForm::Turn, limits.turn),
                (true, true) => {
                    // Without a kind in which both are limited, the ratio is that of the largest
                    // rates on the segment.
                    let ratio = LimitKind::ALL
                        .map(|kind| limits.way[kind] / limits.turn[kind])
                        .into_iter()
                        .find(|ratio| *ratio > 0.0 && ratio.is_finite())
                        .unwrap_or(way / turn);
                    let combined =
                        ByKind::from_fn(|kind| limits.way[kind].min(ratio * limits.turn[kind]));
                    (CoordinateForm::Both(ratio), combined)
                }
            };
        let of_turn = match form {
            CoordinateForm::Even | CoordinateForm::Way => ByKind::default(),
            CoordinateForm::Turn => ByKind::from_array([true; 3]),
            CoordinateForm::Both(ratio) => ByKind::from_fn(|kind| {
                let (way_limit, turn_limit) = (limits.way[kind], ratio * limits.turn[kind]);
                turn_limit / (ratio * turn) < way_limit / way
            }),
        };
        Some(Self { form, limits: combined, of_turn })
    }

    /// Limits, in the unit of the coordinate over s to the power of the [order](LimitKind::order)
    /// of the kind; infinite without a limit. At least one is finite.
    #[must_use]
    pub fn limits(&self) -> &ByKind<f64> {
        &self.limits
    }

    /// True if the limit of a kind is one of the angle, not of the path length; for the sum of
    /// both, the one that is more restrictive at the largest rates.
    #[must_use]
    pub fn is_of_turn(&self, kind: LimitKind) -> bool {
        self.of_turn[kind]
    }

    /// First to third derivative with respect to s, on the `segment` for which the coordinate was
    /// created.
    #[must_use]
    pub fn derivatives(&self, segment: &dyn Segment, s: f64) -> [f64; 3] {
        match self.form {
            CoordinateForm::Even => [1.0, 0.0, 0.0],
            CoordinateForm::Way => segment.tool_way(s).way_m,
            CoordinateForm::Turn => segment.tool_way(s).turn_rad,
            CoordinateForm::Both(ratio) => {
                let ToolWay { way_m, turn_rad } = segment.tool_way(s);
                both(way_m, turn_rad.map(|rate| ratio * rate))
            }
        }
    }

    /// First to third derivative with respect to [sigma](Segment::sigma) in rad, at `s`.
    #[must_use]
    pub fn sigma_derivatives(&self, segment: &dyn Segment, s: f64) -> [f64; 3] {
        let [dw, ddw, dddw] = self.derivatives(segment, s);
        let [one, two, three] = by_sigma(segment.sigma(s), segment.sigma_unit_rad());
        [
            dw * one,
            ddw * one * one + dw * two,
            dddw * one * one * one + 3.0 * ddw * one * two + dw * three,
        ]
    }
}

/// First to third derivative of the sum, from those of the path length and of the angle in the same
/// unit.
fn both(way: [f64; 3], turn: [f64; 3]) -> [f64; 3] {
    let largest = way[0].max(turn[0]);
    if largest <= 0.0 {
        // At rest: the larger of the derivatives.
        return std::array::from_fn(|k| way[k].abs().max(turn[k].abs()));
    }
    // The sum of powers, in units of the larger rate, and its first two derivatives.
    let (p, mut sum) = (f64::from(POWER), [0.0; 3]);
    for [rate, first, second] in [way, turn].map(|rates| rates.map(|rate| rate / largest)) {
        let power = rate.powi(POWER - 2);
        sum[0] += power * rate * rate;
        sum[1] += p * power * rate * first;
        sum[2] += p * power * ((p - 1.0) * first * first + rate * second);
    }
    let [value, first, second] = sum;
    let root = largest * value.powf(1.0 / p);
    let growth = first / value;
    [root, root * growth / p, root / p * (second / value + (1.0 / p - 1.0) * growth * growth)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use iiwa_kin::Joints;

    use crate::segment::Derivatives;

    /// A segment with the path length `s + s^2` and the angle `2 s - s^2`.
    #[derive(Debug)]
    struct Uneven;

    impl Segment for Uneven {
        fn at(&self, s: f64) -> Derivatives {
            let only = |v: f64| [v, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            Derivatives { q: only(s), dq: only(1.0), ddq: [0.0; 7], dddq: [0.0; 7] }
        }

        fn bend_bound_rad(&self) -> Joints {
            [0.0; 7]
        }

        fn tool_way(&self, s: f64) -> ToolWay {
            ToolWay { way_m: [1.0 + 2.0 * s, 2.0, 0.0], turn_rad: [2.0 - 2.0 * s, -2.0, 0.0] }
        }

        /// Differs from s, so that the change of parameter is tested.
        fn sigma(&self, s: f64) -> [f64; 4] {
            [s + 0.5 * s * s, 1.0 + s, 1.0, 0.0]
        }
    }

    fn limits(way: [f64; 3], turn: [f64; 3]) -> ToolLimits {
        ToolLimits { way: ByKind::from_array(way), turn: ByKind::from_array(turn) }
    }

    const NONE: [f64; 3] = [f64::INFINITY; 3];

    #[test]
    fn of_one_only_where_only_one_is_limited() {
        let way = ToolCoordinate::new(&Uneven, &limits([1.0, 2.0, 3.0], NONE)).unwrap();
        assert_eq!(way.derivatives(&Uneven, 0.5), [2.0, 2.0, 0.0]);
        assert!(!way.is_of_turn(LimitKind::Velocity));
        let turn = ToolCoordinate::new(&Uneven, &limits(NONE, [1.0, 2.0, 3.0])).unwrap();
        assert_eq!(turn.derivatives(&Uneven, 0.5), [1.0, -2.0, 0.0]);
        assert!(turn.is_of_turn(LimitKind::Jerk));
        assert_eq!(ToolCoordinate::new(&Uneven, &ToolLimits::NONE), None);
    }

    #[test]
    fn of_both_it_bounds_either_by_little_more() {
        let both = ToolCoordinate::new(&Uneven, &limits([1.0, 9.0, 9.0], [0.5, 1.0, 9.0])).unwrap();
        // A rad counts as 2 m.
        assert_eq!(both.limits().into_array(), [1.0, 2.0, 9.0]);
        for i in 0..=100 {
            let s = f64::from(i) / 100.0;
            let larger = (1.0 + 2.0 * s).max(2.0 * (2.0 - 2.0 * s));
            let [rate, ..] = both.derivatives(&Uneven, s);
            assert!((1.0..1.091).contains(&(rate / larger)), "{rate} {larger}");
        }
    }

    #[test]
    fn derivatives_go_with_each_other() {
        let h = 1e-5;
        let near = |a: f64, b: f64| (a - b).abs() < 1e-6 * (1.0 + a.abs());
        for limits in
            [limits([1.0; 3], [1.0; 3]), limits([1.0; 3], [0.6; 3]), limits([1.0; 3], NONE)]
        {
            let w = ToolCoordinate::new(&Uneven, &limits).unwrap();
            for i in 1..20 {
                let s = f64::from(i) / 20.0;
                let values = [-h, 0.0, h].map(|ds| w.derivatives(&Uneven, s + ds));
                let by_sigma = [-h, 0.0, h].map(|ds| w.sigma_derivatives(&Uneven, s + ds));
                let [_, slope, ..] = Uneven.sigma(s);
                for k in 0..2 {
                    assert!(
                        near((values[2][k] - values[0][k]) / (2.0 * h), values[1][k + 1]),
                        "{values:?}"
                    );
                    let rate = (by_sigma[2][k] - by_sigma[0][k]) / (2.0 * h * slope);
                    assert!(near(rate, by_sigma[1][k + 1]), "{by_sigma:?}");
                }
            }
        }
    }
}
