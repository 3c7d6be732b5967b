//! Plans, recordings and live robots of the KUKA LBR iiwa as HTML pages, each a single
//! self-contained file.
//!
//! All results are returned as text. The crate opens the files to show ([`Page::read`]); it writes
//! no files, and serves nothing.
//!
//! - [`Page`] shows a plan, a recording or both. [`twin_page`] is the page that follows a robot.
//! - [`pair_page`] shows the plans before and after a change side by side.
//! - [`ArmSource`] provides the meshes of the arm, [`NearestPlaces`] the points of smallest
//!   clearance.

mod arm_look;
mod nearest;
mod page;
mod page_error;
#[cfg(feature = "optimise")]
mod pair;
mod report;
mod twin;

pub use nearest::{Nearest, NearestPlaces};
pub use page::ArmSource;
pub use page_error::PageError;
#[cfg(feature = "optimise")]
pub use pair::pair_page;
pub use report::{Extent, Page, PageOptions};
pub use twin::{TwinRobot, TwinSetup, twin_page};
