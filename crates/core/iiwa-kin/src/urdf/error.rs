//! URDF errors.

use std::fmt;

use iiwa_json::JsonPlace;

/// Error: a URDF is invalid or does not match a model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UrdfError {
    /// The text is not well-formed XML.
    #[error("this is not XML: {problem}, at {place}")]
    Xml {
        /// Place in the text.
        place: JsonPlace,
        /// Message of the parser.
        problem: String,
    },
    /// The text is XML, but not a URDF.
    #[error("the outermost element is <{found}>; a URDF has <robot>, at {place}")]
    NotUrdf {
        /// Place in the text.
        place: JsonPlace,
        /// Element found.
        found: String,
    },
    /// An element or an attribute is missing.
    #[error("{owner} has no {missing}, at {place}")]
    Missing {
        /// Place in the text.
        place: JsonPlace,
        /// Link or joint that lacks it.
        owner: String,
        /// Name of the missing element or attribute.
        missing: &'static str,
    },
    /// A unique element occurs again.
    #[error("{owner} appears twice; remove one, at {place}")]
    Duplicate {
        /// Place of the second occurrence.
        place: JsonPlace,
        /// Name of the duplicated element.
        owner: String,
    },
    /// An attribute does not have the expected count of numbers.
    #[error("{attribute} is {found:?}; it must be {} finite number{}{}, at {place}",
        expected, if *expected == 1 { "" } else { "s" },
        if found.contains("${") { " (expand the xacro file first)" } else { "" })]
    Numbers {
        /// Place in the text.
        place: JsonPlace,
        /// Attribute name.
        attribute: String,
        /// Attribute text.
        found: String,
        /// Expected count of numbers.
        expected: usize,
    },
    /// A joint axis has zero length.
    #[error("joint {joint:?} turns about the axis 0 0 0; give it a direction, at {place}")]
    ZeroAxis {
        /// Place in the text.
        place: JsonPlace,
        /// Joint name.
        joint: String,
    },
    /// A joint names a link that the file does not define.
    #[error("joint {joint:?} names the link {link:?}, which the file does not have, at {place}")]
    UnknownLink {
        /// Place in the text.
        place: JsonPlace,
        /// Joint name.
        joint: String,
        /// Link name.
        link: String,
    },
    /// Two joints have the same child link.
    #[error("joint {joint:?} carries link {link:?}, as another joint does already, at {place}")]
    SecondParent {
        /// Place in the text.
        place: JsonPlace,
        /// Name of the second joint.
        joint: String,
        /// Link name.
        link: String,
    },
    /// The joints form a cycle.
    #[error("the joints above link {link:?} run in a circle, at {place}")]
    Cycle {
        /// Place in the text.
        place: JsonPlace,
        /// A link on the cycle, or below it.
        link: String,
    },
    /// The requested tip is not a link of the file.
    #[error("no link is called {tip:?}; choose one of {links}, at {place}")]
    UnknownTip {
        /// Place in the text.
        place: JsonPlace,
        /// Requested tip.
        tip: String,
        /// Links of the file.
        links: Listed,
    },
    /// No tip was requested and several links qualify.
    #[error(
        "these links all end a chain of seven joints: {links}; name one as the tip, at {place}"
    )]
    AmbiguousTip {
        /// Place in the text.
        place: JsonPlace,
        /// The candidate links.
        links: Listed,
    },
    /// Several arms have seven joints each.
    #[error(
        "several arms have seven joints, with the last links {links}; keep one of them in the \
         file, at {place}"
    )]
    SeveralArms {
        /// Place in the text.
        place: JsonPlace,
        /// Link that the seventh joint of each arm moves.
        links: Listed,
    },
    /// The file is a xacro file, whose macros are not expanded.
    #[error(
        "this is a xacro file with <{element}>, not a URDF; expand it first, for example with \
         `xacro FILE.xacro > FILE.urdf`, at {place}"
    )]
    Xacro {
        /// Place of the first xacro element.
        place: JsonPlace,
        /// Name of the element.
        element: String,
    },
    /// The text uses an entity that XML does not predefine.
    #[error(
        "the entity &{entity}; is defined by a document type, which is not read; replace it by \
         its text, at {place}"
    )]
    Entity {
        /// Place in the text.
        place: JsonPlace,
        /// Name of the entity.
        entity: String,
    },
    /// The chain does not have seven revolute joints.
    #[error("the chain up to link {tip:?} has {found} revolute joints; the iiwa has 7, at {place}")]
    JointCount {
        /// Place in the text.
        place: JsonPlace,
        /// End of the chain.
        tip: String,
        /// Number of revolute joints found.
        found: usize,
    },
    /// A joint of the chain is neither revolute nor fixed, or mimics another.
    #[error("joint {joint:?} is {found}; the iiwa's joints are revolute or fixed, at {place}")]
    JointKind {
        /// Place in the text.
        place: JsonPlace,
        /// Joint name.
        joint: String,
        /// Joint type, or `mimic`.
        found: String,
    },
    /// A joint axis differs from the model's.
    #[error(
        "with all joints at zero, the axis of joint {number} ({joint:?}) is {:.3} mm and {:.4} deg \
         off the model's; compare its origin and the one before it with the model's lengths, at \
         {place}",
        position_m * 1e3, rotation_rad.to_degrees()
    )]
    Axis {
        /// Place in the text: the joint.
        place: JsonPlace,
        /// Number of the first joint whose axis is off, from 1.
        number: usize,
        /// Joint name.
        joint: String,
        /// Distance between the two axes, in m.
        position_m: f64,
        /// Angle between the two axes, in rad.
        rotation_rad: f64,
    },
    /// The axes match the model, but the tip does not.
    #[error(
        "the seven axes are the model's, but link {tip:?} is {:.3} mm and {:.4} deg off the \
         flange; name another tip, or take a profile with this flange for the model, at {place}",
        position_m * 1e3, rotation_rad.to_degrees()
    )]
    Tip {
        /// Place in the text: the last joint of the chain.
        place: JsonPlace,
        /// Tip name.
        tip: String,
        /// Largest distance from the model's flange, in m.
        position_m: f64,
        /// Largest angle to the model's flange, in rad.
        rotation_rad: f64,
    },
}

impl UrdfError {
    /// Place of the error in the text.
    #[must_use]
    pub fn place(&self) -> &JsonPlace {
        match self {
            Self::Xml { place, .. }
            | Self::NotUrdf { place, .. }
            | Self::Missing { place, .. }
            | Self::Duplicate { place, .. }
            | Self::Numbers { place, .. }
            | Self::ZeroAxis { place, .. }
            | Self::UnknownLink { place, .. }
            | Self::SecondParent { place, .. }
            | Self::Cycle { place, .. }
            | Self::UnknownTip { place, .. }
            | Self::AmbiguousTip { place, .. }
            | Self::SeveralArms { place, .. }
            | Self::Xacro { place, .. }
            | Self::Entity { place, .. }
            | Self::JointCount { place, .. }
            | Self::JointKind { place, .. }
            | Self::Axis { place, .. }
            | Self::Tip { place, .. } => place,
        }
    }

    /// Error message without the place.
    #[must_use]
    pub fn message(&self) -> String {
        self.place().cut_from(&self.to_string())
    }
}

/// Names in a message; the first dozen are shown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listed(pub Vec<String>);

impl fmt::Display for Listed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SHOWN: usize = 12;
        let shown = self.0.len().min(SHOWN);
        f.write_str(&self.0[..shown].join(", "))?;
        if self.0.len() > SHOWN {
            write!(f, " and {} more", self.0.len() - SHOWN)?;
        }
        Ok(())
    }
}
