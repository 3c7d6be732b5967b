//! What can be wrong with a URDF.

use std::fmt;

use iiwa_json::Place;

/// Why a URDF is not a description of a model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UrdfError {
    /// The text is not well-formed XML.
    #[error("this is not XML: {problem}, at {at}")]
    Xml {
        /// Where.
        at: Place,
        /// What the parser says.
        problem: String,
    },
    /// The text is XML, but not a URDF.
    #[error("the outermost element is <{found}>; a URDF has <robot>, at {at}")]
    NotUrdf {
        /// Where.
        at: Place,
        /// The element found.
        found: String,
    },
    /// An element or an attribute is missing.
    #[error("{owner} has no {missing}, at {at}")]
    Missing {
        /// Where.
        at: Place,
        /// The link or joint.
        owner: String,
        /// What it should have.
        missing: &'static str,
    },
    /// Something that there may be one of is there again.
    #[error("{owner} is here for the second time; remove one, at {at}")]
    Duplicate {
        /// Where the second one is.
        at: Place,
        /// What there are two of.
        owner: String,
    },
    /// An attribute is not made of as many numbers as it must be.
    #[error("{attribute} is {found:?}; it must be {} finite number{}{}, at {at}",
        expected, if *expected == 1 { "" } else { "s" },
        if found.contains("${") { " (expand the xacro file first)" } else { "" })]
    Numbers {
        /// Where.
        at: Place,
        /// The attribute.
        attribute: String,
        /// Its text.
        found: String,
        /// How many numbers it must have.
        expected: usize,
    },
    /// A joint's axis has no direction.
    #[error("joint {joint:?} turns about the axis 0 0 0; give it a direction, at {at}")]
    ZeroAxis {
        /// Where.
        at: Place,
        /// The joint.
        joint: String,
    },
    /// A joint names a link that the file does not have.
    #[error("joint {joint:?} names the link {link:?}, which the file does not have, at {at}")]
    UnknownLink {
        /// Where.
        at: Place,
        /// The joint.
        joint: String,
        /// The link.
        link: String,
    },
    /// Two joints carry the same link.
    #[error("joint {joint:?} carries link {link:?}, as another joint does already, at {at}")]
    SecondParent {
        /// Where.
        at: Place,
        /// The second joint.
        joint: String,
        /// The link.
        link: String,
    },
    /// A link is, over some joints, its own parent.
    #[error("the joints above link {link:?} run in a circle, at {at}")]
    Cycle {
        /// Where.
        at: Place,
        /// A link of the circle, or below it.
        link: String,
    },
    /// The tip asked for is not a link of the file.
    #[error("no link is called {tip:?}; choose one of {links}, at {at}")]
    UnknownTip {
        /// Where.
        at: Place,
        /// The tip asked for.
        tip: String,
        /// The links there are.
        links: Listed,
    },
    /// No tip was asked for and several links could be it.
    #[error("these links all end a chain of seven joints: {links}; name one as the tip, at {at}")]
    AmbiguousTip {
        /// Where.
        at: Place,
        /// The links.
        links: Listed,
    },
    /// The chain does not have seven revolute joints.
    #[error("the chain up to link {tip:?} has {found} revolute joints; the iiwa has 7, at {at}")]
    JointCount {
        /// Where.
        at: Place,
        /// The end of the chain.
        tip: String,
        /// How many revolute joints it has.
        found: usize,
    },
    /// A joint of the chain is neither revolute nor fixed, or mimics another.
    #[error("joint {joint:?} is {found}; the iiwa's joints are revolute or fixed, at {at}")]
    JointKind {
        /// Where.
        at: Place,
        /// The joint.
        joint: String,
        /// Its type, or `mimic`.
        found: String,
    },
    /// An axis is not where the model has it.
    #[error(
        "with all joints at zero, the axis of joint {number} ({joint:?}) is {:.3} mm and {:.4} deg \
         off the model's; compare its origin and the one before it with the model's lengths, at \
         {at}",
        position_m * 1e3, rotation_rad.to_degrees()
    )]
    Axis {
        /// Where: the joint.
        at: Place,
        /// The first joint whose axis is off, from 1.
        number: usize,
        /// Its name.
        joint: String,
        /// Distance of the two axes, in m.
        position_m: f64,
        /// Angle between the two axes, in rad.
        rotation_rad: f64,
    },
    /// The axes are where the model has them, the tip is not.
    #[error(
        "the seven axes are the model's, but link {tip:?} is {:.3} mm and {:.4} deg off the \
         flange; name another tip, or take a profile with this flange for the model, at {at}",
        position_m * 1e3, rotation_rad.to_degrees()
    )]
    Tip {
        /// Where: the last joint of the chain.
        at: Place,
        /// The tip.
        tip: String,
        /// The largest distance from the model's flange, in m.
        position_m: f64,
        /// The largest angle to the model's flange, in rad.
        rotation_rad: f64,
    },
}

impl UrdfError {
    /// Where in the text.
    #[must_use]
    pub fn place(&self) -> &Place {
        match self {
            Self::Xml { at, .. }
            | Self::NotUrdf { at, .. }
            | Self::Missing { at, .. }
            | Self::Duplicate { at, .. }
            | Self::Numbers { at, .. }
            | Self::ZeroAxis { at, .. }
            | Self::UnknownLink { at, .. }
            | Self::SecondParent { at, .. }
            | Self::Cycle { at, .. }
            | Self::UnknownTip { at, .. }
            | Self::AmbiguousTip { at, .. }
            | Self::JointCount { at, .. }
            | Self::JointKind { at, .. }
            | Self::Axis { at, .. }
            | Self::Tip { at, .. } => at,
        }
    }

    /// What is wrong, without the place.
    #[must_use]
    pub fn what(&self) -> String {
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
