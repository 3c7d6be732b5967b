//! How far the TCP goes, and how far it turns, along a segment.

/// First to third derivative by s of the way of the TCP and of the angle by which it turns.
///
/// ```
/// use iiwa_path::ToolWay;
///
/// // 0.3 m in a straight line, evenly parametrised, without a turn.
/// let way = ToolWay { way_m: [0.3, 0.0, 0.0], ..ToolWay::default() };
/// assert_eq!(way.turn_rad, [0.0; 3]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolWay {
    /// Of the way, in m; the first is not negative.
    pub way_m: [f64; 3],
    /// Of the angle, in rad; the first is not negative.
    pub turn_rad: [f64; 3],
}
