//! Rotations and unit vectors.

use glam::DVec3 as Vector;

/// Returns the rotation about x, then y, then z, the fixed axes of the reference frame, as three
/// rows.
pub(crate) fn rotation([roll, pitch, yaw]: [f64; 3]) -> [[f64; 3]; 3] {
    let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
}

/// Returns the unit vector along `normal`, for any length of `normal`.
pub(crate) fn unit(normal: [f64; 3]) -> Vector {
    let normal = Vector::from(normal);
    // Scaled first: squares of very large and very small numbers overflow or vanish.
    (normal / normal.abs().max_element()).normalize_or(Vector::Z)
}
