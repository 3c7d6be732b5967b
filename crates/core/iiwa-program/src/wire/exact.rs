//! Numbers in the units of programs, so that they are read back to the last bit.

/// What to write for `value`, a little off `about`, so that `read` makes the same of it: going from one unit to another and
/// back may be off by a bit. Of values that no number stands for, `about` itself.
pub(super) fn exact(value: f64, about: f64, read: impl Fn(f64) -> f64) -> f64 {
    let near = [about, about.next_up(), about.next_down()];
    near.into_iter().find(|written| read(*written) == value).unwrap_or(about)
}

/// An angle in rad, in degrees.
pub(super) fn exact_deg(rad: f64) -> f64 {
    exact(rad, rad.to_degrees(), f64::to_radians)
}

/// A length in m, in mm.
pub(super) fn exact_mm(m: f64) -> f64 {
    exact(m, 1e3 * m, |mm| 1e-3 * mm)
}

/// A length of the robot in m, in mm: profiles divide by 1000.
pub(super) fn exact_length_mm(m: f64) -> f64 {
    exact(m, 1e3 * m, |mm| mm / 1e3)
}

/// A share, in per cent.
pub(super) fn exact_percent(share: f64) -> f64 {
    exact(share, 100.0 * share, |percent| percent / 100.0)
}
