//! What the benches share: what they are run on, and the peers that they are held against.

pub mod dh_product;
pub mod joints;
pub mod long_program;
pub mod machine;
pub mod reference;
#[cfg(feature = "peers")]
pub mod topp3;
#[cfg(feature = "peers")]
pub mod topp_ra;
#[cfg(feature = "peers")]
pub mod urdf_chain;

/// Anything that keeps a bench from running.
pub type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;
