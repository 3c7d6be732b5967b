//! Sunrise applications: projects, their evaluation, and round trips.

mod cases;
mod evaluation;
mod java_library;
mod loops;
mod projects;
mod robots;
mod round_trip;
