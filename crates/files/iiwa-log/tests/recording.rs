//! Recordings through the public interface: written, read back, and damaged.

#![expect(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a failed test is a panic, and what is read back is what was written, bit by bit"
)]

mod compression;
mod damage;
mod kill;
mod names;
mod recorder;
mod round_trip;
mod sample;
mod whole;
