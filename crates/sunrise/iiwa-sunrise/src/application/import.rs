//! Imports an application of a project as a motion program.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write as _,
    rc::Rc,
    thread,
};

use crate::{
    Answers, DataFile, ExportedProject, Project, ProjectData, Question, QuestionKind,
    RobotStatement,
};
use iiwa_java::{ClassId, Classes, EvaluationStop, JavaRefusal, Machine, Note, SourceLine};
use iiwa_kin::{Joints, Robot};
use iiwa_program::{Motion, MotionIndex, MotionLabel, Program, Source};

use crate::application::{
    applications::Application,
    asked::EndlessLoop,
    import_error::{ImportError, RefusedImport, Unanswered},
    import_note::ImportNote,
    import_options::ImportOptions,
    missing::Missing,
    robot_choice::RobotChoice,
    station::{Station, StationSetup},
    station_host::StationHost,
};

/// Application as a motion program.
#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    /// Application.
    pub application: Application,
    /// Robot that runs the application.
    pub robot: Robot,
    /// Statements of the project about the robot and its flange; empty if both were given or
    /// assumed.
    pub statements: Vec<RobotStatement>,
    /// Motion program; its motions have their places in the sources.
    pub program: Program,
    /// Differences between the program and the sources.
    pub notes: Vec<ImportNote>,
    /// Questions of the application, with their answers.
    pub questions: Vec<Question>,
}

/// Stack size in bytes of the evaluation thread. The depths of calls and expressions are bounded;
/// only used pages take memory.
const STACK: usize = 256 << 20;

/// Runs an application of a project without a robot, and returns its motions as a program. The
/// application is named with or without its package, or by its file relative to the project folder;
/// the name may be absent if the project has only one.
///
/// ```
/// use iiwa_sunrise::{ImportOptions, Project, import};
///
/// let project = Project::from_texts([("src/Wave.java", r#"
///     import static com.kuka.roboticsAPI.motionModel.BasicMotions.*;
///     public class Wave extends RoboticsAPIApplication {
///         @Inject private LBR lbr;
///         public void run() {
///             for (int i = 1; i <= 2; i++) {
///                 lbr.move(ptp(0, 0, 0, Math.toRadians(-45 * i), 0, 0, 0)
///                     .setJointVelocityRel(0.5));
///             }
///         }
///     }"#)])?;
/// let import = import(&project, None, &ImportOptions::default())?;
/// assert_eq!(import.program.motions.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// If the application does not exist, if a file that it needs cannot be used, or if its motions
/// cannot be known before run time: then with the place, the reason, and the motions up to there.
pub fn import(
    project: &Project,
    name: Option<&str>,
    options: &ImportOptions,
) -> Result<Import, ImportError> {
    let data_file = data_file(project)?;
    let run = || import_here(project, name, options, data_file);
    thread::scope(|scope| {
        let thread = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, run);
        match thread.map(thread::ScopedJoinHandle::join) {
            Ok(Ok(result)) => result,
            Ok(Err(panic)) => std::panic::resume_unwind(panic),
            Err(error) => Err(ImportError::Thread(error.to_string())),
        }
    })
}

fn data_file(project: &Project) -> Result<DataFile, ImportError> {
    match project.data() {
        ProjectData::Found { path, text } => DataFile::from_xml(text)
            .map_err(|fault| ImportError::DataFile { path: path.clone(), fault }),
        ProjectData::Several(paths) => Err(ImportError::SeveralDataFiles(paths.clone())),
        ProjectData::Unreadable { path, reason } => {
            Err(ImportError::UnreadableDataFile { path: path.clone(), reason: reason.clone() })
        }
        // The project has no data file.
        _ => Ok(DataFile::default()),
    }
}

/// Adds the durations that comments of the sources state, except where an answer is given.
fn with_stated_times(mut answers: Answers, project: &Project) -> Answers {
    for file in project.files() {
        for (line, seconds) in file.times() {
            let place = format!("{}:{line}", file.path());
            let is_given = |key: &String| place == *key || place.ends_with(&format!("/{key}"));
            if !answers.times.keys().any(is_given) {
                answers.times.insert(place, *seconds);
            }
        }
    }
    answers
}

fn import_here(
    project: &Project,
    name: Option<&str>,
    options: &ImportOptions,
    data_file: DataFile,
) -> Result<Import, ImportError> {
    let (_, application) = find(project, &project.classes(), name)?;
    let choice = RobotChoice::new(project, &application, &data_file, options)?;
    let RobotChoice {
        robot,
        name: robot_name,
        flange_m,
        statements,
        questions: of_robot,
        mut notes,
    } = choice;
    let start_rad = options.start_rad.or_else(|| stated_start(&data_file));
    let is_start_known = start_rad.is_some();
    let start_rad = start_rad.unwrap_or_default();
    let answers = with_stated_times(options.answers.clone(), project);
    let setup = StationSetup {
        robot: robot.clone(),
        robot_name,
        flange_m,
        data_file,
        start_rad,
        is_start_known,
        answers,
        is_survey: false,
    };
    let run = EvaluatedRun::new(project, name, setup.clone())?;
    notes.extend(run.notes.iter().map(note));
    if let (Ok(()), Some(endless)) = (&run.end, &run.station.endless) {
        let ways = ways_out(project, name, &setup, endless, &run.station.answered);
        // The note on the loop is the last one for its line, because the evaluation ends there.
        let place = source(&endless.place);
        let loop_note = notes.iter_mut().rev().find(|note| note.source == place);
        if let (Some(loop_note), Some(ways)) = (loop_note, ways) {
            loop_note.text += &ways;
        }
    }
    let asked = run.station.asked.clone();
    let first_missing = run.station.missing.take();
    let (program, places, mut questions) = run.station.finish();
    questions.extend(of_robot);
    if !is_start_known && program.motions.iter().any(Motion::moves) {
        let answer = "0,0,0,0,0,0,0".to_owned();
        questions.push(application.question(QuestionKind::Start, "start", answer, false));
    }
    let program = with_sources(program, &places);
    let program = with_labels(program, &places, project, &mut notes);
    match run.end {
        Ok(()) if program.motions.iter().any(Motion::moves) => {
            Ok(Import { application, robot, statements, program, notes, questions })
        }
        Ok(()) => Err(ImportError::NoMotions { application: Box::new(application) }),
        Err(JavaRefusal { reason, place }) => {
            let missing =
                first_missing.map_or_else(Vec::new, |first| survey(project, name, setup, first));
            let mut reason = reason;
            if let [_, _, ..] = missing.as_slice() {
                let all: Vec<_> = missing.iter().map(ToString::to_string).collect();
                let more = if missing.len() > MAX_SURVEYS { ", and perhaps more" } else { "" };
                let _ = write!(reason, "; in all it lacks {}{more}", all.join(", "));
            }
            if !missing.is_empty() && matches!(project.data(), ProjectData::Absent) {
                reason += "; the project has no RoboticsAPI.data.xml";
            }
            let mut unanswered: Vec<Unanswered> = Vec::new();
            for question in asked.iter().filter(|question| question.answer.is_none()) {
                let entry = Unanswered { kind: question.kind, subject: question.subject.clone() };
                if reason.contains(&format!("`{}`", entry.subject)) && !unanswered.contains(&entry)
                {
                    unanswered.push(entry);
                }
            }
            Err(ImportError::Refused(Box::new(RefusedImport {
                application,
                source: source(&place),
                reason,
                understood: program,
                missing,
                notes,
                questions,
                unanswered,
            })))
        }
    }
}

/// Maximum number of runs that search for further missing entries of the data file.
const MAX_SURVEYS: usize = 200;

/// Collects the entries that the data file lacks, `first` and others: each run adds the entries
/// found before, and stops at the next missing one.
fn survey(
    project: &Project,
    name: Option<&str>,
    setup: StationSetup,
    first: Missing,
) -> Vec<Missing> {
    let mut setup = StationSetup { is_survey: true, ..setup };
    let mut missing = vec![first];
    while let Some(last) = missing.last().filter(|_| missing.len() <= MAX_SURVEYS) {
        last.add_to(&mut setup.data_file);
        let run = EvaluatedRun::new(project, name, setup.clone()).ok();
        match run.and_then(|run| run.station.missing.take()) {
            Some(next) if !missing.contains(&next) => missing.push(next),
            _ => break,
        }
    }
    missing
}

/// Complete evaluation of an application.
struct EvaluatedRun {
    end: Result<(), JavaRefusal>,
    notes: Vec<Note>,
    station: Station,
}

impl EvaluatedRun {
    fn new(
        project: &Project,
        name: Option<&str>,
        setup: StationSetup,
    ) -> Result<Self, ImportError> {
        let classes = project.classes();
        let (id, application) = find(project, &classes, name)?;
        let station = Rc::new(StationHost::new(Station::new(setup)));
        let place = SourceLine { file: application.file.as_str().into(), line: application.line };
        let mut machine = Machine::new(classes, station.clone(), place);
        // The controller calls these methods in the same order.
        let end = match machine.run_class(id, &["initialize", "run"]) {
            Ok(()) | Err(EvaluationStop::Ended) => Ok(()),
            Err(EvaluationStop::Refused(refusal)) => Err(*refusal),
            Err(EvaluationStop::Thrown(thrown)) => {
                let class = thrown.classes.first().map_or("Exception", |class| class);
                let reason =
                    format!("an exception ends the application: {class}, {}", thrown.message);
                Err(JavaRefusal { reason, place: thrown.place.clone() })
            }
        };
        let notes = std::mem::take(&mut machine.notes);
        drop(machine);
        match Rc::into_inner(station) {
            Some(station) => Ok(Self { end, notes, station: station.into_station() }),
            None => Err(ImportError::Thread("its station is still in use".to_owned())),
        }
    }
}

/// Maximum number of buttons to try, over all dialogs of a loop.
const MAX_WAYS: usize = 16;

/// Finds answers to dialogs that end an endless loop: each is tried in a separate run.
fn ways_out(
    project: &Project,
    name: Option<&str>,
    setup: &StationSetup,
    endless: &EndlessLoop,
    answered: &BTreeMap<String, usize>,
) -> Option<String> {
    let buttons = endless
        .dialogs
        .iter()
        .flat_map(|dialog| (0..dialog.choices.len()).map(move |button| (dialog, button)));
    let mut ways = Vec::new();
    for (dialog, button) in buttons.take(MAX_WAYS) {
        let mut answers = setup.answers.clone();
        let dialogs = &mut answers.dialogs;
        let key = dialogs.keys().find(|part| dialog.subject.contains(part.as_str())).cloned();
        let key = key.unwrap_or_else(|| dialog.subject.clone());
        let mut given = dialogs.remove(&key).unwrap_or_default();
        let before = answered.get(&key).or(answered.get(&dialog.subject)).copied().unwrap_or(1);
        let last = given.last().copied().unwrap_or(0);
        given.resize(before.max(given.len()), last);
        given.push(button);
        let list: Vec<_> = given.iter().map(usize::to_string).collect();
        dialogs.insert(key, given);
        let setup = StationSetup { answers, ..setup.clone() };
        let run = EvaluatedRun::new(project, name, setup).ok()?;
        if run.station.endless.is_none_or(|stop| stop.place != endless.place) {
            let choice = dialog.choices.get(button).cloned().unwrap_or_default();
            ways.push(format!("{} ({choice}) to `{}`", list.join(", "), dialog.subject));
        }
    }
    match (endless.dialogs.is_empty(), ways.is_empty()) {
        (true, _) => None,
        (false, true) => Some("; none of the tried answers to its dialogs ends it".to_owned()),
        (false, false) => Some(format!("; it ends by the answers {}", ways.join(", or "))),
    }
}

/// Returns the joint positions at the start of an exported project.
fn stated_start(data_file: &DataFile) -> Option<Joints> {
    let numbers = data_file.setting(ExportedProject::START_ID)?.split_whitespace();
    let numbers: Vec<f64> = numbers.map(str::parse).collect::<Result<_, _>>().ok()?;
    numbers.try_into().ok()
}

/// Finds the application with this name, or the only one.
fn find(
    project: &Project,
    classes: &Classes,
    name: Option<&str>,
) -> Result<(ClassId, Application), ImportError> {
    let all = Application::with_classes(classes);
    let Some(name) = name else {
        let mut left = all.into_iter();
        return match (left.next(), left.next()) {
            (Some(only), None) => Ok(only),
            (None, _) => Err(no_application(project)),
            (Some(first), Some(second)) => {
                let all =
                    [first, second].into_iter().chain(left).map(|(_, application)| application);
                Err(ImportError::Several { known: all.collect() })
            }
        };
    };
    let is_it = |application: &Application| {
        application.name == name || application.qualified_name == name || application.file == name
    };
    let mut matches = all.iter().filter(|(_, application)| is_it(application));
    match (matches.next(), matches.next()) {
        (Some(only), None) => Ok(only.clone()),
        (Some(_), Some(_)) => {
            let several = all.into_iter().map(|(_, application)| application).filter(is_it);
            Err(ImportError::Several { known: several.collect() })
        }
        (None, _) => match classes.faulty(name) {
            Some(fault) => Err(ImportError::Source(fault.clone())),
            None if all.is_empty() => Err(no_application(project)),
            None => Err(ImportError::Unknown {
                name: name.to_owned(),
                known: all.into_iter().map(|(_, application)| application).collect(),
            }),
        },
    }
}

/// Returns the error for a project without applications; an unreadable file may be the cause.
fn no_application(project: &Project) -> ImportError {
    match project.files().iter().find_map(|file| file.error()) {
        Some(error) => ImportError::Source(error.clone()),
        None => ImportError::NoApplications { files: project.files().len() },
    }
}

fn with_sources(program: Program, places: &[SourceLine]) -> Program {
    let sources = (0..).map(MotionIndex::new).zip(places.iter().map(source));
    Program { sources: sources.collect(), ..program }
}

/// Adds the names, comments and groups that comments of the sources state. A text that a program
/// cannot have gets a note.
fn with_labels(
    mut program: Program,
    places: &[SourceLine],
    project: &Project,
    notes: &mut Vec<ImportNote>,
) -> Program {
    let labels: BTreeMap<(&str, u32), &MotionLabel> = project
        .files()
        .iter()
        .flat_map(|file| file.labels().iter().map(|(line, label)| ((file.path(), *line), label)))
        .collect();
    let mut noted = BTreeSet::new();
    for (motion, place) in (0..).map(MotionIndex::new).zip(places) {
        let line = (&*place.file, place.line);
        let Some(label) = labels.get(&line) else { continue };
        match label.fault() {
            None => program.sources.insert_label(motion, (*label).clone()),
            Some((_, message)) => {
                if noted.insert(line) {
                    let text = format!("the comment lines before this line are ignored: {message}");
                    notes.push(ImportNote { text, source: source(place) });
                }
            }
        }
    }
    program
}

fn source(place: &SourceLine) -> Source {
    Source { file: place.file.to_string(), line: place.line }
}

fn note(note: &Note) -> ImportNote {
    ImportNote { text: note.text.clone(), source: source(&note.place) }
}
