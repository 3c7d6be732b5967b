//! Errors of data files.

use iiwa_json::JsonPlace;

/// Error of reading the data file of a Sunrise project.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DataFileError {
    /// The text is not well-formed XML.
    #[error("this is not XML: {problem}, at {place}")]
    Xml {
        /// Place of the error.
        place: JsonPlace,
        /// Message of the XML parser.
        problem: String,
    },
    /// The text is XML with another outermost element.
    #[error("the outermost element is <{root}>; a data file has <RoboticsAPIData>, at {place}")]
    NotDataFile {
        /// Place of the outermost element.
        place: JsonPlace,
        /// Name of the outermost element.
        root: String,
    },
    /// An element or an attribute is missing.
    #[error("<{owner}> has no {missing}, at {place}")]
    Missing {
        /// Place of the element.
        place: JsonPlace,
        /// Name of the element.
        owner: String,
        /// Name of the missing child element or attribute.
        missing: &'static str,
    },
    /// An attribute is not a finite number.
    #[error("{attribute} is {text:?}; it must be a finite number, at {place}")]
    Number {
        /// Place of the element.
        place: JsonPlace,
        /// Name of the attribute.
        attribute: String,
        /// Text of the attribute.
        text: String,
    },
}

impl DataFileError {
    /// Returns the place of the error in the text.
    #[must_use]
    pub fn place(&self) -> &JsonPlace {
        match self {
            Self::Xml { place, .. }
            | Self::NotDataFile { place, .. }
            | Self::Missing { place, .. }
            | Self::Number { place, .. } => place,
        }
    }

    /// Returns the message without the place.
    #[must_use]
    pub fn message(&self) -> String {
        self.place().cut_from(&self.to_string())
    }
}
