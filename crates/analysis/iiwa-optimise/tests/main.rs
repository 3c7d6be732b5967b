//! Advice for programs: each row is confirmed by a plan of the changed program.

// Test helpers may panic.
#![allow(clippy::unwrap_used)]

mod advice;
