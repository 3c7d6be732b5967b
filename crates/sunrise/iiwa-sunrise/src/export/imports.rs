//! Imports of an exported class.

use std::{collections::BTreeSet, fmt::Write as _};

/// Classes and methods of `BasicMotions` that a class uses.
#[derive(Default)]
pub(super) struct ExportedImports {
    basic_motions: BTreeSet<&'static str>,
    classes: BTreeSet<&'static str>,
    /// Classes that Sunrise Workbench generates for the project.
    generated: BTreeSet<String>,
}

impl ExportedImports {
    /// Imports a method of `BasicMotions`.
    pub(super) fn basic_motion(&mut self, method: &'static str) {
        self.basic_motions.insert(method);
    }

    /// Imports a class by its full name.
    pub(super) fn class(&mut self, name: &'static str) {
        self.classes.insert(name);
    }

    /// Imports a class that Sunrise Workbench generates, by its full name.
    pub(super) fn generated(&mut self, name: String) {
        self.generated.insert(name);
    }

    /// Returns the import lines at the head of the class.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        for method in &self.basic_motions {
            let _ = writeln!(
                text,
                "import static com.kuka.roboticsAPI.motionModel.BasicMotions.{method};"
            );
        }
        let generated = self.generated.iter().map(String::as_str);
        let classes: BTreeSet<&str> = self.classes.iter().copied().chain(generated).collect();
        let (java, others): (Vec<&str>, Vec<&str>) =
            classes.iter().partition(|name| name.starts_with("java"));
        for group in [java, others] {
            if !text.is_empty() && !group.is_empty() {
                text.push('\n');
            }
            for name in group {
                let _ = writeln!(text, "import {name};");
            }
        }
        text
    }
}
