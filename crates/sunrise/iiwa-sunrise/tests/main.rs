//! Sunrise projects: import, export, source files, applications with their evaluation, and round
//! trips.

mod cases;
mod evaluation;
mod export;
mod export_errors;
mod functions;
mod import;
mod java_library;
mod loops;
mod project;
mod projects;
mod reference_frames;
mod robots;
mod round_trip;
mod signals;
