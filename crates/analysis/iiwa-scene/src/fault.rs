//! Faults of a scene.

use std::fmt::Write as _;

use iiwa_json::{JsonPlace, JsonStep, locate};

use crate::links::IgnoredPair;

/// Fault of a scene. Obstacles are numbered from 0 here and from 1 in the message.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneFault {
    /// Too many obstacles.
    #[error("the scene has {found} obstacles; it may have {max}")]
    TooMany {
        /// Number of obstacles.
        found: usize,
        /// Maximum number.
        max: usize,
    },
    /// Name that is empty, too long or contains control characters.
    #[error(
        "obstacle {}: the name {found:?} cannot be used; write 1 to {max} characters, none of them \
         a control character",
        .obstacle + 1
    )]
    Name {
        /// Index of the obstacle.
        obstacle: usize,
        /// Name, or its beginning.
        found: String,
        /// Maximum length, in characters.
        max: usize,
    },
    /// Two obstacles with the same name.
    #[error("obstacle {}: it is called {name:?}, and so is obstacle {}", .obstacle + 1, .other + 1)]
    SameName {
        /// Index of the obstacle.
        obstacle: usize,
        /// Index of the preceding obstacle with this name.
        other: usize,
        /// Name.
        name: String,
    },
    /// Number that is out of range or not finite.
    #[error("obstacle {}: {}", .obstacle + 1, range(.key, *.axis, [*.found, *.min, *.max]))]
    Range {
        /// Index of the obstacle.
        obstacle: usize,
        /// Quantity: `center`, `origin`, `size`, `rpy`, `point`, `normal`, `radius` or `length`.
        key: &'static str,
        /// Index of the number, 0 to 2; none for a single number.
        axis: Option<usize>,
        /// Value, in m or rad.
        found: f64,
        /// Minimum.
        min: f64,
        /// Maximum.
        max: f64,
    },
    /// Too many triangles in all meshes of obstacles.
    #[error(
        "the obstacles have more than {max} triangles in all ({found} in the meshes read so far): \
         make their meshes coarser"
    )]
    TooManyTriangles {
        /// Number of triangles, up to the first obstacle that exceeds the maximum.
        found: usize,
        /// Maximum number.
        max: usize,
    },
    /// Too many shapes of the tool.
    #[error("the tool has {found} shapes; it may have {max}")]
    LargeTool {
        /// Number of shapes.
        found: usize,
        /// Maximum number.
        max: usize,
    },
    /// Number of the tool that is out of range or not finite.
    #[error("tool, shape {}: {}", .shape + 1, range(.key, *.axis, [*.found, *.min, *.max]))]
    Tool {
        /// Index of the shape.
        shape: usize,
        /// Quantity: `center`, `origin`, `size`, `rpy`, `radius` or `length`.
        key: &'static str,
        /// Index of the number, 0 to 2; none for a single number.
        axis: Option<usize>,
        /// Value, in m or rad.
        found: f64,
        /// Minimum.
        min: f64,
        /// Maximum.
        max: f64,
    },
    /// Ignored pair with a link or an obstacle that does not exist. Pairs are numbered from 0 here.
    #[error(
        "ignored pair {}: link {} or obstacle {} does not exist",
        .pair + 1,
        .found.link,
        .found.obstacle + 1
    )]
    Ignored {
        /// Index of the pair.
        pair: usize,
        /// Contents of the pair.
        found: IgnoredPair,
    },
    /// Normal of a plane with zero length.
    #[error("obstacle {}: the normal has zero length", .obstacle + 1)]
    NoDirection {
        /// Index of the obstacle.
        obstacle: usize,
    },
}

impl SceneFault {
    /// Returns the place of the fault in the scene's JSON text.
    #[must_use]
    pub fn place_in(&self, text: &str) -> JsonPlace {
        use JsonStep::{Index, Key};
        let obstacles = Key("obstacles");
        match *self {
            Self::TooMany { .. } | Self::TooManyTriangles { .. } => locate(text, &[obstacles]),
            Self::Name { obstacle, .. } | Self::SameName { obstacle, .. } => {
                locate(text, &[obstacles, Index(obstacle), Key("name")])
            }
            Self::Range { obstacle, key, axis, .. } => {
                let mut path = vec![obstacles, Index(obstacle), Key(in_file(key).0)];
                path.extend(axis.map(Index));
                locate(text, &path)
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

/// Returns a vector's key in a file, and the unit factor of its numbers there.
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

/// Describes a number that is out of range, in the units of a file: one of a vector, or a single
/// number.
fn range(key: &'static str, axis: Option<usize>, numbers: [f64; 3]) -> String {
    let (name, factor) = in_file(key);
    // Rounded to six decimals, without the digits that result from the change of units.
    let shown = |value: f64| {
        let value = value * factor;
        let rounded = (value * 1e6).round() / 1e6;
        if rounded.is_finite() { rounded } else { value }
    };
    let [value, min, max] = numbers.map(shown);
    let mut text = match axis {
        Some(axis) => format!("number {} of {name} is {value}", axis + 1),
        None => format!("{name} is {value}"),
    };
    if key == "size" && value <= 0.0 {
        text.push_str("; a size is above 0");
    } else if key != "normal" {
        let _ = write!(text, "; it must be from {min} to {max}");
    }
    text
}
