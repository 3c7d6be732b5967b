//! Plans, recordings and live robots of the KUKA LBR iiwa as HTML pages, each one file that loads nothing.
//!
//! Everything comes back as text. The crate opens the files that it is asked to show ([`Page::read`]); it writes none, and
//! serves nothing.
//!
//! - [`Page`] shows a plan, a recording or both. [`twin_page`] is the page that follows a robot.
//! - [`ArmSource`] says where the arm's shape comes from, [`NearestPlaces`] where the arm is nearest to an obstacle.

mod arm_look;
mod nearest;
mod page;
mod page_error;
mod report;
mod twin;

pub use nearest::{Nearest, NearestPlaces};
pub use page::ArmSource;
pub use page_error::PageError;
pub use report::{Extent, Page, PageOptions};
pub use twin::{TwinRobot, TwinSetup, twin_page};
