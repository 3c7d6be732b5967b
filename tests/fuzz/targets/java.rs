//! Java files of Sunrise projects, in any encoding: read, and their applications evaluated.

#![no_main]

use iiwa_sunrise::{Application, ImportOptions, import};
use iiwa_sunrise::{Project, SourceFault};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|contents: &[u8]| {
    let Ok(project) = Project::from_texts([("src/Application.java", contents)]) else { return };
    for error in project.files().iter().filter_map(|file| file.error()) {
        assert!(error.line >= 1 && error.column >= 1, "{error}");
        assert!(!matches!(error.fault, SourceFault::Parser(_)), "{error}");
    }
    for application in Application::all(&project) {
        let _ = import(&project, Some(&application.qualified_name), &ImportOptions::default());
    }
});
