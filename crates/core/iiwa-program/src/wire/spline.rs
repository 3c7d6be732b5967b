//! JSON form of splines.

use iiwa_json::JsonObject;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, de::IgnoredAny};

use super::{
    by_name::{word, word_or_null},
    cartesian::{CircOptions, EndWire, PathBlendWire, ReferenceWire, is_default, path_wire},
    frames::{AuxRefWire, TargetRefWire},
    limits::limited_wire,
};
use crate::{
    cartesian_motion::{
        AuxOrientation, CartesianMotion, Course, OrientationType, SegmentCourse, SegmentLimits,
        SplineSegment,
    },
    program::Motion,
    target::TargetRef,
};

path_wire! {
    /// TCP path through the ends of segments without a stop.
    #[schemars(rename = "Spline")]
    SplineWire, SplineTag = "spline" {
        /// Segments from frame to frame.
        #[schemars(with = "Vec<SegmentWire>", length(min = 1, max = 20))]
        segments: Vec<JsonObject<SegmentWire>>,
    }
}

path_wire! {
    /// A spline of one segment: a straight TCP line to a frame.
    #[schemars(rename = "Spl")]
    SplWire, SplTag = "spl" {
        /// Target frame.
        frame: TargetRefWire,
    }
}

/// Segment types.
#[derive(Clone, Copy, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "SegmentType")]
pub(super) enum SegmentType {
    /// A curve defined by the frames of the spline.
    #[default]
    Spl,
    /// A straight line.
    Lin,
    /// A circle.
    Circ,
}

limited_wire! {
    /// A spline segment. The keys of circles are for segments of type `circ` only.
    #[schemars(
        rename = "Segment",
        extend("oneOf" = [
            { "properties": { "type": { "const": "circ" } }, "required": ["aux"] },
            { "properties": { "type": { "enum": ["spl", "lin"] }, "aux": false,
              "circ_angle_deg": false, "orientation_reference": false, "aux_orientation": false,
              "end_orientation": false } }
        ])
    )]
    SegmentWire declared by plain_wire {
        #[serde(deserialize_with = "word")]
        r#type: SegmentType,
        /// Target frame.
        frame: TargetRefWire,
        /// Orientation interpolation; the spline's by default.
        #[serde(
            default,
            deserialize_with = "word_or_null",
            skip_serializing_if = "Option::is_none"
        )]
        orientation: Option<OrientationType>,
        /// Auxiliary frame of a circle.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        aux: Option<AuxRefWire>,
        /// Angle of a circle's arc, in degrees; the arc ends at the end frame by default.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = -360, max = 360))]
        circ_angle_deg: Option<f64>,
        /// Reference of the orientation on a circle: the base, or the path.
        #[serde(default, deserialize_with = "word", skip_serializing_if = "ReferenceWire::is_base")]
        orientation_reference: ReferenceWire,
        /// Use of the orientation of a circle's auxiliary frame.
        #[serde(default, deserialize_with = "word", skip_serializing_if = "is_default")]
        aux_orientation: AuxOrientation,
        /// Place where the orientation of a circle's end frame is reached, for an arc with an
        /// angle.
        #[serde(
            default,
            deserialize_with = "word",
            skip_serializing_if = "EndWire::is_interpolate"
        )]
        end_orientation: EndWire,
    } {
        /// Key of whole splines only, read here to give a specific error.
        #[serde(default, skip_serializing)]
        #[schemars(skip)]
        blend: Option<IgnoredAny>,
    }
}

/// Error of a segment: its index, the key and a message.
pub(super) struct WrongSegment {
    pub(super) index: usize,
    pub(super) key: &'static str,
    pub(super) message: String,
}

impl SplineWire {
    pub(super) fn motion(mut self) -> Result<Motion, WrongSegment> {
        let segments = std::mem::take(&mut self.segments).into_iter().enumerate();
        let segments = segments.map(|(index, JsonObject(segment))| {
            segment.segment().map_err(|(key, message)| WrongSegment { index, key, message })
        });
        let segments = segments.collect::<Result<_, _>>()?;
        Ok(self.on(Course::Spline(segments)))
    }

    pub(super) fn new(motion: &CartesianMotion, segments: &[SplineSegment]) -> Self {
        let segments = segments.iter().map(|segment| JsonObject(segment.into()));
        Self::of(motion, segments.collect())
    }
}

impl SplWire {
    pub(super) fn motion(mut self) -> Result<Motion, (&'static str, String)> {
        let to = std::mem::take(&mut self.frame).target().map_err(|message| ("frame", message))?;
        let course = SegmentCourse::Spl { to };
        Ok(self.on(Course::Spline(vec![SplineSegment {
            course,
            orientation: None,
            limits: SegmentLimits::default(),
        }])))
    }

    pub(super) fn new(motion: &CartesianMotion, to: &TargetRef) -> Self {
        Self::of(motion, to.into())
    }
}

impl SegmentWire {
    fn segment(self) -> Result<SplineSegment, (&'static str, String)> {
        if self.blend.is_some() {
            let message = "a segment of a spline cannot be blended: blend the whole spline";
            return Err(("blend", message.to_owned()));
        }
        let for_circles = [
            ("aux", self.aux.is_some()),
            ("circ_angle_deg", self.circ_angle_deg.is_some()),
            ("orientation_reference", !self.orientation_reference.is_base()),
            ("aux_orientation", !is_default(&self.aux_orientation)),
            ("end_orientation", !self.end_orientation.is_interpolate()),
        ];
        let limits = self.limits();
        let to = self.frame.target().map_err(|message| ("frame", message))?;
        let course = if self.r#type == SegmentType::Circ {
            let aux =
                self.aux.ok_or(("type", "a circle needs `aux`, a frame on its way".to_owned()))?;
            let options = CircOptions {
                angle_deg: self.circ_angle_deg,
                reference: self.orientation_reference,
                aux: self.aux_orientation,
                end: self.end_orientation,
            };
            SegmentCourse::Circ(options.circ(aux, Ok(to))?)
        } else if let Some((key, _)) = for_circles.into_iter().find(|(_, is_given)| *is_given) {
            return Err((key, format!("`{key}` is for segments of type `circ`")));
        } else if self.r#type == SegmentType::Lin {
            SegmentCourse::Lin { to }
        } else {
            SegmentCourse::Spl { to }
        };
        Ok(SplineSegment { course, orientation: self.orientation, limits })
    }
}

impl From<&SplineSegment> for SegmentWire {
    fn from(segment: &SplineSegment) -> Self {
        let plain = |r#type| {
            let plain = Self {
                r#type,
                frame: segment.course.target().into(),
                orientation: segment.orientation,
                ..Self::default()
            };
            plain.with_limits(&segment.limits)
        };
        match &segment.course {
            SegmentCourse::Spl { .. } => plain(SegmentType::Spl),
            SegmentCourse::Lin { .. } => plain(SegmentType::Lin),
            SegmentCourse::Circ(circ) => {
                let CircOptions { angle_deg, reference, aux, end } = circ.into();
                Self {
                    aux: Some((&circ.aux).into()),
                    circ_angle_deg: angle_deg,
                    orientation_reference: reference,
                    aux_orientation: aux,
                    end_orientation: end,
                    ..plain(SegmentType::Circ)
                }
            }
        }
    }
}
