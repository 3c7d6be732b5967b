//! Applications of a project, and the information each requires.

use std::{fmt::Write as _, path::Path};

use iiwa_report::{fitted, table};
use iiwa_sunrise::{Application as Found, Import, ImportError};
use serde::Serialize;

use crate::{failure::Failure, output, sunrise::ApplicationArgs, terminal};

#[derive(Serialize)]
struct ListedApplication {
    application: String,
    file: String,
    line: u32,
    /// Number of motions; null without a program.
    motions: Option<usize>,
    /// Number of questions of the application.
    questions: usize,
    /// Reason for a missing program.
    #[serde(skip_serializing_if = "Option::is_none")]
    refused: Option<String>,
}

/// Lists the applications; the user must choose one.
pub(super) fn run(
    folder: &Path,
    project: &ApplicationArgs,
    applications: Vec<Found>,
    json: bool,
) -> Result<(), Failure> {
    let names: Vec<_> =
        applications.iter().map(|application| application.qualified_name.clone()).collect();
    let rows: Vec<_> = applications
        .into_iter()
        .map(|application| {
            // The file name distinguishes copies of an application.
            let copies = names.iter().filter(|name| **name == application.qualified_name).count();
            let name = if copies > 1 { &application.file } else { &application.qualified_name };
            let (motions, questions, refused) = match project.import(Some(name)) {
                Ok(Import { program, questions, .. }) => {
                    (Some(program.motions.len()), questions.len(), None)
                }
                Err(ImportError::Refused(refused)) => {
                    let place = &refused.source;
                    let reason = format!("{place}: {}", refused.reason);
                    (None, refused.questions.len(), Some(reason))
                }
                Err(error) => (None, 0, Some(error.to_string())),
            };
            let (file, line) = (application.file, application.line);
            ListedApplication {
                application: application.qualified_name,
                file,
                line,
                motions,
                questions,
                refused,
            }
        })
        .collect();
    if json {
        output::print_json(&rows)?;
    } else {
        output::print(&text(&rows))?;
    }
    Err(Failure::input(format!(
        "{} has {} applications; name one with --application",
        folder.display(),
        rows.len()
    )))
}

fn text(rows: &[ListedApplication]) -> String {
    let mut table = table(&["application", "motions", "questions", "line"]);
    for row in rows {
        let motions = row.motions.map_or_else(|| "none".to_owned(), |count| count.to_string());
        let line = format!("{}:{}", row.file, row.line);
        table.add_row([row.application.clone(), motions, row.questions.to_string(), line]);
    }
    let mut text = format!("{}\n", fitted(table, terminal::width()));
    for row in rows {
        if let Some(reason) = &row.refused {
            let _ = write!(text, "\n{} cannot be planned ahead. {reason}\n", row.application);
        }
    }
    text
}
