//! `iiwasim import`.

mod frames;
mod listing;
mod program;
mod report;

use iiwa_sunrise::Project;

use crate::{args::Import, failure::Failure};

/// Imports an application of a project as a program; or the frames and tools of a project without
/// applications, or of a data file.
pub(crate) fn run(options: &Import) -> Result<(), Failure> {
    let folder = &options.project;
    let is_project = folder.is_dir() && !options.frames && Project::has_sources(folder);
    if is_project || options.answering.is_given() {
        if !folder.is_dir() {
            return Err(Failure::input(format!(
                "{} is not a folder: applications are imported from the folder of their project",
                folder.display()
            )));
        }
        return program::run(options);
    }
    frames::run(options)
}
