//! Applications of Sunrise projects as programs.

use std::path::Path;

use iiwa_application::{Import, ImportError, ImportOptions};
use iiwa_kin::Robot;
use iiwa_program::Program;
use iiwa_sunrise::{AnswerValue, Answers, Project};
use iiwa_view::printable;

use crate::{
    args::Answering,
    failure::{Failure, print_note},
    input::{ProgramText, Text, default_robot, find_robot},
};

/// The file of answers that is beside a project's sources.
const ANSWERS_FILE: &str = "iiwasim-answers.toml";

/// What of an application has to be said beside its name.
pub(crate) struct Application {
    pub(crate) project: Project,
    pub(crate) options: ImportOptions,
}

impl Application {
    /// The project in a folder, and how its applications are imported.
    pub(crate) fn read(
        folder: &Path,
        answering: &Answering,
        robot: Option<&str>,
    ) -> Result<Self, Failure> {
        let project = Project::open(folder).map_err(|error| Failure::input(error.to_string()))?;
        let start_rad = answering.start_deg.map(|deg| deg.map(f64::to_radians));
        let usual = robot.map_or_else(default_robot, find_robot)?;
        if let Some(start_rad) = &start_rad {
            let limits = usual.limits();
            limits
                .check(start_rad)
                .map_err(|outside| Failure::input(format!("--start-deg: {outside}")))?;
        }
        let robot_name = robot_name(&usual, robot);
        let options = ImportOptions {
            robot: (robot.is_some() || robot_name.is_some()).then_some(usual),
            robot_name,
            start_rad,
            answers: answers(folder, answering)?,
        };
        Ok(Self { project, options })
    }

    /// The program of the application that is named, or of the only one.
    pub(crate) fn import(&self, name: Option<&str>) -> Result<Import, ImportError> {
        iiwa_application::import(&self.project, name, &self.options)
    }
}

/// The program of an application, for planning: its text is what `iiwasim import` writes.
pub(crate) fn program(
    folder: &Path,
    answering: &Answering,
    robot: Option<&str>,
) -> Result<(ProgramText, Program, Robot), Failure> {
    if !folder.is_dir() {
        return Err(Failure::input(format!(
            "{} is no folder: an application is planned from the folder of its project",
            folder.display()
        )));
    }
    let application = Application::read(folder, answering, robot)?;
    let import = application
        .import(answering.application.as_deref())
        .map_err(|error| failure(folder, &error))?;
    for question in import.questions.iter().filter(|question| !question.is_given) {
        print_note(&printable(&format!(
            "Note: {}:{} asks {:?}, answered by {}\n",
            question.file, question.line, question.asked, question.answer
        )));
    }
    for note in &import.notes {
        print_note(&printable(&format!("Note: {}: {}\n", note.source, note.text)));
    }
    let text = ProgramText::made(import.application.name, import.program.to_json());
    let robot = match (application.options.robot, &import.program.robot) {
        (Some(robot), _) => robot,
        (None, Some(name)) => find_robot(name)?,
        (None, None) => Robot::default(),
    };
    Ok((text, import.program, robot))
}

/// What a program calls the robot: nothing if it is the default one.
fn robot_name(robot: &Robot, given: Option<&str>) -> Option<String> {
    let is_default = robot.name() == Robot::default().name();
    let name = given.map_or_else(|| robot.name().to_owned(), str::to_owned);
    (!is_default).then_some(name)
}

/// What is answered: by a file, and by options, which win.
fn answers(folder: &Path, answering: &Answering) -> Result<Answers, Failure> {
    let beside = folder.join(ANSWERS_FILE);
    let file = answering.answers.clone().or_else(|| beside.is_file().then(|| beside.clone()));
    let mut answers = match &file {
        None => Answers::default(),
        Some(file) => {
            let Text { name, text } = Text::read(file)?;
            Answers::from_toml(&text)
                .map_err(|error| Failure::in_text(&error.what, &error.at, &name, &text))?
        }
    };
    if answering.answers.is_none() && file.is_some() {
        print_note(&format!("Note: answers are taken from {}\n", beside.display()));
    }
    for given in &answering.answer {
        let (text, numbers) = pair("--answer", given)?;
        let numbers: Result<Vec<_>, _> = numbers.split(',').map(|own| own.trim().parse()).collect();
        let numbers = numbers.map_err(|_| {
            Failure::input(format!(
                "--answer {given}: after = is the number of a button, from 0, or several with commas"
            ))
        })?;
        // What the file says of the same dialogs counts no longer.
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
    Ok(answers)
}

/// The sides of the last `=`: texts of dialogs may have some.
fn pair<'a>(option: &str, given: &'a str) -> Result<(String, &'a str), Failure> {
    match given.rsplit_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.to_owned(), value)),
        _ => Err(Failure::input(format!("{option} {given}: a name, = and a value are expected"))),
    }
}

/// Why an application is not imported, for people.
pub(crate) fn failure(folder: &Path, error: &ImportError) -> Failure {
    let text = match error {
        ImportError::Refused(refused) => {
            let moves = refused.understood.motions.iter().filter(|motion| motion.moves()).count();
            let up_to = match moves {
                0 => "no motion comes before it".to_owned(),
                1 => "one motion before it was understood".to_owned(),
                _ => format!("{moves} motions before it were understood"),
            };
            format!("{error} ({up_to}; --no-output shows what was understood)")
        }
        ImportError::Several { .. } => format!("{error} with --application"),
        _ => error.to_string(),
    };
    Failure::input(format!("{}: {text}", folder.display()))
}
