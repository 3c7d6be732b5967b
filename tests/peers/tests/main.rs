//! The crates of the workspace against crates of others, a module each.

#![expect(clippy::unwrap_used, clippy::panic, reason = "a failed test panics")]

mod benches;
mod c_header;
mod json_schema;
mod ruckig;
mod topp_ra;
mod urdf;
mod urdf_cases;
mod viewers;
mod z85;
