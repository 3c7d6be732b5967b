//! Sunrise applications: projects, their evaluation, and round trips.

mod cases;
mod evaluation;
mod functions;
mod java_library;
mod loops;
mod projects;
mod robots;
mod round_trip;
