//! Samples at which stamps are found.

/// A sample of a piece. Until the next one p is the polynomial of degree five in time that meets both, or the cubic
/// that goes from d2p/dt2 here to d2p/dt2 there where it misses the next one by no more than 1e-12 of the way; under
/// jerk-limited timing, d2p/dt2 continues from interval to interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Node {
    /// Time since the start of the section, in s.
    pub t_s: f64,
    /// Time to the next node, in s; of the last one, 0. Not rounded by how late it is.
    pub dt_s: f64,
    /// Where it is in the piece's segment: share of its sigma, 0 to 1, as
    /// [`at_share`](iiwa_path::Segment::at_share) takes it.
    pub p: f64,
    /// Change of p to the next node; of the last one, 0. Not rounded by how far along it is.
    pub dp: f64,
    /// dp/dt, in 1/s.
    pub rate: f64,
    /// d2p/dt2 just after this node and just before the next one, in 1/s^2.
    pub u: [f64; 2],
}
