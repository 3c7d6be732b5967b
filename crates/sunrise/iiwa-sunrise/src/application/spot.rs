//! Frames of objects, which move with their object.

/// Frame of the station.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Spot {
    /// World frame, which is the robot base.
    World,
    Flange,
    /// Frame of the data file's tree, by its index.
    Tree(usize),
    /// Root of a tool or a workpiece, by its index among the created bodies.
    Root(usize),
    /// Frame of a tool or a workpiece, by the indices of the body and of the frame.
    Of(usize, usize),
}

impl Spot {
    /// Returns the index of the tool or workpiece of the frame.
    pub(crate) fn body(self) -> Option<usize> {
        match self {
            Self::Root(body) | Self::Of(body, _) => Some(body),
            Self::World | Self::Flange | Self::Tree(_) => None,
        }
    }
}
