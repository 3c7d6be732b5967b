//! Sunrise projects: import, export, and source files.

mod export;
mod import;
mod project;
