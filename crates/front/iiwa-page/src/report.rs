//! A page that shows a plan or a recording: one file, which needs no network.
//!
//! Data flows one way: files are read ([`source`]), the program of a recording is planned
//! ([`attached`]), both are made into curves for the screen ([`planned`], [`measured`], [`clearance`], [`curve`], [`curves`]) and
//! gathered ([`data`]). The scripts draw; what they show is decided here.

mod attached;
mod clearance;
mod curve;
mod curves;
mod data;
mod measured;
mod planned;
mod source;
mod tool;

pub use data::{Extent, Page, PageOptions};
