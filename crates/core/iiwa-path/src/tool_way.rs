//! Path length and angle of the TCP along a segment.

/// First to third derivative by s of the TCP path length and of the angle by which the TCP turns.
///
/// ```
/// use iiwa_path::ToolWay;
///
/// // 0.3 m in a straight line, evenly parameterised, without rotation.
/// let way = ToolWay { way_m: [0.3, 0.0, 0.0], ..ToolWay::default() };
/// assert_eq!(way.turn_rad, [0.0; 3]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolWay {
    /// Derivatives of the path length, in m; the first is not negative.
    pub way_m: [f64; 3],
    /// Derivatives of the angle, in rad; the first is not negative.
    pub turn_rad: [f64; 3],
}
