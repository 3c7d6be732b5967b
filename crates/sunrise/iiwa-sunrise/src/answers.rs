//! Answers to the questions of applications.

use std::{collections::BTreeMap, fmt};

use iiwa_json::JsonPlace;
use iiwa_program::Frame;
use serde::Deserialize;

/// Answers to the questions of an application: dialogs, inputs, process data, conditions,
/// durations, and tool frames that the data file lacks; and the robot that runs the application.
///
/// ```
/// use iiwa_sunrise::{AnswerValue, Answers};
///
/// let answers = Answers::from_toml(r#"
///     [answers]
///     "Which part?" = 1
///     "Once more?" = [0, 0, 1]
///     [inputs]
///     "Gripper.Closed" = true
///     [data]
///     velocity = 0.25
///     [fired]
///     "Search.java:29" = true
///     [times]
///     "Fetch.java:26" = 2.5
///     [tools]
///     Gripper = [0, 0, 120]
/// "#)?;
/// assert_eq!(answers.times["Fetch.java:26"], 2.5);
/// assert_eq!(answers.dialogs["Once more?"], [0, 0, 1]);
/// assert_eq!(answers.inputs["Gripper.Closed"], AnswerValue::Boolean(true));
/// # Ok::<(), iiwa_sunrise::AnswersError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Answers {
    /// Robot: a built-in model, or the path of a profile.
    pub robot: Option<String>,
    /// Flange length in mm.
    pub flange_mm: Option<f64>,
    /// Button numbers from 0, by the dialog text, or by a part of the text if no other key is also
    /// a part of it. Each number answers the dialog once; the last number also answers all later
    /// occurrences.
    pub dialogs: BTreeMap<String, Vec<usize>>,
    /// Input values, by `Group.Name`.
    pub inputs: BTreeMap<String, AnswerValue>,
    /// Process data, by id.
    pub data: BTreeMap<String, AnswerValue>,
    /// Outcomes of conditions that are monitored during a motion, by the place at which the program
    /// queries the outcome, such as `Search.java:29`, with or without folders. Each outcome answers
    /// one query; the last outcome also answers all later queries.
    pub fired: BTreeMap<String, Vec<bool>>,
    /// Durations in s of holds that the operator ends, of gripper motions and of platform motions,
    /// by `File.java:line`.
    pub times: BTreeMap<String, f64>,
    /// Frames of tools that the data file lacks, relative to the flange: the TCP by `Tool`, other
    /// frames by `Tool/Frame`.
    pub tools: BTreeMap<String, Frame>,
}

/// Value of an answer.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum AnswerValue {
    /// `true` or `false`.
    Boolean(bool),
    /// Integer.
    Integer(i64),
    /// Any other number.
    Number(f64),
    /// Text.
    Text(String),
}

impl AnswerValue {
    /// Parses `true` and `false`, integers and other finite numbers; anything else is a text.
    ///
    /// ```
    /// use iiwa_sunrise::AnswerValue;
    ///
    /// assert_eq!(AnswerValue::of_text("12"), AnswerValue::Integer(12));
    /// assert_eq!(AnswerValue::of_text("left"), AnswerValue::Text("left".to_owned()));
    /// ```
    #[must_use]
    pub fn of_text(text: &str) -> Self {
        let number = || text.parse().ok().filter(|number: &f64| number.is_finite());
        match text {
            "true" => Self::Boolean(true),
            "false" => Self::Boolean(false),
            _ => (text.parse().ok().map(Self::Integer))
                .or_else(|| number().map(Self::Number))
                .unwrap_or_else(|| Self::Text(text.to_owned())),
        }
    }
}

impl fmt::Display for AnswerValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Boolean(value) => value.fmt(f),
            Self::Integer(value) => value.fmt(f),
            Self::Number(value) => value.fmt(f),
            Self::Text(text) => text.fmt(f),
        }
    }
}

/// Error of reading an answer file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}, at {place}")]
pub struct AnswersError {
    /// Message.
    pub message: String,
    /// Place in the text.
    pub place: JsonPlace,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AnswersWire {
    #[serde(default)]
    robot: Option<String>,
    #[serde(default)]
    flange_mm: Option<f64>,
    #[serde(default)]
    answers: BTreeMap<String, ButtonsWire>,
    #[serde(default)]
    inputs: BTreeMap<String, AnswerValue>,
    #[serde(default)]
    data: BTreeMap<String, AnswerValue>,
    #[serde(default)]
    fired: BTreeMap<String, FiredWire>,
    #[serde(default)]
    times: BTreeMap<String, SecondsWire>,
    #[serde(default)]
    tools: BTreeMap<String, FrameWire>,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "whether a condition fired is true or false, or a list of these")]
enum FiredWire {
    One(bool),
    Each(Vec<bool>),
}

#[derive(Deserialize)]
#[serde(try_from = "f64")]
struct SecondsWire(f64);

impl TryFrom<f64> for SecondsWire {
    type Error = &'static str;

    fn try_from(seconds: f64) -> Result<Self, Self::Error> {
        Answers::seconds(seconds).map(Self).ok_or(Answers::SECONDS)
    }
}

#[derive(Deserialize)]
#[serde(try_from = "Vec<f64>")]
struct FrameWire(Frame);

impl TryFrom<Vec<f64>> for FrameWire {
    type Error = &'static str;

    fn try_from(numbers: Vec<f64>) -> Result<Self, Self::Error> {
        Answers::frame(&numbers).map(Self).ok_or(Answers::FRAME)
    }
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "an answer is the number of a button, from 0, or a list of such numbers"
)]
enum ButtonsWire {
    One(usize),
    Each(Vec<usize>),
}

impl Answers {
    /// Expected form of a duration.
    pub const SECONDS: &'static str = "a duration is a number of seconds from 0 to 86400";
    /// Expected form of a tool frame.
    pub const FRAME: &'static str =
        "a tool frame is x, y, z in mm, and perhaps a, b, c in degrees, relative to the flange";

    /// Returns the duration if it is in the range of a motion program.
    #[must_use]
    pub fn seconds(seconds: f64) -> Option<f64> {
        (0.0..=86400.0).contains(&seconds).then_some(seconds)
    }

    /// Returns the frame of x, y, z in mm and optionally a, b, c in degrees.
    #[must_use]
    pub fn frame(numbers: &[f64]) -> Option<Frame> {
        let (xyz_mm, abc_deg) = match *numbers {
            [x, y, z] => ([x, y, z], [0.0; 3]),
            [x, y, z, a, b, c] => ([x, y, z], [a, b, c]),
            _ => return None,
        };
        let is_finite = numbers.iter().all(|number| number.is_finite());
        is_finite.then(|| Frame { xyz_mm, abc_rad: abc_deg.map(f64::to_radians) })
    }

    /// Reads answers from TOML: `robot` and `flange_mm`, `[answers]` for dialogs, `[inputs]`,
    /// `[data]`, `[fired]`, `[times]` and `[tools]`.
    ///
    /// # Errors
    ///
    /// If the text is not valid TOML, or has an unknown key or a value of another type; the error
    /// reports the place.
    pub fn from_toml(text: &str) -> Result<Self, AnswersError> {
        let wire: AnswersWire = toml::from_str(text).map_err(|error| AnswersError {
            message: error.message().lines().collect::<Vec<_>>().join("; "),
            place: JsonPlace::of_span(text, error.span().unwrap_or_default()),
        })?;
        let numbers = |buttons| match buttons {
            ButtonsWire::One(number) => vec![number],
            ButtonsWire::Each(numbers) => numbers,
        };
        let dialogs = wire.answers.into_iter().map(|(text, buttons)| (text, numbers(buttons)));
        let each = |fired| match fired {
            FiredWire::One(is_fired) => vec![is_fired],
            FiredWire::Each(all) => all,
        };
        let fired = wire.fired.into_iter().map(|(place, fired)| (place, each(fired)));
        Ok(Self {
            robot: wire.robot,
            flange_mm: wire.flange_mm,
            dialogs: dialogs.collect(),
            inputs: wire.inputs,
            data: wire.data,
            fired: fired.collect(),
            times: wire
                .times
                .into_iter()
                .map(|(place, SecondsWire(seconds))| (place, seconds))
                .collect(),
            tools: wire.tools.into_iter().map(|(name, FrameWire(frame))| (name, frame)).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_keys_are_errors_with_their_place() {
        let error = Answers::from_toml("[answers]\n\"Go?\" = 0\n\n[input]\n\"A.B\" = true\n").err();
        let place = error.as_ref().map(|error| (error.place.line, error.place.column));
        assert_eq!(place, Some((4, 2)));
        let text = error.map(|error| error.to_string()).unwrap_or_default();
        assert!(text.contains("unknown field `input`"), "{text}");
    }

    #[test]
    fn a_button_is_a_number() {
        let error = Answers::from_toml("[answers]\n\"Go?\" = true\n").err();
        let text = error.map(|error| error.to_string()).unwrap_or_default();
        assert!(text.contains("the number of a button") && text.contains("line 2"), "{text}");
    }

    #[test]
    fn durations_and_tools_are_checked() {
        for (text, reason) in [
            ("[times]\n\"A.java:3\" = -1", Answers::SECONDS),
            ("[times]\n\"A.java:3\" = nan", Answers::SECONDS),
            ("[tools]\nPen = [1, 2]", Answers::FRAME),
        ] {
            let error = Answers::from_toml(text).err();
            let message = error.map(|error| error.to_string()).unwrap_or_default();
            assert!(message.contains(reason) && message.contains("line 2"), "{text}: {message}");
        }
        let tools = Answers::from_toml("[tools]\n\"Pen/Tip\" = [1, 2, 3, 90, 0, 0]")
            .map(|answers| answers.tools);
        let tip = tools.unwrap_or_default().get("Pen/Tip").copied().unwrap_or_default();
        assert_eq!(tip.xyz_mm, [1.0, 2.0, 3.0]);
        assert_eq!(tip.abc_rad, [std::f64::consts::FRAC_PI_2, 0.0, 0.0]);
    }

    #[test]
    fn a_file_may_be_empty() {
        assert_eq!(Answers::from_toml("# nothing\n"), Ok(Answers::default()));
    }
}
