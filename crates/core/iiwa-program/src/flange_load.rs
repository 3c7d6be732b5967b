//! Payloads with their shapes.

use std::sync::Arc;

use iiwa_kin::Load;

/// Payload at the flange: its mass properties, and its shapes for clearances.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlangeLoad {
    /// Mass, centre of mass and moments of inertia.
    pub load: Load,
    /// Shapes, in the flange frame; empty if unknown. At most [`MAX_SHAPES`].
    pub shapes: Vec<LoadShape>,
}

/// Maximum number of shapes of a payload: each costs as much as a link.
pub const MAX_SHAPES: usize = 100;

/// Shape of a payload, in the flange frame, with z out of the flange. Rotations are about the x,
/// then y, then z axis of the flange.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LoadShape {
    /// Solid box.
    Box {
        /// Centre, in mm.
        center_mm: [f64; 3],
        /// Edge lengths along the box axes, in mm.
        size_mm: [f64; 3],
        /// Rotation, in degrees.
        rpy_deg: [f64; 3],
    },
    /// Cylinder with flat ends, along its z axis.
    Cylinder {
        /// Centre, in mm.
        center_mm: [f64; 3],
        /// Radius, in mm.
        radius_mm: f64,
        /// Length, in mm.
        length_mm: f64,
        /// Rotation, in degrees.
        rpy_deg: [f64; 3],
    },
    /// Sphere.
    Sphere {
        /// Centre, in mm.
        center_mm: [f64; 3],
        /// Radius, in mm.
        radius_mm: f64,
    },
    /// Convex hull of a mesh.
    Mesh {
        /// Mesh file, in the folder of the program or below; or its contents, as a [data
        /// URI](Self::data_uri). All rounds of a repeat block share the text.
        file: Arc<str>,
        /// Position of the mesh origin, in mm.
        origin_mm: [f64; 3],
        /// Rotation, in degrees.
        rpy_deg: [f64; 3],
        /// Length unit of the file, in mm: 1 as in most CAD files, 1000 for m.
        scale: f64,
    },
}

/// Fault of a payload's shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}{message}", number(*.shape))]
pub struct ShapeFault {
    /// Index of the shape; `None` if there are too many shapes.
    pub shape: Option<usize>,
    /// Key of the shape with the wrong value.
    pub key: &'static str,
    /// Message, without the number of the shape.
    pub message: String,
}

impl From<Load> for FlangeLoad {
    fn from(load: Load) -> Self {
        Self { load, shapes: Vec::new() }
    }
}

fn number(shape: Option<usize>) -> String {
    shape.map(|index| format!("shape {} of the load: ", index + 1)).unwrap_or_default()
}

/// Largest coordinate and size, in mm: no workcell is a kilometre long.
const MAX_MM: f64 = 1e6;

/// Smallest size, in mm: a shorter edge is a typing error.
const MIN_SIZE_MM: f64 = 1e-3;

/// Range of the scale, from nm to km.
const SCALES: [f64; 2] = [1e-6, 1e6];

impl FlangeLoad {
    /// Returns the first fault of the shapes.
    #[must_use]
    pub fn shape_fault(&self) -> Option<ShapeFault> {
        let found = self.shapes.len();
        if found > MAX_SHAPES {
            let message = format!("a load may have {MAX_SHAPES} shapes, but it has {found}");
            return Some(ShapeFault { shape: None, key: "shapes", message });
        }
        self.shapes.iter().enumerate().find_map(|(index, shape)| {
            let (key, message) = shape.fault()?;
            Some(ShapeFault { shape: Some(index), key, message })
        })
    }
}

impl LoadShape {
    /// Name of the type in programs.
    #[must_use]
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Box { .. } => "box",
            Self::Cylinder { .. } => "cylinder",
            Self::Sphere { .. } => "sphere",
            Self::Mesh { .. } => "mesh",
        }
    }

    /// Returns the key of a value that is out of range, and a message.
    fn fault(&self) -> Option<(&'static str, String)> {
        let within = |key: &'static str, values: &[f64], [min, max]: [f64; 2]| {
            let axis = values.iter().position(|value| !(min..=max).contains(value))?;
            let name = match values.len() {
                1 => key.to_owned(),
                _ => format!("number {} of {key}", axis + 1),
            };
            Some((key, format!("{name} is {}; it must be from {min} to {max}", values[axis])))
        };
        let place = |key, values: &[f64; 3]| within(key, values, [-MAX_MM, MAX_MM]);
        let size = |key, values: &[f64]| within(key, values, [MIN_SIZE_MM, MAX_MM]);
        let turn = |values: &[f64; 3]| within("rpy_deg", values, [-360.0, 360.0]);
        match self {
            Self::Box { center_mm, size_mm, rpy_deg } => place("center_mm", center_mm)
                .or_else(|| size("size_mm", size_mm))
                .or_else(|| turn(rpy_deg)),
            Self::Cylinder { center_mm, radius_mm, length_mm, rpy_deg } => {
                place("center_mm", center_mm)
                    .or_else(|| size("radius_mm", &[*radius_mm]))
                    .or_else(|| size("length_mm", &[*length_mm]))
                    .or_else(|| turn(rpy_deg))
            }
            Self::Sphere { center_mm, radius_mm } => {
                place("center_mm", center_mm).or_else(|| size("radius_mm", &[*radius_mm]))
            }
            Self::Mesh { file, origin_mm, rpy_deg, scale } => Self::mesh_format(file)
                .is_none()
                .then(|| ("file", "a mesh is a file *.stl or *.obj".to_owned()))
                .or_else(|| place("origin_mm", origin_mm))
                .or_else(|| turn(rpy_deg))
                .or_else(|| within("scale", &[*scale], SCALES)),
        }
    }

    /// Returns the format of a mesh file, `stl` or `obj`, by its extension or its media type.
    #[must_use]
    pub fn mesh_format(file: &str) -> Option<&'static str> {
        if let Some((format, _)) = Self::data_uri(file) {
            return Some(format);
        }
        let (_, ending) = file.rsplit_once('.')?;
        ["stl", "obj"].into_iter().find(|known| ending.eq_ignore_ascii_case(known))
    }

    /// Splits a data URI of a mesh, `data:model/stl;base64,...` or `data:model/obj;base64,...`,
    /// into its format and its base64 text; `None` for a file name.
    #[must_use]
    pub fn data_uri(file: &str) -> Option<(&'static str, &str)> {
        ["stl", "obj"].into_iter().find_map(|format| {
            let rest = file.strip_prefix("data:model/")?.strip_prefix(format)?;
            Some((format, rest.strip_prefix(";base64,")?))
        })
    }
}
