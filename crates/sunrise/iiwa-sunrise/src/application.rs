//! Applications of KUKA Sunrise projects as motion programs.
//!
//! [`import`] evaluates an application's Java code without a robot: a station model implements
//! KUKA's classes. It keeps the robot position, the payload and the commanded motions, from which
//! the program is built, each motion with its source line. [`ImportOptions`] answers the
//! application's questions. A value that is needed but only known at run time is an [`ImportError`]
//! with its place and reason.

mod application_api;
mod applications;
mod arguments;
mod arrival;
mod asked;
mod body;
mod dialogs;
mod durations;
mod enum_constant;
mod finish;
mod fired;
mod flange_load;
mod frame_changes;
mod frame_value;
mod frames_api;
mod import;
mod import_error;
mod import_note;
mod import_options;
mod inputs;
mod joints_api;
mod library_api;
mod load_api;
mod missing;
mod motion_setters;
mod motion_value;
mod motions;
mod moves;
#[cfg(test)]
mod offered_tests;
mod opaque_api;
mod platform_api;
mod process_data;
mod robot_api;
#[cfg(test)]
mod robot_api_tests;
mod robot_choice;
mod robot_value;
mod robotics;
mod schedule;
mod signals;
mod spot;
mod station;
mod station_host;
mod station_questions;
mod station_text;
#[cfg(test)]
mod test_station;
mod threads_api;
mod tools_api;
mod user_keys;
mod waits;

pub use applications::Application;
pub use import::{Import, import};
pub use import_error::{ImportError, RefusedImport, Unanswered};
pub use import_note::ImportNote;
pub use import_options::ImportOptions;
pub use missing::Missing;
