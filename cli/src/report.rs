//! A page that shows a plan or a recording: one file, which needs no network.
//!
//! Data flows one way: files are read ([`source`]), the program of a recording is planned
//! ([`attached`]), both are made into curves for the screen ([`planned`],
//! [`measured`], [`curve`]), gathered ([`data`]) and put into the page as JSON beside its style and its
//! scripts ([`mod@html`]). The scripts draw; what they show is decided here.

mod attached;
mod curve;
mod data;
mod html;
mod measured;
mod planned;
mod source;

pub(crate) use data::{Extent, Page};
pub(crate) use html::html;
