//! Page that shows a plan or a recording: a single file that needs no network.
//!
//! Data flow one way: files are read ([`source`]), the program of a recording is planned
//! ([`attached`]), both are converted to curves for the screen ([`planned`], [`measured`],
//! [`clearance`], [`curve`], [`curves`]) and collected ([`data`]). The scripts only draw; this
//! module selects the content.

mod attached;
mod body_times;
mod clearance;
mod compared;
mod curve;
mod curves;
mod data;
mod measured;
mod planned;
mod segments;
mod source;
mod tool;

pub use data::{Extent, Page, PageOptions};
