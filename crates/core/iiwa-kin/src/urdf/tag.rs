//! Start tags, with their attributes and places.

use iiwa_json::JsonPlace;
use nalgebra::{Isometry3, Quaternion, Translation3, Unit, UnitQuaternion};
use quick_xml::{escape::EscapeError, events::BytesStart};

use super::UrdfError;

/// Byte range of a text; line and column are computed only on demand.
#[derive(Clone, Copy)]
pub(super) struct TextSpan<'t> {
    pub(super) text: &'t str,
    pub(super) start: usize,
    pub(super) end: usize,
}

impl TextSpan<'_> {
    pub(super) fn place(self) -> JsonPlace {
        JsonPlace::of_span(self.text, self.start..self.end)
    }
}

/// Start tag of an element.
pub(super) struct Tag<'a, 't> {
    pub(super) element: &'a BytesStart<'a>,
    pub(super) span: TextSpan<'t>,
}

impl Tag<'_, '_> {
    pub(super) fn attribute(&self, name: &str) -> Result<Option<String>, UrdfError> {
        let xml = |problem: String| UrdfError::Xml { place: self.span.place(), problem };
        let mut decoded = None;
        // The library's duplicate check takes quadratic time in the number of attributes.
        for attribute in self.element.attributes().with_checks(false) {
            let attribute = attribute.map_err(|error| xml(error.to_string()))?;
            if attribute.key.as_ref() == name.as_bytes() {
                let value = attribute.decode_and_unescape_value(self.element.decoder()).map_err(
                    |error| self.entity(&error).unwrap_or_else(|| xml(error.to_string())),
                )?;
                if decoded.replace(value.into_owned()).is_some() {
                    return Err(xml(format!("the attribute {name} appears twice")));
                }
            }
        }
        Ok(decoded)
    }

    /// The error for an entity that is not predefined, if that is the cause.
    fn entity(&self, error: &quick_xml::Error) -> Option<UrdfError> {
        let quick_xml::Error::Escape(EscapeError::UnrecognizedEntity(_, entity)) = error else {
            return None;
        };
        Some(UrdfError::Entity { place: self.span.place(), entity: entity.clone() })
    }

    pub(super) fn required(&self, name: &'static str, owner: &str) -> Result<String, UrdfError> {
        self.attribute(name)?.ok_or_else(|| UrdfError::Missing {
            place: self.span.place(),
            owner: owner.to_owned(),
            missing: name,
        })
    }

    /// The `N` numbers of an attribute, if present.
    pub(super) fn numbers<const N: usize>(
        &self,
        name: &str,
    ) -> Result<Option<[f64; N]>, UrdfError> {
        let Some(value) = self.attribute(name)? else { return Ok(None) };
        let numbers: Option<Vec<f64>> = value
            .split_whitespace()
            .take(N + 1)
            .map(|number| number.parse().ok().filter(|number: &f64| number.is_finite()))
            .collect();
        match numbers.and_then(|numbers| <[f64; N]>::try_from(numbers).ok()) {
            Some(numbers) => Ok(Some(numbers)),
            None => Err(UrdfError::Numbers {
                place: self.span.place(),
                attribute: name.to_owned(),
                found: value.chars().take(80).collect(),
                expected: N,
            }),
        }
    }

    /// An `origin` element. URDF versions after 1.0 may have a quaternion, which readers of 1.0
    /// skip.
    pub(super) fn origin(&self, quaternions: bool) -> Result<Isometry3<f64>, UrdfError> {
        let xyz = self.numbers("xyz")?.unwrap_or([0.0; 3]);
        let rotation = match self.numbers("rpy")? {
            Some([roll, pitch, yaw]) => UnitQuaternion::from_euler_angles(roll, pitch, yaw),
            None if quaternions => {
                let [x, y, z, w] = self.numbers("quat_xyzw")?.unwrap_or([0.0, 0.0, 0.0, 1.0]);
                let quaternion = Quaternion::new(w, x, y, z);
                Unit::try_new(quaternion, 1e-9).unwrap_or_else(UnitQuaternion::identity)
            }
            None => UnitQuaternion::identity(),
        };
        Ok(Isometry3::from_parts(Translation3::from(xyz), rotation))
    }
}
