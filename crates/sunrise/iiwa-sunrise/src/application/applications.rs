//! The applications of a project.

use crate::{Project, Question, QuestionKind};
use iiwa_java::{ClassId, ClassName, Classes};

/// An application of a project: a class that the controller offers to run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Application {
    /// Its class, without the package.
    pub name: String,
    /// Its class, with the package.
    pub qualified_name: String,
    /// The file in which it stands, from the project's folder on.
    pub file: String,
    /// The line in it, from 1.
    pub line: u32,
}

/// The classes of KUKA's from which applications inherit. Background tasks move nothing.
const BASES: [&str; 2] = ["RoboticsAPIApplication", "RoboticsAPITask"];

impl Application {
    /// The applications of a project, in order of their files and lines.
    #[must_use]
    pub fn all(project: &Project) -> Vec<Self> {
        Self::with_classes(&project.classes()).into_iter().map(|(_, own)| own).collect()
    }

    /// A question that concerns the application as a whole.
    pub(crate) fn question(
        &self,
        kind: QuestionKind,
        asked: &str,
        answer: String,
        is_given: bool,
    ) -> Question {
        Question {
            kind,
            asked: asked.to_owned(),
            choices: Vec::new(),
            answer,
            is_given,
            file: self.file.clone(),
            line: self.line,
        }
    }

    /// The same, with their classes.
    pub(crate) fn with_classes(classes: &Classes) -> Vec<(ClassId, Self)> {
        let application = |(id, name): (ClassId, ClassName)| {
            let ClassName { name, qualified_name, file, line } = name;
            (id, Self { name, qualified_name, file, line })
        };
        classes.extending(&BASES).into_iter().map(application).collect()
    }
}
