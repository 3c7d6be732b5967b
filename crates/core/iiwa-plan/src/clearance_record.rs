//! Clearances in the figures of a plan.

use serde::{Deserialize, Serialize};

/// Smallest distance between the arm and the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClearanceRecord {
    /// Distance in mm; 0 if the arm touches the obstacle.
    pub distance_mm: f64,
    /// Link of the arm, 2 to 7, 8 for the tool, or 9 for the workpiece. Links 0 and 1 have the same
    /// distances at all poses.
    pub link: usize,
    /// Obstacle name.
    pub obstacle: String,
    /// Time, in s.
    pub at_s: f64,
}

/// Smallest distance of the arm from itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SelfClearanceRecord {
    /// Distance in mm; 0 if the two links touch.
    pub distance_mm: f64,
    /// First link, 3 to 7, 8 for the tool, or 9 for the workpiece.
    pub link: usize,
    /// Second link, 0 to 5: at least three numbers lower, since closer links are assumed not to
    /// touch each other.
    pub other_link: usize,
    /// Time, in s.
    pub at_s: f64,
}
