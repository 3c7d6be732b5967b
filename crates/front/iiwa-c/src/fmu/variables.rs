//! Inputs and outputs.

use std::iter;

/// Input, output or time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Variable {
    Time,
    Start,
    Override,
    /// Position of a joint, counted from 0.
    Q(usize),
    /// Velocity of a joint, counted from 0.
    Dq(usize),
    /// Coordinate of the TCP.
    Tcp(usize),
    /// Component of the TCP orientation, quaternion x, y, z, w.
    Orientation(usize),
    Motion,
    Done,
}

/// Declaration of a variable.
pub(super) struct Declaration {
    pub(super) name: String,
    /// Element in the model description.
    pub(super) element: &'static str,
    /// Causality and related attributes.
    pub(super) role: &'static str,
    pub(super) unit: Option<&'static str>,
    pub(super) description: &'static str,
}

const CONTINUOUS: &str = r#"causality="output" variability="continuous" initial="calculated""#;
const DISCRETE: &str = r#"causality="output" variability="discrete" initial="calculated""#;

impl Variable {
    /// Returns all variables, in the order of their value references.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        let inputs = [Self::Time, Self::Start, Self::Override];
        let joints = (0..7).map(Self::Q).chain((0..7).map(Self::Dq));
        let tcp = (0..3).map(Self::Tcp).chain((0..4).map(Self::Orientation));
        inputs.into_iter().chain(joints).chain(tcp).chain([Self::Motion, Self::Done])
    }

    /// Returns the outputs, with their value references.
    pub(super) fn outputs() -> impl Iterator<Item = (u32, Self)> {
        iter::zip(0.., Self::all()).skip(3)
    }

    /// Returns the variable of a value reference.
    pub(super) fn of(reference: u32) -> Option<Self> {
        Self::all().nth(usize::try_from(reference).ok()?)
    }

    pub(super) fn declaration(self) -> Declaration {
        let (name, element, role, unit, description) = match self {
            Self::Time => (
                "time".to_owned(),
                "Float64",
                r#"causality="independent" variability="continuous""#,
                Some("s"),
                "Time of the simulation",
            ),
            Self::Start => (
                "start".to_owned(),
                "Boolean",
                r#"causality="input" variability="discrete" start="false""#,
                None,
                "The program begins where it becomes true, unless it runs already",
            ),
            Self::Override => (
                "override".to_owned(),
                "Float64",
                r#"causality="input" variability="discrete" start="1" min="0" max="1""#,
                None,
                "How fast the program's time passes; the path stays the same",
            ),
            Self::Q(j) => {
                (format!("q[{}]", j + 1), "Float64", CONTINUOUS, Some("rad"), "Position of a joint")
            }
            Self::Dq(j) => (
                format!("dq[{}]", j + 1),
                "Float64",
                CONTINUOUS,
                Some("rad/s"),
                "Velocity of a joint",
            ),
            Self::Tcp(i) => (
                format!("tcp[{}]", i + 1),
                "Float64",
                CONTINUOUS,
                Some("m"),
                "Position of the TCP in the robot's base frame: x, y, z",
            ),
            Self::Orientation(i) => (
                format!("orientation[{}]", i + 1),
                "Float64",
                CONTINUOUS,
                None,
                "Orientation of the TCP there, a unit quaternion: x, y, z, w",
            ),
            Self::Motion => (
                "motion".to_owned(),
                "Int32",
                DISCRETE,
                None,
                "The motion of the program, from 1; 0 while it does not run",
            ),
            Self::Done => {
                ("done".to_owned(), "Boolean", DISCRETE, None, "The program has come to its end")
            }
        };
        Declaration { name, element, role, unit, description }
    }
}
