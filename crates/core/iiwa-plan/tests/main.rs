//! Sources and requests: robots, limits, files and the places of errors.

mod robots;
mod sources;
