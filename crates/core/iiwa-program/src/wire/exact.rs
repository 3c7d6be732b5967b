//! Unit conversion of program numbers such that they read back to the last bit.

/// Number close to `about` from which `read` reproduces `value` exactly; `about` itself if no such
/// number exists. A conversion to another unit and back may be off by one bit.
pub(super) fn exact(value: f64, about: f64, read: impl Fn(f64) -> f64) -> f64 {
    let near = [about, about.next_up(), about.next_down()];
    near.into_iter().find(|written| read(*written) == value).unwrap_or(about)
}

/// Angle in degrees, from rad.
pub(super) fn exact_deg(rad: f64) -> f64 {
    exact(rad, rad.to_degrees(), f64::to_radians)
}

/// Length in mm, from m.
pub(super) fn exact_mm(m: f64) -> f64 {
    exact(m, 1e3 * m, |mm| 1e-3 * mm)
}

/// Robot length in mm, from m. Divides by 1000 as robot profiles do.
pub(super) fn exact_length_mm(m: f64) -> f64 {
    exact(m, 1e3 * m, |mm| mm / 1e3)
}

/// Percentage, from a share.
pub(super) fn exact_percent(share: f64) -> f64 {
    exact(share, 100.0 * share, |percent| percent / 100.0)
}
