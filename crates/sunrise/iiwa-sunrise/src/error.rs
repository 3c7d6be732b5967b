//! What can be wrong with a data file.

use iiwa_json::Place;

/// Why a text is no data file of a Sunrise project.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DataFileError {
    /// The text is not well-formed XML.
    #[error("this is not XML: {problem}, at {at}")]
    Xml {
        /// Where.
        at: Place,
        /// What the parser says.
        problem: String,
    },
    /// The text is XML of another kind.
    #[error("the outermost element is <{found}>; a data file has <RoboticsAPIData>, at {at}")]
    NotDataFile {
        /// Where.
        at: Place,
        /// The element found.
        found: String,
    },
    /// An element or an attribute is missing.
    #[error("<{owner}> has no {missing}, at {at}")]
    Missing {
        /// Where.
        at: Place,
        /// The element.
        owner: String,
        /// What it should have.
        missing: &'static str,
    },
    /// An attribute is not a finite number.
    #[error("{attribute} is {found:?}; it must be a finite number, at {at}")]
    Number {
        /// Where.
        at: Place,
        /// The attribute.
        attribute: String,
        /// Its text.
        found: String,
    },
}

impl DataFileError {
    /// Where in the text.
    #[must_use]
    pub fn place(&self) -> &Place {
        match self {
            Self::Xml { at, .. }
            | Self::NotDataFile { at, .. }
            | Self::Missing { at, .. }
            | Self::Number { at, .. } => at,
        }
    }

    /// What is wrong, without the place.
    #[must_use]
    pub fn what(&self) -> String {
        self.place().cut_from(&self.to_string())
    }
}
