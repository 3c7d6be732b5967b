//! `iiwasim report`.

use std::path::{Path, PathBuf};

use iiwa_files::interrupt;
use iiwa_json::printable;
use iiwa_log::Positions;
use iiwa_page::{Extent, Page, PageError, PageOptions};

use crate::{
    args::Report,
    arm_files::ArmFiles,
    failure::{Failure, print_note},
    input::{find_robot, scene},
    output,
    output_kind::OutputKind,
};

/// Creates the page, and prints its path.
pub(crate) fn run(options: &Report) -> Result<(), Failure> {
    let target = options.output.clone().unwrap_or_else(|| file_name(&options.file));
    let measured = options.measured.as_deref().map(|path| ("recording", path));
    let around = options.scene.as_deref().map(|path| ("scene", path));
    let urdf = options.arm.urdf.as_deref().map(|path| ("URDF", path));
    let file = [("file", options.file.as_path())].into_iter();
    let read = file.chain(measured).chain(around).chain(urdf);
    output::keep_others(OutputKind::Page, &target, read, "--output")?;
    OutputKind::Page.check_existing(&target)?;
    output::catch_interrupts();
    let robot = options.robot.as_deref().map(find_robot).transpose()?;
    let scene = options.scene.as_deref().map(scene).transpose()?;
    let files = ArmFiles::new(&options.arm)?;
    let arm = files.as_ref().map(ArmFiles::source);
    let log = options.log.options(Positions::Measured);
    let (extent, interrupted) = (Extent::Whole, interrupt::has_come);
    let how = PageOptions { robot, arm, scene, log, extent, interrupted };
    let page = Page::read(&options.file, options.measured.as_deref(), &how);
    let page = page.map_err(|error| match (&error, &files) {
        (PageError::Arm { source }, Some(files)) => files.failure(source),
        _ => error.into(),
    })?;
    for note in page.notes() {
        print_note(&format!("Note: {}\n", printable(note)));
    }
    output::write(&target, page.html()?.as_bytes())?;
    output::print(&format!("Page in {}\n", printable(&target.display().to_string())))
}

/// Returns the name of a file's page.
fn file_name(file: &Path) -> PathBuf {
    let mut name = file.file_stem().unwrap_or("report".as_ref()).to_owned();
    name.push(".html");
    PathBuf::from(name)
}
