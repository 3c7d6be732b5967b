//! Questions of an application during its evaluation.

/// Question of an application. An evaluation with the same answers gives the same program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Question {
    /// Kind of the question.
    pub kind: QuestionKind,
    /// Text of the dialog, `Group.Name` of the input, id of the process data, `File.java:line` of
    /// the condition or the duration, or name of the tool.
    pub subject: String,
    /// Buttons of the dialog.
    pub choices: Vec<String>,
    /// Answer: the button number from 0, or a value.
    pub answer: String,
    /// `true` if the answer was given; otherwise the answer is the first button, or the value in
    /// the data file.
    pub is_given: bool,
    /// Source file, relative to the project folder.
    pub file: String,
    /// Line in the file, from 1.
    pub line: u32,
}

/// Kinds of questions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum QuestionKind {
    /// Dialog with buttons.
    Dialog,
    /// Input of an I/O group.
    Input,
    /// Process data that the operator may change.
    ProcessData,
    /// Robot model, which the project does not state.
    Robot,
    /// Flange length in mm, which the project does not state.
    Flange,
    /// Joint positions before the first motion, in degrees.
    Start,
    /// Outcome of a condition that is monitored during a motion.
    Fired,
    /// Duration of a hold, a gripper motion or a platform motion.
    Time,
    /// Tool frame that the data file lacks.
    Tool,
}
