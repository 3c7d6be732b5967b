//! Which parts of the arm count, and what they are called.

/// The first link whose distances from obstacles count. Links 0 and 1 stand on the table and turn about their own axis only: how
/// far they are from anything is the same at all poses.
pub(crate) const FIRST_LINK: usize = 2;

/// What a tool is called among links.
pub(crate) const TOOL: usize = 8;

/// The parts in scenes, by their links from [`FIRST_LINK`] on.
pub(crate) const PARTS: [&str; 7] =
    ["link 2", "link 3", "link 4", "link 5", "link 6", "link 7", "tool"];

/// A part of the arm and an obstacle whose distance does not count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IgnoredPair {
    /// The link, 2 to 7, or 8 for the tool.
    pub link: usize,
    /// The obstacle's place in [`Scene::obstacles`](crate::Scene::obstacles).
    pub obstacle: usize,
}

/// Two links of the arm that are as many links apart as this, or more, may touch each other: within the limits of joints, links
/// next to each other and next but one never do. It is an assumption of these limits, and of a tool that does not reach back
/// to its wrist. The tool counts as the link after the last one.
pub(crate) const MAY_TOUCH: usize = 3;
