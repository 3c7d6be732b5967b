//! Applications of Sunrise projects as programs.

use std::path::Path;

use iiwa_json::printable;
use iiwa_kin::Robot;
use iiwa_sunrise::{AnswerValue, Answers, ExportedProject, Project, Question, QuestionKind};
use iiwa_sunrise::{Import, ImportError, ImportOptions, Unanswered};

use crate::{
    args::Answering,
    failure::{Failure, print_note},
    input::{FileText, Input, find_robot, usual_robot},
};

/// Default file of answers, in the project folder.
const ANSWERS_FILE: &str = "iiwasim-answers.toml";

/// Project and import options of an application.
pub(crate) struct ApplicationArgs {
    pub(crate) project: Project,
    pub(crate) options: ImportOptions,
}

impl ApplicationArgs {
    /// Reads the project in a folder, and the import options.
    pub(crate) fn read(
        folder: &Path,
        answering: &Answering,
        robot: Option<&str>,
    ) -> Result<Self, Failure> {
        let project = Project::open(folder).map_err(|error| Failure::input(error.to_string()))?;
        let start_rad = answering.start_deg.map(|deg| deg.map(f64::to_radians));
        let answers = answers(folder, answering)?;
        let robot = given_robot(robot, &answers, answering.answers.as_deref().unwrap_or(folder))?;
        if let Some(start_rad) = &start_rad {
            let usual = robot.as_ref().map_or_else(Robot::default, |(robot, _)| robot.clone());
            let limits = usual.limits();
            limits
                .check(start_rad)
                .map_err(|outside| Failure::input(format!("--start-deg: {outside}")))?;
        }
        let (robot, robot_name) = robot.unzip();
        let flange_m = answering.flange_mm.map(|mm| mm / 1e3);
        Ok(Self {
            project,
            options: ImportOptions { robot, robot_name, flange_m, start_rad, answers },
        })
    }

    /// Imports the named application, or the only one.
    pub(crate) fn import(&self, name: Option<&str>) -> Result<Import, ImportError> {
        iiwa_sunrise::import(&self.project, name, &self.options)
    }
}

/// Returns the program of an application for planning: its text is that of `iiwasim import`.
pub(crate) fn program(
    folder: &Path,
    answering: &Answering,
    robot: Option<&str>,
) -> Result<Input, Failure> {
    if !folder.is_dir() {
        return Err(Failure::input(format!(
            "{} is not a folder: an application is planned from the folder of its project",
            folder.display()
        )));
    }
    let application = ApplicationArgs::read(folder, answering, robot)?;
    let import = application
        .import(answering.application.as_deref())
        .map_err(|error| failure(folder, &error))?;
    // A missing duration has a separate note.
    let is_open = |question: &&Question| !question.is_given && question.kind != QuestionKind::Time;
    for question in import.questions.iter().filter(is_open) {
        let note = format!(
            "{}:{} asks {:?}, answered by {}",
            question.file, question.line, question.subject, question.answer
        );
        print_note(&format!("Note: {}\n", printable(&note)));
    }
    for note in &import.notes {
        let text = with_options(&note.text);
        print_note(&format!("Note: {}\n", printable(&format!("{}: {text}", note.source))));
    }
    Ok(Input::generated(import.application.name, import.program, import.robot))
}

/// Returns the given robot, with its name: from the option, the answers, or the settings.
fn given_robot(
    option: Option<&str>,
    answers: &Answers,
    beside: &Path,
) -> Result<Option<(Robot, String)>, Failure> {
    if let Some(name) = option {
        return Ok(Some((find_robot(name)?, name.to_owned())));
    }
    if let Some(name) = &answers.robot {
        let file = if beside.is_dir() { beside.join(name) } else { beside.with_file_name(name) };
        let name = if file.is_file() { file.display().to_string() } else { name.clone() };
        return Ok(Some((find_robot(&name)?, name)));
    }
    let usual = usual_robot().map(|name| Ok((find_robot(name)?, name.to_owned())));
    usual.transpose()
}

/// Reads the answers from a file and from options, which have priority.
fn answers(folder: &Path, answering: &Answering) -> Result<Answers, Failure> {
    let beside = folder.join(ANSWERS_FILE);
    let file = answering.answers.clone().or_else(|| beside.is_file().then(|| beside.clone()));
    let mut answers = match &file {
        None => Answers::default(),
        Some(file) => {
            let FileText { name, text } = FileText::read(file)?;
            Answers::from_toml(&text)
                .map_err(|error| Failure::in_text(&error.message, &error.place, &name, &text))?
        }
    };
    if answering.answers.is_none() && file.is_some() {
        print_note(&format!("Note: answers are taken from {}\n", beside.display()));
    }
    for given in &answering.answer {
        let (text, numbers) = pair("--answer", given)?;
        let numbers: Result<Vec<_>, _> =
            numbers.split(',').map(|number| number.trim().parse()).collect();
        let numbers = numbers.map_err(|_| {
            Failure::input(format!(
                "--answer {given}: after = is the number of a button, from 0, or several with \
                 commas"
            ))
        })?;
        // Options override the file's answers to the same dialogs.
        answers.dialogs.retain(|known, _| !known.contains(&text));
        answers.dialogs.insert(text, numbers);
    }
    for given in &answering.input {
        let (name, value) = pair("--input", given)?;
        answers.inputs.insert(name, AnswerValue::of_text(value));
    }
    for given in &answering.data {
        let (id, value) = pair("--data", given)?;
        answers.data.insert(id, AnswerValue::of_text(value));
    }
    for given in &answering.fired {
        let (place, values) = pair("--fired", given)?;
        let values: Result<Vec<_>, _> =
            values.split(',').map(|value| value.trim().parse()).collect();
        let values = values.map_err(|_| {
            Failure::input(format!(
                "--fired {given}: after = is true or false, or several of these with commas"
            ))
        })?;
        answers.fired.insert(place, values);
    }
    for given in &answering.time {
        let (place, seconds) = pair("--time", given)?;
        let duration = seconds.trim().parse().ok().and_then(Answers::seconds);
        let fault = || Failure::input(format!("--time {given}: {}", Answers::SECONDS));
        answers.times.insert(place, duration.ok_or_else(fault)?);
    }
    for given in &answering.tool {
        let (name, numbers) = pair("--tool", given)?;
        let numbers: Result<Vec<_>, _> =
            numbers.split(',').map(|number| number.trim().parse()).collect();
        let frame = numbers.ok().and_then(|numbers| Answers::frame(&numbers));
        let fault = || Failure::input(format!("--tool {given}: {}", Answers::FRAME));
        answers.tools.insert(name, frame.ok_or_else(fault)?);
    }
    Ok(answers)
}

/// Splits at the last `=`: dialog texts may contain others.
fn pair<'a>(option: &str, given: &'a str) -> Result<(String, &'a str), Failure> {
    match given.rsplit_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.to_owned(), value)),
        _ => Err(Failure::input(format!("{option} {given}: a name, = and a value are expected"))),
    }
}

/// Options that give answers, with the text that messages use for them: mostly table names of an
/// answer file.
const OPTIONS: [(&str, &str); 6] = [
    ("`[inputs]`", "--input"),
    ("`[data]`", "--data"),
    ("`[fired]`", "--fired"),
    ("`[times]`", "--time"),
    ("`[tools]`", "--tool"),
    ("the start is not given", "--start-deg"),
];

/// Adds to a message about answers the options that give them.
pub(crate) fn with_options(message: &str) -> String {
    let named = OPTIONS.iter().filter(|(table, _)| message.contains(table));
    let options: Vec<_> = named.map(|(_, option)| *option).collect();
    if options.is_empty() {
        return message.to_owned();
    }
    format!("{message} ({} on the command line)", options.join(", "))
}

/// Returns the option that answers a question of an application.
fn option(open: &Unanswered) -> String {
    let Unanswered { kind, subject } = open;
    match kind {
        QuestionKind::Fired => format!("--fired \"{subject}=true\" or \"{subject}=false\""),
        QuestionKind::ProcessData => format!("--data \"{subject}=VALUE\""),
        QuestionKind::Dialog => format!("--answer \"{subject}=N\""),
        _ => format!("--input \"{subject}=VALUE\""),
    }
}

/// Explains why an application is not imported.
pub(crate) fn failure(folder: &Path, error: &ImportError) -> Failure {
    let text = match error {
        ImportError::Refused(refused) => {
            let moves = refused.understood.motions.iter().filter(|motion| motion.moves()).count();
            let up_to = match moves {
                0 => "no motion precedes it".to_owned(),
                1 => "one motion before it was understood".to_owned(),
                _ => format!("{moves} motions before it were understood"),
            };
            let error = with_options(&error.to_string());
            let lacks_file = refused.reason.ends_with(ExportedProject::DATA_FILE);
            let fill_in = if lacks_file && !refused.missing.is_empty() {
                "; iiwasim import --write-data FILE.xml writes one to fill in"
            } else {
                ""
            };
            let options: Vec<_> = refused.unanswered.iter().map(option).collect();
            let options = match options.len() {
                0 => String::new(),
                _ => format!("; give {}", options.join(" or ")),
            };
            format!("{error}{fill_in}{options} ({up_to}; --no-output shows what was understood)")
        }
        ImportError::Several { .. } => format!("{error} with --application"),
        ImportError::Robots(_) => {
            format!("{error}; choose it with --robot {}", Robot::BUILT_IN.join(" or --robot "))
        }
        ImportError::Flanges(_) => format!("{error}; choose it with --flange-mm"),
        ImportError::UnknownRobot(_) => format!("{error}, by --robot"),
        _ => error.to_string(),
    };
    Failure::input(format!("{}: {text}", folder.display()))
}
