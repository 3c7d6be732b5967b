//! Import of applications from Sunrise projects.

use std::path::{Path, PathBuf};

use iiwa_sunrise::{AnswerValue, Answers, Project, ProjectError, QuestionKind};
use iiwa_sunrise::{Application, ImportOptions, import};
use pyo3::{exceptions::PyValueError, prelude::*, types::PyDict};
use std::collections::BTreeMap;

use crate::{
    arrays::{JointsLike, Rows},
    errors::{exception, os_error, unexpected},
    options::RobotArgument,
    program::Program,
};

fn open(py: Python<'_>, folder: &Path) -> PyResult<Project> {
    Project::open(folder).map_err(|error| match error {
        ProjectError::Folder { path, source } => os_error(&path, &source),
        error => exception(py, "SunriseError", (error.to_string(),)),
    })
}

/// Names of the applications of the Sunrise project in a folder.
///
/// >>> import iiwasim as iw
/// >>> iw.applications('fixtures/sunrise/joints')
/// ['application.ShelfScan']
#[pyfunction]
pub(crate) fn applications(py: Python<'_>, folder: PathBuf) -> PyResult<Vec<String>> {
    let project = open(py, &folder)?;
    Ok(Application::all(&project)
        .into_iter()
        .map(|application| application.qualified_name)
        .collect())
}

/// The number of a button, or several numbers.
pub(crate) struct Buttons(Vec<usize>);

impl<'py> FromPyObject<'_, 'py> for Buttons {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let one = value.extract().map(|button| vec![button]);
        let buttons = one.or_else(|_| value.extract());
        let expected = "the number of a button, from 0, or a list of such numbers";
        buttons.map(Self).map_err(|_| unexpected("an answer", &value, expected))
    }
}

/// Outcomes of a break condition, in the order of its evaluations.
pub(crate) struct Fired(Vec<bool>);

impl<'py> FromPyObject<'_, 'py> for Fired {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let one = value.extract().map(|is_fired| vec![is_fired]);
        let all = one.or_else(|_| value.extract());
        all.map(Self)
            .map_err(|_| unexpected("an answer", &value, "True or False, or a list of these"))
    }
}

/// The value of an input, or of process data.
pub(crate) struct InputValue(AnswerValue);

impl<'py> FromPyObject<'_, 'py> for InputValue {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        // In this order, as `True` is also an integer, and an integer is also a number.
        let known = (value.extract().map(AnswerValue::Boolean))
            .or_else(|_| value.extract().map(AnswerValue::Integer))
            .or_else(|_| value.extract().map(AnswerValue::Number))
            .or_else(|_: PyErr| value.extract().map(AnswerValue::Text));
        let expected = "True or False, a number or a text";
        known.map(Self).map_err(|_: PyErr| unexpected("a value", &value, expected))
    }
}

/// Imports an application of a Sunrise project: returns the program, and a dict with `application`,
/// `notes` and `questions`.
///
/// `application` may be left out if there is only one. `answers` has the button of each dialog (its
/// number from 0, by the text of the dialog), `inputs` and process `data` have values by name, and
/// `fired` has the outcomes of break conditions by file and line of `hasFired`. `times` has the
/// durations in s of holds, grippers and platforms by file and line; `tools` has frames that the
/// data file lacks: x, y, z in mm, optionally a, b, c in deg. `robot` and `flange_mm` replace the
/// robot and the flange of the project. Values that no file states are listed in the questions.
/// Raises `SunriseError` with file and line.
///
/// >>> import iiwasim as iw
/// >>> program, told = iw.import_application('fixtures/sunrise/joints')
/// >>> len(program)
/// 10
#[pyfunction]
#[pyo3(signature = (
    folder, *, application = None, answers = None, inputs = None, data = None, fired = None,
    times = None, tools = None, robot = None, flange_mm = None, start_deg = None
))]
#[expect(clippy::too_many_arguments, reason = "they are options by keyword in Python")]
pub(crate) fn import_application<'py>(
    py: Python<'py>,
    folder: PathBuf,
    application: Option<&str>,
    answers: Option<BTreeMap<String, Buttons>>,
    inputs: Option<BTreeMap<String, InputValue>>,
    data: Option<BTreeMap<String, InputValue>>,
    fired: Option<BTreeMap<String, Fired>>,
    times: Option<BTreeMap<String, f64>>,
    tools: Option<BTreeMap<String, Vec<f64>>>,
    robot: Option<RobotArgument<'py>>,
    flange_mm: Option<f64>,
    start_deg: Option<JointsLike<'py>>,
) -> PyResult<(Program, Bound<'py, PyDict>)> {
    let project = open(py, &folder)?;
    let file = folder.join("iiwasim-answers.toml");
    let mut given = if file.is_file() {
        Answers::from_toml(&iiwa_files::read_text(&file)?)
            .map_err(|error| PyValueError::new_err(format!("{}: {error}", file.display())))?
    } else {
        Answers::default()
    };
    let mut unasked = Vec::new();
    for (text, buttons) in answers.unwrap_or_default() {
        unasked.push((QuestionKind::Dialog, text.clone()));
        given.dialogs.retain(|known, _| !known.contains(&text));
        given.dialogs.insert(text, buttons.0);
    }
    for (kind, values, known) in [
        (QuestionKind::Input, inputs, &mut given.inputs),
        (QuestionKind::ProcessData, data, &mut given.data),
    ] {
        for (name, value) in values.unwrap_or_default() {
            unasked.push((kind, name.clone()));
            known.insert(name, value.0);
        }
    }
    for (place, values) in fired.unwrap_or_default() {
        unasked.push((QuestionKind::Fired, place.clone()));
        given.fired.insert(place, values.0);
    }
    for (place, seconds) in times.unwrap_or_default() {
        let duration = Answers::seconds(seconds);
        let fault = || PyValueError::new_err(format!("times, {place:?}: {}", Answers::SECONDS));
        unasked.push((QuestionKind::Time, place.clone()));
        given.times.insert(place.clone(), duration.ok_or_else(fault)?);
    }
    for (name, numbers) in tools.unwrap_or_default() {
        let frame = Answers::frame(&numbers);
        let fault = || PyValueError::new_err(format!("tools, {name:?}: {}", Answers::FRAME));
        unasked.push((QuestionKind::Tool, name.clone()));
        given.tools.insert(name.clone(), frame.ok_or_else(fault)?);
    }
    let start_rad = match &start_deg {
        None => None,
        Some(deg) => Some(Rows::new("start_deg", deg)?.single("start_deg")?.map(f64::to_radians)),
    };
    let robot = robot.map(|robot| robot.model(py)).transpose()?;
    let options = ImportOptions {
        robot_name: robot.as_ref().map(|robot| robot.name().to_owned()),
        robot,
        flange_m: flange_mm.map(|mm| mm / 1e3),
        start_rad,
        answers: given,
    };
    let imported = py.detach(|| import(&project, application, &options));
    let imported = imported.map_err(|error| exception(py, "SunriseError", (error.to_string(),)))?;
    let report = PyDict::new(py);
    report.set_item("application", imported.application.qualified_name)?;
    let mut notes: Vec<_> =
        imported.notes.iter().map(|note| format!("{}: {}", note.source, note.text)).collect();
    unasked.retain(|(kind, name)| {
        !imported.questions.iter().any(|it| it.kind == *kind && it.subject.contains(name))
    });
    notes.extend(unasked.iter().map(|(_, name)| format!("nothing asks for {name:?}")));
    report.set_item("notes", notes)?;
    let asked = |it: &iiwa_sunrise::Question| {
        format!("{}:{} asks {:?}, answered by {}", it.file, it.line, it.subject, it.answer)
    };
    let questions: Vec<_> = imported.questions.iter().map(asked).collect();
    report.set_item("questions", questions)?;
    Ok((Program::of(py, imported.program, Some(imported.robot))?, report))
}
