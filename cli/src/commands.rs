//! One file per command; commands of an optional feature share a folder.

#[cfg(feature = "bridge")]
pub(crate) mod brokers;
pub(crate) mod compare;
pub(crate) mod completions;
pub(crate) mod diff;
pub(crate) mod fk;
pub(crate) mod identify;
pub(crate) mod ik;
#[cfg(feature = "live")]
pub(crate) mod live;
pub(crate) mod man;
pub(crate) mod plan;
pub(crate) mod report;
pub(crate) mod robot;
pub(crate) mod schema;
#[cfg(feature = "optimise")]
pub(crate) mod search;
#[cfg(feature = "sunrise")]
pub(crate) mod sunrise;
pub(crate) mod validate;
