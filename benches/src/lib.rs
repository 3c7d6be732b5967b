//! Common parts of the benches: the machine, the programs and the peers for comparison.

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

/// Result of a bench, with any error that prevents it.
pub type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;
