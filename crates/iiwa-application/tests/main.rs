//! Sunrise applications: projects, their evaluation, and round trips.

mod cases;
mod evaluation;
mod projects;
mod robots;
mod round_trip;
