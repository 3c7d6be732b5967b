//! Frames of things: those that move when the thing does.

/// A frame of the station.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Spot {
    /// The world, which is the robot's foot.
    World,
    Flange,
    /// A frame of the data file's tree, by its place among them.
    Tree(usize),
    /// Where a tool or a workpiece begins, by its place among those that were made.
    Root(usize),
    /// A frame of a tool or a workpiece, by its place among its frames.
    Of(usize, usize),
}

impl Spot {
    /// The tool or workpiece of which it is.
    pub(crate) fn body(self) -> Option<usize> {
        match self {
            Self::Root(body) | Self::Of(body, _) => Some(body),
            Self::World | Self::Flange | Self::Tree(_) => None,
        }
    }
}
