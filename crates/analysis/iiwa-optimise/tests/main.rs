//! Faster programs: each saving is confirmed by a plan of the changed program.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

mod advice;
mod lower_bound;
mod optimum;
mod order;
mod place;
mod production;
mod sequence;
mod untouched;
