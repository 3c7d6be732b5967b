//! Parts of the arm that are checked, and their names.

/// First link whose distances from obstacles are checked. Links 0 and 1 are fixed or rotate about
/// their own axis only: their distances are the same at all poses.
pub(crate) const FIRST_LINK: usize = 2;

/// Link number of a tool.
pub(crate) const TOOL: usize = 8;

/// Names of the parts in scenes, for the links from [`FIRST_LINK`] on.
pub(crate) const PARTS: [&str; 7] =
    ["link 2", "link 3", "link 4", "link 5", "link 6", "link 7", "tool"];

/// Part of the arm and obstacle whose distance is ignored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IgnoredPair {
    /// Link, 2 to 7, or 8 for the tool.
    pub link: usize,
    /// Index of the obstacle in [`Scene::obstacles`](crate::Scene::obstacles).
    pub obstacle: usize,
}

/// Difference in link numbers from which two links may touch each other: within the joint limits,
/// adjacent links and links next but one never do. This is an assumption about these limits, and
/// about a tool that does not reach back to its wrist. The tool counts as the link after the last
/// one.
pub(crate) const MAY_TOUCH: usize = 3;
