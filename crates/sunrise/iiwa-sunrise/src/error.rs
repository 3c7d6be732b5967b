//! Errors of data files.

use iiwa_json::Place;

/// Error of reading the data file of a Sunrise project.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DataFileError {
    /// The text is not well-formed XML.
    #[error("this is not XML: {problem}, at {at}")]
    Xml {
        /// Place of the error.
        at: Place,
        /// Message of the XML parser.
        problem: String,
    },
    /// The text is XML with another outermost element.
    #[error("the outermost element is <{found}>; a data file has <RoboticsAPIData>, at {at}")]
    NotDataFile {
        /// Place of the outermost element.
        at: Place,
        /// Name of the outermost element.
        found: String,
    },
    /// An element or an attribute is missing.
    #[error("<{owner}> has no {missing}, at {at}")]
    Missing {
        /// Place of the element.
        at: Place,
        /// Name of the element.
        owner: String,
        /// Name of the missing child element or attribute.
        missing: &'static str,
    },
    /// An attribute is not a finite number.
    #[error("{attribute} is {found:?}; it must be a finite number, at {at}")]
    Number {
        /// Place of the element.
        at: Place,
        /// Name of the attribute.
        attribute: String,
        /// Text of the attribute.
        found: String,
    },
}

impl DataFileError {
    /// Returns the place of the error in the text.
    #[must_use]
    pub fn place(&self) -> &Place {
        match self {
            Self::Xml { at: place, .. }
            | Self::NotDataFile { at: place, .. }
            | Self::Missing { at: place, .. }
            | Self::Number { at: place, .. } => place,
        }
    }

    /// Returns the message without the place.
    #[must_use]
    pub fn what(&self) -> String {
        self.place().cut_from(&self.to_string())
    }
}
