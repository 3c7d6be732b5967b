//! The crates of others that the benches are held against find what ours find: the tests of the
//! benches' own modules.

#![expect(
    dead_code,
    unreachable_pub,
    reason = "they are public for the benches, which use the rest"
)]

#[path = "../../../benches/src/dh_product.rs"]
mod dh_product;
#[path = "../../../benches/src/joints.rs"]
mod joints;
#[path = "../../../benches/src/long_program.rs"]
mod long_program;
#[path = "../../../benches/src/reference.rs"]
mod reference;
#[path = "../../../benches/src/topp3.rs"]
mod topp3;
#[path = "../../../benches/src/urdf_chain.rs"]
mod urdf_chain;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;
