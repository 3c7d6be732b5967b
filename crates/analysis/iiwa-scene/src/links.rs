//! Parts of the arm that are checked, and their names.

/// First link whose distances from obstacles are checked. Links 0 and 1 are fixed or rotate about
/// their own axis only: their distances are the same at all poses.
pub(crate) const FIRST_LINK: usize = 2;

/// Link number of a tool.
pub(crate) const TOOL: usize = 8;

/// Link number of a workpiece.
pub(crate) const WORKPIECE: usize = 9;

/// Names of the parts in scenes, for the links from [`FIRST_LINK`] on.
pub(crate) const PARTS: [&str; 8] =
    ["link 2", "link 3", "link 4", "link 5", "link 6", "link 7", "tool", "workpiece"];

/// Part of the arm and obstacle whose distance is ignored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IgnoredPair {
    /// Link, 2 to 7, 8 for the tool, or 9 for the workpiece.
    pub link: usize,
    /// Index of the obstacle in [`Scene::obstacles`](crate::Scene::obstacles).
    pub obstacle: usize,
}

/// Difference in link numbers from which two links may touch each other: within the joint limits,
/// adjacent links and links next but one never do. This is an assumption about these limits, and
/// about a tool that does not reach back to its wrist. Tool and workpiece count as the link after
/// the last one.
const MAY_TOUCH: usize = 3;

/// Returns true if a part of the arm may touch another one with a lower number.
pub(crate) fn may_touch(part: usize, other: usize) -> bool {
    other + MAY_TOUCH <= part.min(TOOL)
}
