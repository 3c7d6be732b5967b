//! Applications of a project.

use crate::{Project, Question, QuestionKind};
use iiwa_java::{ClassId, ClassName, Classes};

/// Application of a project: a class that the controller offers to run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Application {
    /// Class name without the package.
    pub name: String,
    /// Class name with the package.
    pub qualified_name: String,
    /// Source file, relative to the project folder.
    pub file: String,
    /// Line in the file, from 1.
    pub line: u32,
}

/// KUKA classes from which applications inherit. Background tasks are left out because they do not
/// move the robot.
const BASES: [&str; 2] = ["RoboticsAPIApplication", "RoboticsAPITask"];

impl Application {
    /// Returns the applications of a project, sorted by file and line.
    #[must_use]
    pub fn all(project: &Project) -> Vec<Self> {
        Self::with_classes(&project.classes())
            .into_iter()
            .map(|(_, application)| application)
            .collect()
    }

    /// Creates a question that concerns the application as a whole.
    pub(crate) fn question(
        &self,
        kind: QuestionKind,
        asked: &str,
        answer: String,
        is_given: bool,
    ) -> Question {
        Question {
            kind,
            subject: asked.to_owned(),
            choices: Vec::new(),
            answer,
            is_given,
            file: self.file.clone(),
            line: self.line,
        }
    }

    /// Returns the applications with their class ids.
    pub(crate) fn with_classes(classes: &Classes) -> Vec<(ClassId, Self)> {
        let application = |(id, name): (ClassId, ClassName)| {
            let ClassName { name, qualified_name, file, line } = name;
            (id, Self { name, qualified_name, file, line })
        };
        classes.extending(&BASES).into_iter().map(application).collect()
    }
}
