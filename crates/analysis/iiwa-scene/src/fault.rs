//! What can be wrong with a scene.

use std::fmt::Write as _;

use iiwa_json::{Place, Step, locate};

use crate::links::IgnoredPair;

/// Something in a scene that cannot be. Obstacles count from 0 here and from 1 in the message.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// There are too many obstacles.
    #[error("the scene has {found} obstacles; it may have {max}")]
    TooMany {
        /// How many there are.
        found: usize,
        /// How many there may be.
        max: usize,
    },
    /// A name is empty, too long or has control characters.
    #[error(
        "obstacle {}: the name {found:?} cannot be used; write 1 to {max} characters, none of them \
         a control character",
        .obstacle + 1
    )]
    Name {
        /// The obstacle.
        obstacle: usize,
        /// The name, or its start.
        found: String,
        /// Longest name, in characters.
        max: usize,
    },
    /// Two obstacles have the same name.
    #[error("obstacle {}: it is called {name:?}, and so is obstacle {}", .obstacle + 1, .other + 1)]
    SameName {
        /// The obstacle.
        obstacle: usize,
        /// The one before it that has the name already.
        other: usize,
        /// The name.
        name: String,
    },
    /// A number is out of range, or is none.
    #[error("obstacle {}: {}", .obstacle + 1, range(.key, *.axis, [*.found, *.min, *.max]))]
    Range {
        /// The obstacle.
        obstacle: usize,
        /// Which of its vectors: `center`, `size`, `rpy`, `point` or `normal`.
        key: &'static str,
        /// Which number of it: 0 to 2.
        axis: usize,
        /// What it is, in m or rad.
        found: f64,
        /// What it has to be at least.
        min: f64,
        /// What it may be at most.
        max: f64,
    },
    /// The tool has too many shapes.
    #[error("the tool has {found} shapes; it may have {max}")]
    LargeTool {
        /// How many there are.
        found: usize,
        /// How many there may be.
        max: usize,
    },
    /// A number of the tool is out of range, or is none.
    #[error("tool, shape {}: {}", .shape + 1, tool_range(.key, *.axis, [*.found, *.min, *.max]))]
    Tool {
        /// The shape.
        shape: usize,
        /// What: `center`, `origin`, `size`, `rpy`, `radius` or `length`.
        key: &'static str,
        /// Which number of it, 0 to 2; none if there is only one.
        axis: Option<usize>,
        /// What it is, in m or rad.
        found: f64,
        /// What it has to be at least.
        min: f64,
        /// What it may be at most.
        max: f64,
    },
    /// A pair that is to be ignored has a link or an obstacle that does not exist. Pairs count from 0 here.
    #[error("ignored pair {}: there is no link {} or no obstacle {}", .pair + 1, .found.link, .found.obstacle + 1)]
    Ignored {
        /// The pair.
        pair: usize,
        /// What it says.
        found: IgnoredPair,
    },
    /// The normal of a plane is zero.
    #[error("obstacle {}: a normal of length zero points nowhere", .obstacle + 1)]
    NoDirection {
        /// The obstacle.
        obstacle: usize,
    },
}

impl Fault {
    /// The place of the fault in the scene's JSON text.
    #[must_use]
    pub fn place_in(&self, text: &str) -> Place {
        use Step::{Index, Key};
        let obstacles = Key("obstacles");
        match *self {
            Self::TooMany { .. } => locate(text, &[obstacles]),
            Self::Name { obstacle, .. } | Self::SameName { obstacle, .. } => {
                locate(text, &[obstacles, Index(obstacle), Key("name")])
            }
            Self::Range { obstacle, key, axis, .. } => {
                locate(text, &[obstacles, Index(obstacle), Key(in_file(key).0), Index(axis)])
            }
            Self::LargeTool { .. } => locate(text, &[Key("tool")]),
            Self::Tool { shape, key, axis, .. } => {
                let mut path = vec![Key("tool"), Index(shape), Key(in_file(key).0)];
                path.extend(axis.map(Index));
                locate(text, &path)
            }
            Self::Ignored { pair, .. } => locate(text, &[Key("ignore"), Index(pair)]),
            Self::NoDirection { obstacle } => {
                locate(text, &[obstacles, Index(obstacle), Key("normal")])
            }
        }
    }
}

/// A vector's key in a file, and what its numbers are multiplied by there.
fn in_file(key: &'static str) -> (&'static str, f64) {
    match key {
        "center" => ("center_mm", 1e3),
        "origin" => ("origin_mm", 1e3),
        "size" => ("size_mm", 1e3),
        "radius" => ("radius_mm", 1e3),
        "length" => ("length_mm", 1e3),
        "point" => ("point_mm", 1e3),
        "rpy" => ("rpy_deg", 1_f64.to_degrees()),
        other => (other, 1.0),
    }
}

/// The same of a tool's shape, which has single numbers, too.
fn tool_range(key: &'static str, axis: Option<usize>, numbers: [f64; 3]) -> String {
    if let Some(axis) = axis {
        return range(key, axis, numbers);
    }
    let (name, factor) = in_file(key);
    let [found, min, max] = numbers.map(|value| value * factor);
    format!("{name} is {found}; it must be from {min} to {max}")
}

/// What is wrong with a number, as it stands in a file.
fn range(key: &'static str, axis: usize, numbers: [f64; 3]) -> String {
    let (name, factor) = in_file(key);
    // As many places as anybody writes, and none that only the change of units makes.
    let shown = |value: f64| {
        let value = value * factor;
        let rounded = (value * 1e6).round() / 1e6;
        if rounded.is_finite() { rounded } else { value }
    };
    let [found, min, max] = numbers.map(shown);
    let mut text = format!("number {} of {name} is {found}", axis + 1);
    if key == "size" && found <= 0.0 {
        text.push_str("; a size is above 0");
    } else if key != "normal" {
        let _ = write!(text, "; it must be from {min} to {max}");
    }
    text
}
