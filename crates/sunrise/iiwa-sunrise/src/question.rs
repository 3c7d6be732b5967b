//! What an application asked for while it was evaluated.

/// Something that an application asked for: a run with the same answers gives the same program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Question {
    /// Of which kind it is.
    pub kind: QuestionKind,
    /// The text of the dialog, `Group.Name` of the input, the id of the process data, `File.java:line` of the condition or the
    /// duration, or the name of the tool.
    pub asked: String,
    /// The buttons of the dialog.
    pub choices: Vec<String>,
    /// What was answered: the number of the button from 0, or a value.
    pub answer: String,
    /// Whether the answer was given; else it is the first button, or the data file's value.
    pub is_given: bool,
    /// The file of the sources, from the project's folder on.
    pub file: String,
    /// The line in it, from 1.
    pub line: u32,
}

/// The kinds of questions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum QuestionKind {
    /// A dialog with buttons.
    Dialog,
    /// An input of a group of inputs and outputs.
    Input,
    /// A value of the operator's.
    ProcessData,
    /// The model of the robot, which the project does not state.
    Robot,
    /// The length of its flange in mm, which the project does not state.
    Flange,
    /// The joints with which the arm stands before the first motion, in degrees.
    Start,
    /// The outcome of a condition that is measured while the arm moves.
    Fired,
    /// The duration of a hold, of a gripper or of a platform.
    Time,
    /// A frame of a tool that the data file lacks.
    Tool,
}
