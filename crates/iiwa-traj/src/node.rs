//! Samples at which stamps are found.

/// A sample of a piece. Until the next one d2s/dt2 changes linearly with s; under jerk-limited timing, s is
/// a polynomial of degree five in time, so that d2s/dt2 continues.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Time since the start of the section, in s.
    pub t_s: f64,
    /// Path parameter within the piece's segment, 0 to 1.
    pub s: f64,
    /// ds/dt, in 1/s.
    pub rate: f64,
    /// d2s/dt2 just after this node and just before the next one, in 1/s^2.
    pub u: [f64; 2],
}
