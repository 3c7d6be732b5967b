//! Sunrise applications: projects, their evaluation, and round trips.

mod evaluation;
mod projects;
mod round_trip;
