//! The motion from which the solver starts.

/// A sample of a motion along a segment that keeps the limits of velocity and acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SweptNode {
    /// Time, in s, since any instant that all segments share.
    pub t_s: f64,
    /// Share of the segment's sigma, 0 to 1.
    pub p: f64,
    /// dp/dt, in 1/s.
    pub rate: f64,
    /// d2p/dt2 just after this node and just before the next one, in 1/s^2.
    pub u: [f64; 2],
}
