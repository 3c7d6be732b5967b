//! One file a command.

pub(crate) mod bridge;
#[cfg(feature = "opcua")]
mod bridge_opcua;
#[cfg(feature = "ros2")]
mod bridge_ros2;
pub(crate) mod cabinet;
pub(crate) mod compare;
pub(crate) mod completions;
pub(crate) mod drive;
pub(crate) mod experiment;
pub(crate) mod export;
pub(crate) mod fk;
pub(crate) mod history;
pub(crate) mod identify;
pub(crate) mod ik;
pub(crate) mod import;
pub(crate) mod io;
pub(crate) mod keygen;
pub(crate) mod man;
pub(crate) mod plan;
pub(crate) mod record;
pub(crate) mod replay;
pub(crate) mod report;
pub(crate) mod robot;
pub(crate) mod run;
pub(crate) mod schema;
pub(crate) mod sensors;
pub(crate) mod status;
pub(crate) mod stop;
pub(crate) mod twin;
