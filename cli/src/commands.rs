//! One file a command.

pub(crate) mod fk;
pub(crate) mod keygen;
pub(crate) mod plan;
pub(crate) mod robot;
pub(crate) mod schema;
