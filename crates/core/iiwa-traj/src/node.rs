//! Nodes of the time parameterisation.

/// Node of a piece. Up to the next node, p is the polynomial of degree five in time that meets
/// both, or the cubic with linear d2p/dt2 if that misses the next node by at most 1e-12 of the way.
/// Under jerk-limited timing, d2p/dt2 is continuous from interval to interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Node {
    /// Time since the start of the section, in s.
    pub t_s: f64,
    /// Time to the next node, in s; 0 at the last node. Unlike differences of `t_s`, it keeps all
    /// digits late in a section.
    pub dt_s: f64,
    /// Position in the piece's segment: share of its sigma, 0 to 1, as input of
    /// [`at_share`](iiwa_path::Segment::at_share).
    pub p: f64,
    /// Change of p to the next node; 0 at the last node. Unlike differences of `p`, it keeps all
    /// digits.
    pub dp: f64,
    /// dp/dt, in 1/s.
    pub rate: f64,
    /// d2p/dt2 just after this node and just before the next one, in 1/s^2.
    pub u: [f64; 2],
}
