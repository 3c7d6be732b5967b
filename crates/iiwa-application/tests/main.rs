//! Sunrise applications: projects, their evaluation, and round trips.

mod evaluation;
mod projects;
mod robots;
mod round_trip;
