//! Robot that runs an application, and its flange: as given, as the project states them, or else
//! assumed.

use crate::{
    DataFile, ExportedProject, ImportedCell, OTHER_FLANGE_M, Project, ProjectData, Question,
    QuestionKind, RobotStatement, SourceFile, Stated, StatedBy, StatedModel, TOUCH_FLANGE_M,
};
use iiwa_kin::Robot;
use iiwa_program::Source;

use crate::application::{
    applications::Application, import_error::ImportError, import_note::ImportNote,
    import_options::ImportOptions,
};

/// Robot of an application.
pub(crate) struct RobotChoice {
    pub(crate) robot: Robot,
    /// Name in the program.
    pub(crate) name: String,
    /// Flange length that the program states; `None` if the robot is a profile, which has its own.
    pub(crate) flange_m: Option<f64>,
    /// Statements of the project that were used.
    pub(crate) statements: Vec<RobotStatement>,
    pub(crate) questions: Vec<Question>,
    pub(crate) notes: Vec<ImportNote>,
}

impl RobotChoice {
    /// Chooses the robot: the given one, else the one that the project states, else the LBR iiwa 7
    /// R800, as the assumed answer to a question.
    ///
    /// # Errors
    ///
    /// If the project's files disagree, or name a robot that is not built in.
    pub(crate) fn new(
        project: &Project,
        application: &Application,
        data_file: &DataFile,
        options: &ImportOptions,
    ) -> Result<Self, ImportError> {
        let mut all = statements(project, application, data_file);
        let mut notes = Vec::new();
        if let Err(fault) = project.station() {
            let source = Source { file: fault.path.clone(), line: 1 };
            let text = format!("the robot of the station is not known: {fault}");
            notes.push(ImportNote { text, source });
        }
        let mut questions = Vec::new();
        let mut add_question = |kind, asked, answer, is_given| {
            questions.push(application.question(kind, asked, answer, is_given));
        };
        let robot_from_options = robot_from_options(options)?;
        let is_profile = |robot: &Robot| Robot::built_in(robot.name()).as_ref() != Some(robot);
        let model = agreed(&all, |means| match means {
            Stated::Model(model) => Some(model.built_in),
            _ => None,
        });
        let (robot, name) = match (robot_from_options, model) {
            (Some((robot, name)), _) => {
                notes.extend(all.iter().find_map(|statement| other_than(&name, statement)));
                if all.is_empty() {
                    add_question(QuestionKind::Robot, "robot", name.clone(), true);
                }
                (robot, name)
            }
            (None, Agreement::Several) => return Err(ImportError::Robots(all)),
            (None, stated) => {
                if let Some(name) = foreign(data_file) {
                    return Err(ImportError::UnknownRobot(name.to_owned()));
                }
                let stated = stated.one();
                if stated.is_none() {
                    let assumed = Robot::default().name().to_owned();
                    add_question(QuestionKind::Robot, "robot", assumed, false);
                }
                let robot = stated.and_then(Robot::built_in).unwrap_or_default();
                let name = robot.name().to_owned();
                (robot, name)
            }
        };
        if is_profile(&robot) {
            let statements = Vec::new();
            return Ok(Self { robot, name, flange_m: None, statements, questions, notes });
        }
        let is_same_model = |statement: &RobotStatement| match statement.means {
            Stated::Model(model) | Stated::Flange(model, _) => model.built_in == robot.name(),
        };
        all.retain(is_same_model);
        all.extend(taught_with(project, data_file, &robot));
        let flange = agreed(&all, |means| match means {
            Stated::Flange(_, length_m) => Some(*length_m),
            _ => None,
        });
        let given_m = options.flange_m.or(options.answers.flange_mm.map(|mm| mm / 1e3));
        let model_m = robot.lengths().flange_m;
        let mm = |length_m: f64| format!("{}", (1e6 * length_m).round() / 1e3);
        let flange_m = match (given_m, flange) {
            (Some(given_m), _) => {
                notes.extend(all.iter().find_map(|statement| other_flange(given_m, statement)));
                if matches!(flange, Agreement::Nothing) {
                    add_question(QuestionKind::Flange, "flange", mm(given_m), true);
                }
                given_m
            }
            (None, Agreement::One(stated_m)) => stated_m,
            (None, Agreement::Nothing) => {
                add_question(QuestionKind::Flange, "flange", mm(model_m), false);
                model_m
            }
            (None, Agreement::Several) => {
                all.retain(|statement| matches!(statement.means, Stated::Flange(..)));
                return Err(ImportError::Flanges(all));
            }
        };
        let med = |statement: &&RobotStatement| match statement.means {
            Stated::Model(model) => model.is_med,
            Stated::Flange(..) => false,
        };
        notes.extend(all.iter().find(med).map(|statement| ImportNote {
            text: format!(
                "{} is planned as {name}, which has the same kinematics; the same limits are \
                 assumed",
                statement.words
            ),
            source: source(statement),
        }));
        let robot = robot.with_flange_m(flange_m).map_err(ImportError::FlangeLength)?;
        Ok(Self { robot, name, flange_m: Some(flange_m), statements: all, questions, notes })
    }
}

/// Returns the robot of the options, or of the answers.
fn robot_from_options(options: &ImportOptions) -> Result<Option<(Robot, String)>, ImportError> {
    if let Some(robot) = &options.robot {
        let name = options.robot_name.clone().unwrap_or_else(|| robot.name().to_owned());
        return Ok(Some((robot.clone(), name)));
    }
    let Some(name) = &options.answers.robot else { return Ok(None) };
    match Robot::built_in(name) {
        Some(robot) => Ok(Some((robot, name.clone()))),
        None => Err(ImportError::UnknownRobot(name.clone())),
    }
}

/// Agreement between the values that all kinds of files state.
#[derive(Clone, Copy)]
enum Agreement<T> {
    /// No file states a value.
    Nothing,
    One(T),
    /// The kinds of files that state values agree on no value, or on more than one.
    Several,
}

impl<T> Agreement<T> {
    fn one(self) -> Option<T> {
        match self {
            Self::One(value) => Some(value),
            Self::Nothing | Self::Several => None,
        }
    }
}

/// Returns the value on which all kinds of files that state a value agree. A station may have
/// several robots, one of which is named elsewhere.
fn agreed<T: Copy + PartialEq>(
    statements: &[RobotStatement],
    value: impl Fn(&Stated) -> Option<T>,
) -> Agreement<T> {
    let mut left: Option<Vec<T>> = None;
    for by in [StatedBy::Station, StatedBy::DataFile, StatedBy::Java] {
        let of_source = statements.iter().filter(|statement| statement.by == by);
        let values: Vec<T> = of_source.filter_map(|statement| value(&statement.means)).collect();
        if values.is_empty() {
            continue;
        }
        match &mut left {
            Some(left) => left.retain(|value| values.contains(value)),
            None => left = Some(values),
        }
    }
    match left.as_deref() {
        None => Agreement::Nothing,
        Some([first, others @ ..]) if others.iter().all(|value| value == first) => {
            Agreement::One(*first)
        }
        Some(_) => Agreement::Several,
    }
}

/// Collects all statements of the project. In Java, the application's file has priority over other
/// files.
fn statements(
    project: &Project,
    application: &Application,
    data_file: &DataFile,
) -> Vec<RobotStatement> {
    let mut all = project.station().map(<[_]>::to_vec).unwrap_or_default();
    all.extend(devices(project, data_file));
    let named = |is_own: bool| {
        let files = project.files().iter();
        let files = files.filter(move |file| (file.path() == application.file) == is_own);
        files.flat_map(SourceFile::robots).cloned().collect::<Vec<_>>()
    };
    let all_named = named(true);
    all.extend(if all_named.is_empty() { named(false) } else { all_named });
    all
}

/// Returns the data file's name and text.
fn data_text(project: &Project) -> (&str, &str) {
    match project.data() {
        ProjectData::Found { path, text } => (path, text),
        _ => (ExportedProject::DATA_FILE, ""),
    }
}

/// Creates a statement of the data file, at the first occurrence of the words.
fn in_data_file(project: &Project, words: &str, means: Stated) -> RobotStatement {
    let (path, text) = data_text(project);
    let before = text.find(words).and_then(|offset| text.get(..offset)).unwrap_or_default();
    let line = before.matches('\n').count() + 1;
    RobotStatement {
        by: StatedBy::DataFile,
        file: path.to_owned(),
        line: u32::try_from(line).unwrap_or(u32::MAX),
        words: words.to_owned(),
        means,
    }
}

/// Finds the robots with which frames of the data file were taught, and the robot of an exported
/// program.
fn devices(project: &Project, data_file: &DataFile) -> Vec<RobotStatement> {
    let mut names: Vec<&str> = Vec::new();
    let mut open: Vec<_> = data_file.frames.iter().rev().collect();
    while let Some(frame) = open.pop() {
        open.extend(frame.children.iter().rev());
        let taught = frame.teaching.as_ref().map(|teaching| teaching.device.as_str());
        let reached = frame.redundancy.as_ref().map(|redundancy| redundancy.device.as_str());
        for name in [taught, reached].into_iter().flatten() {
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    let mut statements: Vec<_> = names
        .into_iter()
        .filter_map(named)
        .map(|(name, model)| in_data_file(project, name, Stated::Model(model)))
        .collect();
    let exported = data_file.setting(ExportedProject::ROBOT_ID);
    if let Some((name, model)) = exported.and_then(named) {
        statements.push(in_data_file(project, name, Stated::Model(model)));
        let flange_mm = data_file.setting(ExportedProject::FLANGE_ID);
        if let Some(flange_mm) = flange_mm.and_then(|mm| mm.parse::<f64>().ok()) {
            let means = Stated::Flange(model, flange_mm / 1e3);
            statements.push(in_data_file(project, ExportedProject::FLANGE_ID, means));
        }
    }
    statements
}

/// Returns a device name with its model.
fn named(device: &str) -> Option<(&str, StatedModel)> {
    Some((device, StatedModel::in_name(device)?))
}

/// Returns the robot of an exported program, if it is not a built-in model.
fn foreign(data_file: &DataFile) -> Option<&str> {
    data_file.setting(ExportedProject::ROBOT_ID).filter(|name| Robot::built_in(name).is_none())
}

/// Returns the flange length with which the arm reaches more taught frames as taught, if this is at
/// least 90 % of them; none if both lengths reach the same number.
fn taught_with(project: &Project, data_file: &DataFile, robot: &Robot) -> Option<RobotStatement> {
    if data_file.setting(ExportedProject::FLANGE_ID).is_some() {
        return None;
    }
    let cell = ImportedCell::new(data_file);
    let model = StatedModel::in_name(robot.name())?;
    let lengths = [OTHER_FLANGE_M, TOUCH_FLANGE_M];
    let [[taught, other], [_, touch]] = lengths.map(|flange_m| {
        let robot = robot.clone().with_flange_m(flange_m).unwrap_or_default();
        cell.taught_and_agreeing(&robot)
    });
    let (flange_m, farthest) =
        if other > touch { (lengths[0], other) } else { (lengths[1], touch) };
    // Some frames were taught before a change of the tool or of the robot, so that 90 % are enough.
    if other == touch || 10 * farthest < 9 * taught {
        return None;
    }
    let counts = lengths.into_iter().zip([other, touch]);
    let counts: Vec<_> =
        counts.map(|(m, count)| format!("{count} with the {:.0} mm", 1e3 * m)).collect();
    let words =
        format!("of {taught} taught frames, the arm reaches {} flange", counts.join(" and "));
    let means = Stated::Flange(model, flange_m);
    let (path, _) = data_text(project);
    Some(RobotStatement { by: StatedBy::DataFile, file: path.to_owned(), line: 1, words, means })
}

fn source(statement: &RobotStatement) -> Source {
    Source { file: statement.file.clone(), line: statement.line }
}

/// Creates a note if the project states another model than the given one, by name.
fn other_than(name: &str, statement: &RobotStatement) -> Option<ImportNote> {
    let Stated::Model(model) = statement.means else { return None };
    let robot_from_options = StatedModel::in_name(name)?;
    (robot_from_options.built_in != model.built_in).then(|| ImportNote {
        text: format!("the project states {}; the plan uses {name}, as given", statement.words),
        source: source(statement),
    })
}

/// Creates a note if the project states another flange than the given one.
fn other_flange(given_m: f64, statement: &RobotStatement) -> Option<ImportNote> {
    let Stated::Flange(_, stated_m) = statement.means else { return None };
    (stated_m != given_m).then(|| ImportNote {
        text: format!(
            "the project states a flange of {:.0} mm ({}); the plan uses a flange of {} mm, as \
             given",
            1e3 * stated_m,
            statement.words,
            1e3 * given_m
        ),
        source: source(statement),
    })
}
