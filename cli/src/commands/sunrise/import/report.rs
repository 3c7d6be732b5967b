//! Result of an import, as JSON and as text.

use std::{fmt::Write as _, path::Path};

use iiwa_json::printable;
use iiwa_program::{Motion, Program, Source};
use iiwa_report::{fitted, table};
use iiwa_sunrise::{Import, ImportNote, RefusedImport};
use iiwa_sunrise::{Question, QuestionKind, RobotStatement};
use serde::Serialize;

use crate::terminal;

/// Number of motions shown at the start and at the end of a long program.
const SHOWN: usize = 100;

#[derive(Serialize)]
pub(super) struct ProgramReport {
    project: String,
    application: String,
    /// Robot, by its name in the program.
    robot: Option<String>,
    flange_mm: Option<f64>,
    /// Places in the project that state robot and flange.
    stated: Vec<ReportNote>,
    motions: Vec<MotionRow>,
    questions: Vec<QuestionRow>,
    notes: Vec<ReportNote>,
    #[serde(skip_serializing_if = "Option::is_none")]
    refused: Option<ReportNote>,
    output: Option<String>,
}

#[derive(Serialize)]
struct MotionRow {
    /// Place in the program, from 1.
    index: usize,
    #[serde(rename = "type")]
    kind: &'static str,
    file: String,
    line: u32,
}

#[derive(Serialize)]
struct QuestionRow {
    kind: &'static str,
    asked: String,
    choices: Vec<String>,
    answer: String,
    is_given: bool,
    file: String,
    line: u32,
}

#[derive(Serialize)]
struct ReportNote {
    text: String,
    file: String,
    line: u32,
}

impl ProgramReport {
    /// Creates the report on an imported program, which is in the file `output`.
    pub(super) fn new(project: &Path, import: &Import, output: Option<&Path>) -> Self {
        Self {
            project: project.display().to_string(),
            application: import.application.qualified_name.clone(),
            robot: import.program.robot.clone(),
            flange_mm: flange_mm(&import.program),
            stated: import.statements.iter().map(ReportNote::of_statement).collect(),
            motions: rows(&import.program),
            questions: import.questions.iter().map(QuestionRow::new).collect(),
            notes: import.notes.iter().map(ReportNote::new).collect(),
            refused: None,
            output: output.map(|path| path.display().to_string()),
        }
    }

    /// Creates the report on an application that cannot be planned ahead.
    pub(super) fn refused(project: &Path, refused: &RefusedImport) -> Self {
        let Source { file, line } = refused.source.clone();
        Self {
            project: project.display().to_string(),
            application: refused.application.qualified_name.clone(),
            robot: refused.understood.robot.clone(),
            flange_mm: flange_mm(&refused.understood),
            stated: Vec::new(),
            motions: rows(&refused.understood),
            questions: refused.questions.iter().map(QuestionRow::new).collect(),
            notes: refused.notes.iter().map(ReportNote::new).collect(),
            refused: Some(ReportNote { text: refused.reason.clone(), file, line }),
            output: None,
        }
    }

    /// Describes robot and flange, and the places where the project states them.
    fn robot_text(&self) -> String {
        let Some(robot) = &self.robot else { return String::new() };
        let mut text = format!("Robot {}", printable(robot));
        if let Some(flange_mm) = self.flange_mm {
            let _ = write!(text, ", flange {flange_mm} mm");
        }
        for statement in &self.stated {
            let (file, words) = (printable(&statement.file), printable(&statement.text));
            let _ = write!(text, "\n  {file}:{}: {words}", statement.line);
        }
        text + "\n\n"
    }

    /// Formats the report as text.
    pub(super) fn text(&self) -> String {
        let mut text = self.robot_text();
        if !self.motions.is_empty() {
            let mut table = table(&["motion", "type", "line"]);
            let hidden = self.motions.len().saturating_sub(2 * SHOWN);
            for (place, row) in self.motions.iter().enumerate() {
                if hidden == 0 || place < SHOWN || place >= self.motions.len() - SHOWN {
                    let line = format!("{}:{}", printable(&row.file), row.line);
                    table.add_row([row.index.to_string(), row.kind.to_owned(), line]);
                } else if place == SHOWN {
                    table.add_row(["...".to_owned(), format!("{hidden} more")]);
                }
            }
            let _ = writeln!(text, "{}", fitted(table, terminal::width()));
        }
        if !self.questions.is_empty() {
            let mut table = table(&["question", "answer", "option"]);
            for question in &self.questions {
                table.add_row([
                    printable(&question.asked),
                    printable(&question.shown_answer()),
                    if question.is_given { String::new() } else { printable(&question.option()) },
                ]);
            }
            let _ = write!(text, "\n{}\n", fitted(table, terminal::width()));
        }
        for note in &self.notes {
            let _ = write!(
                text,
                "\n{}:{}: {}",
                printable(&note.file),
                note.line,
                printable(&note.text)
            );
        }
        if !self.notes.is_empty() {
            text.push('\n');
        }
        if let Some(output) = &self.output {
            let _ = write!(text, "\nProgram of {} in {output}\n", printable(&self.application));
        }
        text
    }
}

/// Flange length that the program states, in mm.
fn flange_mm(program: &Program) -> Option<f64> {
    program.workcell.flange_m.map(|length_m| (1e6 * length_m).round() / 1e3)
}

fn rows(program: &Program) -> Vec<MotionRow> {
    let row = |(index, motion): (iiwa_program::MotionIndex, &Motion)| {
        let (file, line) = match program.sources.of(index) {
            Some(Source { file, line }) => (file.clone(), *line),
            None => (String::new(), 0),
        };
        MotionRow { index: index.number(), kind: motion.motion_type().name(), file, line }
    };
    program.entries().map(row).collect()
}

impl QuestionRow {
    fn new(question: &Question) -> Self {
        Self {
            kind: match question.kind {
                QuestionKind::Dialog => "dialog",
                QuestionKind::Input => "input",
                QuestionKind::Robot => "robot",
                QuestionKind::Flange => "flange",
                QuestionKind::Start => "start",
                QuestionKind::Fired => "fired",
                QuestionKind::Time => "time",
                QuestionKind::Tool => "tool",
                _ => "process data",
            },
            asked: question.subject.clone(),
            choices: question.choices.clone(),
            answer: question.answer.clone(),
            is_given: question.is_given,
            file: question.file.clone(),
            line: question.line,
        }
    }

    /// Formats the answer with the text of the button.
    fn shown_answer(&self) -> String {
        let number = self.answer.parse::<usize>().ok();
        match number.and_then(|number| self.choices.get(number)) {
            Some(choice) => format!("{} ({choice})", self.answer),
            None => self.answer.clone(),
        }
    }

    /// Returns the option that gives this answer.
    fn option(&self) -> String {
        let option = match self.kind {
            "dialog" => "--answer",
            "input" => "--input",
            "robot" => return format!("--robot {}", self.answer),
            "flange" => return format!("--flange-mm {}", self.answer),
            "start" => return format!("--start-deg {}", self.answer),
            "fired" => "--fired",
            "time" => "--time",
            "tool" => "--tool",
            _ => "--data",
        };
        format!("{option} \"{}={}\"", self.asked, self.answer)
    }
}

impl ReportNote {
    fn of_statement(statement: &RobotStatement) -> Self {
        let (text, file) = (statement.words.clone(), statement.file.clone());
        Self { text, file, line: statement.line }
    }

    fn new(note: &ImportNote) -> Self {
        let Source { file, line } = note.source.clone();
        Self { text: note.text.clone(), file, line }
    }
}
