//! JSON form of payloads and their shapes.

use iiwa_json::{JsonObject, are_known, numbers};
use iiwa_kin::Load;
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::json;

use super::{by_name::word, exact::exact_deg};
use crate::flange_load::{FlangeLoad, LoadShape, MAX_SHAPES, ShapeFault};

/// A payload at the flange.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Load")]
pub(super) struct LoadWire {
    /// Mass, in kg.
    #[schemars(range(min = 0, max = Load::MAX_MASS_KG))]
    mass_kg: f64,
    /// Centre of mass in the flange frame, in mm.
    #[serde(default, deserialize_with = "three")]
    center_mm: [f64; 3],
    /// Principal moments of inertia about the centre of mass, in kg m^2.
    #[serde(default, deserialize_with = "three")]
    inertia_kg_m2: [f64; 3],
    /// Orientation of the principal axes in the flange frame, in degrees.
    #[serde(default, deserialize_with = "three", skip_serializing_if = "is_zero")]
    abc_deg: [f64; 3],
    /// Shapes for clearances, in the flange frame.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(with = "Vec<ShapeWire>", length(max = MAX_SHAPES))]
    shapes: Vec<JsonObject<ShapeWire>>,
}

/// Types of shapes.
#[derive(Clone, Copy, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "ShapeType")]
enum ShapeType {
    /// A solid box.
    Box,
    /// A cylinder along its own z axis.
    Cylinder,
    /// A sphere.
    Sphere,
    /// The convex hull of a mesh.
    Mesh,
}

fn position() -> serde_json::Value {
    json!({ "type": "number", "minimum": -1e6, "maximum": 1e6 })
}

fn size() -> serde_json::Value {
    json!({ "type": "number", "minimum": 1e-3, "maximum": 1e6 })
}

fn angle() -> serde_json::Value {
    json!({ "type": "number", "minimum": -360, "maximum": 360 })
}

/// A shape of a payload, in the flange frame: z out of the flange. Its keys are those of tool
/// shapes in scenes.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(
    rename = "Shape",
    extend("oneOf" = [
        { "properties": { "type": { "const": "box" }, "radius_mm": false, "length_mm": false,
          "file": false, "origin_mm": false, "scale": false },
          "required": ["center_mm", "size_mm"] },
        { "properties": { "type": { "const": "cylinder" }, "size_mm": false, "file": false,
          "origin_mm": false, "scale": false },
          "required": ["center_mm", "radius_mm", "length_mm"] },
        { "properties": { "type": { "const": "sphere" }, "size_mm": false, "length_mm": false,
          "rpy_deg": false, "file": false, "origin_mm": false, "scale": false },
          "required": ["center_mm", "radius_mm"] },
        { "properties": { "type": { "const": "mesh" }, "center_mm": false, "size_mm": false,
          "radius_mm": false, "length_mm": false }, "required": ["file"] }
    ])
)]
struct ShapeWire {
    #[serde(deserialize_with = "word")]
    r#type: ShapeType,
    /// Centre of a box, a cylinder or a sphere: x, y and z in mm.
    #[serde(default, deserialize_with = "some_three", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 3]", extend("items" = position()))]
    center_mm: Option<[f64; 3]>,
    /// Edge lengths along the box's own axes, in mm.
    #[serde(default, deserialize_with = "some_three", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 3]", extend("items" = size()))]
    size_mm: Option<[f64; 3]>,
    /// Radius of a cylinder or a sphere, in mm.
    #[serde(default, deserialize_with = "some", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", range(min = 1e-3, max = 1e6))]
    radius_mm: Option<f64>,
    /// Length of a cylinder, in mm.
    #[serde(default, deserialize_with = "some", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", range(min = 1e-3, max = 1e6))]
    length_mm: Option<f64>,
    /// Mesh file: *.stl (binary or ASCII) or *.obj, in the program's folder or in a folder below
    /// it; or its contents, as `data:model/stl;base64,...`.
    #[serde(default, deserialize_with = "some", skip_serializing_if = "Option::is_none")]
    #[schemars(
        with = "String",
        regex(pattern = r"\.([sS][tT][lL]|[oO][bB][jJ])$|^data:model/(stl|obj);base64,")
    )]
    file: Option<String>,
    /// Position of the mesh's origin: x, y and z in mm.
    #[serde(default, deserialize_with = "some_three", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 3]", extend("items" = position()))]
    origin_mm: Option<[f64; 3]>,
    /// Rotation about the x, then y, then z axis of the flange, in degrees.
    #[serde(default, deserialize_with = "some_three", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "[f64; 3]", extend("items" = angle()))]
    rpy_deg: Option<[f64; 3]>,
    /// Length unit of the mesh file, in mm: 1 as in most CAD files, 1000 if the file is in m.
    #[serde(default, deserialize_with = "some", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "f64", range(min = 1e-6, max = 1e6))]
    scale: Option<f64>,
}

fn three<'de, D: Deserializer<'de>>(reader: D) -> Result<[f64; 3], D::Error> {
    numbers(reader, "three numbers")
}

fn some_three<'de, D: Deserializer<'de>>(reader: D) -> Result<Option<[f64; 3]>, D::Error> {
    numbers(reader, "three numbers, for x, y and z").map(Some)
}

/// Reads the value of a key that is present; null is an error.
fn some<'de, D: Deserializer<'de>, T: Deserialize<'de>>(reader: D) -> Result<Option<T>, D::Error> {
    T::deserialize(reader).map(Some)
}

fn is_zero(numbers: &[f64; 3]) -> bool {
    *numbers == [0.0; 3]
}

impl LoadWire {
    /// Returns the payload; the error names a shape.
    pub(super) fn payload(self) -> Result<FlangeLoad, ShapeFault> {
        let load = Load {
            mass_kg: self.mass_kg,
            center_mm: self.center_mm,
            inertia_kg_m2: self.inertia_kg_m2,
            abc_rad: self.abc_deg.map(f64::to_radians),
        };
        let shapes = self.shapes.into_iter().enumerate().map(|(index, JsonObject(shape))| {
            shape.shape().map_err(|(key, message)| ShapeFault { shape: Some(index), key, message })
        });
        let payload = FlangeLoad { load, shapes: shapes.collect::<Result<_, _>>()? };
        payload.shape_fault().map_or(Ok(payload), Err)
    }
}

impl From<&FlangeLoad> for LoadWire {
    fn from(FlangeLoad { load, shapes }: &FlangeLoad) -> Self {
        Self {
            mass_kg: load.mass_kg,
            center_mm: load.center_mm,
            inertia_kg_m2: load.inertia_kg_m2,
            abc_deg: load.abc_rad.map(exact_deg),
            shapes: shapes.iter().map(|shape| JsonObject(shape.into())).collect(),
        }
    }
}

impl ShapeWire {
    fn new(r#type: ShapeType) -> Self {
        Self {
            r#type,
            center_mm: None,
            size_mm: None,
            radius_mm: None,
            length_mm: None,
            file: None,
            origin_mm: None,
            rpy_deg: None,
            scale: None,
        }
    }

    /// Returns the shape; the error names the key.
    fn shape(self) -> Result<LoadShape, (&'static str, String)> {
        let (name, keys): (_, &[&str]) = match self.r#type {
            ShapeType::Box => ("box", &["center_mm", "size_mm", "rpy_deg"]),
            ShapeType::Cylinder => {
                ("cylinder", &["center_mm", "radius_mm", "length_mm", "rpy_deg"])
            }
            ShapeType::Sphere => ("sphere", &["center_mm", "radius_mm"]),
            ShapeType::Mesh => ("mesh", &["file", "origin_mm", "rpy_deg", "scale"]),
        };
        let given = [
            ("center_mm", self.center_mm.is_some()),
            ("size_mm", self.size_mm.is_some()),
            ("radius_mm", self.radius_mm.is_some()),
            ("length_mm", self.length_mm.is_some()),
            ("file", self.file.is_some()),
            ("origin_mm", self.origin_mm.is_some()),
            ("rpy_deg", self.rpy_deg.is_some()),
            ("scale", self.scale.is_some()),
        ];
        let wrong = given.into_iter().find(|(key, is_given)| *is_given && !keys.contains(key));
        if let Some((key, _)) = wrong {
            return Err((key, format!("`{key}` is not a key of a {name}; {}", are_known(keys))));
        }
        let missing =
            |key: &'static str| move || ("type", format!("the key `{key}` of a {name} is missing"));
        let center = self.center_mm.ok_or_else(missing("center_mm"));
        let rpy_deg = self.rpy_deg.unwrap_or_default();
        Ok(match self.r#type {
            ShapeType::Box => LoadShape::Box {
                center_mm: center?,
                size_mm: self.size_mm.ok_or_else(missing("size_mm"))?,
                rpy_deg,
            },
            ShapeType::Cylinder => LoadShape::Cylinder {
                center_mm: center?,
                radius_mm: self.radius_mm.ok_or_else(missing("radius_mm"))?,
                length_mm: self.length_mm.ok_or_else(missing("length_mm"))?,
                rpy_deg,
            },
            ShapeType::Sphere => LoadShape::Sphere {
                center_mm: center?,
                radius_mm: self.radius_mm.ok_or_else(missing("radius_mm"))?,
            },
            ShapeType::Mesh => LoadShape::Mesh {
                file: self.file.ok_or_else(missing("file"))?.into(),
                origin_mm: self.origin_mm.unwrap_or_default(),
                rpy_deg,
                scale: self.scale.unwrap_or(1.0),
            },
        })
    }
}

impl From<&LoadShape> for ShapeWire {
    fn from(shape: &LoadShape) -> Self {
        let turn = |rpy_deg: &[f64; 3]| (!is_zero(rpy_deg)).then_some(*rpy_deg);
        match shape {
            LoadShape::Box { center_mm, size_mm, rpy_deg } => Self {
                center_mm: Some(*center_mm),
                size_mm: Some(*size_mm),
                rpy_deg: turn(rpy_deg),
                ..Self::new(ShapeType::Box)
            },
            LoadShape::Cylinder { center_mm, radius_mm, length_mm, rpy_deg } => Self {
                center_mm: Some(*center_mm),
                radius_mm: Some(*radius_mm),
                length_mm: Some(*length_mm),
                rpy_deg: turn(rpy_deg),
                ..Self::new(ShapeType::Cylinder)
            },
            LoadShape::Sphere { center_mm, radius_mm } => Self {
                center_mm: Some(*center_mm),
                radius_mm: Some(*radius_mm),
                ..Self::new(ShapeType::Sphere)
            },
            LoadShape::Mesh { file, origin_mm, rpy_deg, scale } => Self {
                file: Some(file.as_ref().to_owned()),
                origin_mm: (!is_zero(origin_mm)).then_some(*origin_mm),
                rpy_deg: turn(rpy_deg),
                scale: (*scale != 1.0).then_some(*scale),
                ..Self::new(ShapeType::Mesh)
            },
        }
    }
}
