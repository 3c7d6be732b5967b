//! Data files of Sunrise projects: read, imported and checked.

#![no_main]

use iiwa_kin::Robot;
use iiwa_program::Workcell;
use iiwa_sunrise::{DataFile, ImportedCell};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let Ok(file) = DataFile::from_xml(text) else { return };
    let cell = ImportedCell::new(&file);
    let robot = Robot::default();
    for frame in &cell.frames {
        let _ = frame.check(&robot);
    }
    assert!(Workcell::from_json(&cell.workcell.to_json()).is_ok());
});
