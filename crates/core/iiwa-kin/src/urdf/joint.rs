//! Joints of a URDF.

use nalgebra::{Isometry3, Unit, Vector3};

use super::{
    LIMITS, UrdfError,
    tag::{Tag, TextSpan},
};

/// A joint of a URDF.
pub(super) struct UrdfJoint<'t> {
    pub(super) name: String,
    pub(super) span: TextSpan<'t>,
    pub(super) kind: String,
    pub(super) mimics: bool,
    pub(super) parent: String,
    pub(super) child: String,
    pub(super) origin: Isometry3<f64>,
    pub(super) axis: Unit<Vector3<f64>>,
    /// Limits in the order of [`LIMITS`].
    pub(super) limits: [Option<f64>; 4],
}

impl UrdfJoint<'_> {
    pub(super) fn is_revolute(&self) -> bool {
        self.kind == "revolute" && !self.mimics
    }

    pub(super) fn is_fixed(&self) -> bool {
        self.kind == "fixed" && !self.mimics
    }
}

/// A joint that is being read.
pub(super) struct Draft<'t> {
    pub(super) joint: UrdfJoint<'t>,
    /// Names of the child elements read so far.
    parts: Vec<String>,
}

impl<'t> Draft<'t> {
    pub(super) fn new(tag: &Tag<'_, 't>) -> Result<Self, UrdfError> {
        let name = tag.required("name", "a joint")?;
        let joint = UrdfJoint {
            span: tag.span,
            kind: tag.required("type", &format!("joint {name:?}"))?,
            name,
            mimics: false,
            parent: String::new(),
            child: String::new(),
            origin: Isometry3::identity(),
            axis: Vector3::x_axis(),
            limits: [None; 4],
        };
        Ok(Self { joint, parts: Vec::new() })
    }

    /// Adds one child element of the joint.
    pub(super) fn part(
        &mut self,
        element: &[u8],
        tag: &Tag<'_, 't>,
        quaternions: bool,
    ) -> Result<(), UrdfError> {
        let joint = &mut self.joint;
        let part = String::from_utf8_lossy(element).into_owned();
        let owner = format!("the {part} of joint {:?}", joint.name);
        match &*part {
            "parent" => joint.parent = tag.required("link", &owner)?,
            "child" => joint.child = tag.required("link", &owner)?,
            "origin" => joint.origin = tag.origin(quaternions)?,
            "axis" => {
                let axis: Vector3<f64> = tag.numbers("xyz")?.unwrap_or([1.0, 0.0, 0.0]).into();
                // Scaled first, so that the squared length neither overflows nor underflows.
                joint.axis = Unit::try_new(axis / axis.amax(), 0.0).ok_or_else(|| {
                    UrdfError::ZeroAxis { place: tag.span.place(), joint: joint.name.clone() }
                })?;
            }
            "limit" => {
                for (limit, key) in joint.limits.iter_mut().zip(LIMITS) {
                    *limit = tag.numbers(key)?.map(|[number]| number);
                }
            }
            "mimic" => joint.mimics = true,
            _ => return Ok(()),
        }
        if self.parts.contains(&part) {
            return Err(UrdfError::Duplicate { place: tag.span.place(), owner });
        }
        self.parts.push(part);
        Ok(())
    }

    pub(super) fn finish(self) -> Result<UrdfJoint<'t>, UrdfError> {
        for (part, missing) in [("parent", "<parent>"), ("child", "<child>")] {
            if !self.parts.iter().any(|known| known == part) {
                let owner = format!("joint {:?}", self.joint.name);
                return Err(UrdfError::Missing { place: self.joint.span.place(), owner, missing });
            }
        }
        Ok(self.joint)
    }
}
