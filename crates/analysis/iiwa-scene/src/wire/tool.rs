//! JSON form of the tool of a scene.

use iiwa_json::{JsonObject, JsonStep, are_known, locate, tag, unknown};
use schemars::JsonSchema;
use serde::Deserialize;

use super::{
    error::{SceneError, json_error},
    mesh::{MAX_SCALE, MIN_SCALE, NamedMesh, ReadFile, one},
    numbers::{angle, from_mm, position, size, three},
};
use crate::{hull::ConvexHull, tool::ToolShape};

/// A shape of the tool, in the frame of the flange: z out of the flange.
#[derive(JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "ToolShape")]
#[expect(dead_code, reason = "the schema is made of it; each kind is read by itself")]
pub(super) enum ToolShapeWire {
    Box(ToolBoxWire),
    Cylinder(ToolCylinderWire),
    Sphere(ToolSphereWire),
    Mesh(ToolMeshWire),
}

/// Declares a type of shapes.
macro_rules! shape_wire {
    (
        $(#[$meta:meta])* $name:ident, $tag:ident = $type:literal
        { $($(#[$field_meta:meta])* $field:ident: $field_type:ty,)* }
    ) => {
        #[derive(Deserialize, JsonSchema)]
        #[schemars(inline)]
        pub(super) enum $tag {
            #[serde(rename = $type)]
            Type,
        }

        #[derive(Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        $(#[$meta])*
        pub(super) struct $name {
            #[expect(dead_code, reason = "it has been looked at")]
            r#type: $tag,
            /// Centre: x, y and z in mm.
            #[serde(deserialize_with = "three")]
            #[schemars(extend("items" = position()))]
            center_mm: [f64; 3],
            $($(#[$field_meta])* $field: $field_type,)*
        }
    };
}

shape_wire! {
    /// A solid box.
    #[schemars(rename = "ToolBox")]
    ToolBoxWire, ToolBoxTag = "box" {
        /// Edge lengths along the box's own axes, in mm.
        #[serde(deserialize_with = "three")]
        #[schemars(extend("items" = size()))]
        size_mm: [f64; 3],
        /// Rotation about the x, then y, then z axis of the flange, in degrees.
        #[serde(default, deserialize_with = "three")]
        #[schemars(extend("items" = angle()))]
        rpy_deg: [f64; 3],
    }
}

shape_wire! {
    /// A cylinder along its own z axis.
    #[schemars(rename = "ToolCylinder")]
    ToolCylinderWire, ToolCylinderTag = "cylinder" {
        /// Radius, in mm.
        #[schemars(with = "serde_json::Value", extend("type" = "number", "minimum" = 1e-3))]
        radius_mm: f64,
        /// Length, in mm.
        #[schemars(with = "serde_json::Value", extend("type" = "number", "minimum" = 1e-3))]
        length_mm: f64,
        /// Rotation about the x, then y, then z axis of the flange, in degrees.
        #[serde(default, deserialize_with = "three")]
        #[schemars(extend("items" = angle()))]
        rpy_deg: [f64; 3],
    }
}

shape_wire! {
    /// A sphere.
    #[schemars(rename = "ToolSphere")]
    ToolSphereWire, ToolSphereTag = "sphere" {
        /// Radius, in mm.
        #[schemars(with = "serde_json::Value", extend("type" = "number", "minimum" = 1e-3))]
        radius_mm: f64,
    }
}

#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
pub(super) enum ToolMeshTag {
    #[serde(rename = "mesh")]
    Type,
}

/// The convex hull of a mesh.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "ToolMesh")]
pub(super) struct ToolMeshWire {
    #[expect(dead_code, reason = "it has been looked at")]
    r#type: ToolMeshTag,
    /// Mesh file: *.stl (binary or ASCII) or *.obj, beside the scene or in a folder below it.
    #[schemars(regex(pattern = r"\.([sS][tT][lL]|[oO][bB][jJ])$"))]
    file: String,
    /// Position of the mesh's origin: x, y and z in mm.
    #[serde(default, deserialize_with = "three")]
    #[schemars(extend("items" = position()))]
    origin_mm: [f64; 3],
    /// Rotation about the x, then y, then z axis of the flange, in degrees.
    #[serde(default, deserialize_with = "three")]
    #[schemars(extend("items" = angle()))]
    rpy_deg: [f64; 3],
    /// Length unit of the file, in mm: 1 as in most CAD files, 1000 if the file is in m.
    #[serde(default = "one")]
    #[schemars(extend("minimum" = MIN_SCALE, "maximum" = MAX_SCALE))]
    scale: f64,
}

impl From<ToolBoxWire> for ToolShape {
    fn from(wire: ToolBoxWire) -> Self {
        Self::Box {
            center_m: wire.center_mm.map(from_mm),
            size_m: wire.size_mm.map(from_mm),
            rpy_rad: wire.rpy_deg.map(f64::to_radians),
        }
    }
}

impl From<ToolCylinderWire> for ToolShape {
    fn from(wire: ToolCylinderWire) -> Self {
        Self::Cylinder {
            center_m: wire.center_mm.map(from_mm),
            radius_m: from_mm(wire.radius_mm),
            length_m: from_mm(wire.length_mm),
            rpy_rad: wire.rpy_deg.map(f64::to_radians),
        }
    }
}

impl From<ToolSphereWire> for ToolShape {
    fn from(wire: ToolSphereWire) -> Self {
        Self::Sphere { center_m: wire.center_mm.map(from_mm), radius_m: from_mm(wire.radius_mm) }
    }
}

/// Reads the shape at `index` from its text `raw`.
pub(super) fn tool_shape(
    text: &str,
    index: usize,
    raw: &str,
    read: ReadFile<'_>,
) -> Result<ToolShape, SceneError> {
    const KNOWN_TYPES: [&str; 4] = ["box", "cylinder", "sphere", "mesh"];
    let prefixed = |error| match error {
        SceneError::Json { message, place, .. } => {
            let message = format!("tool, shape {}: {message}", index + 1);
            SceneError::Json { message, obstacle: None, place }
        }
        other => other,
    };
    let fail = |error: serde_json::Error| prefixed(json_error(text, raw, None, &error));
    let wrong = |message: String, key: Option<&str>| {
        let path = [JsonStep::Key("tool"), JsonStep::Index(index)];
        let path = path.into_iter().chain(key.map(JsonStep::Key)).collect::<Vec<_>>();
        prefixed(SceneError::Json { message, obstacle: None, place: locate(text, &path) })
    };
    let shape = match tag(raw).map_err(fail)?.as_deref() {
        Some("box") => serde_json::from_str::<JsonObject<ToolBoxWire>>(raw).map_err(fail)?.0.into(),
        Some("cylinder") => {
            serde_json::from_str::<JsonObject<ToolCylinderWire>>(raw).map_err(fail)?.0.into()
        }
        Some("sphere") => {
            serde_json::from_str::<JsonObject<ToolSphereWire>>(raw).map_err(fail)?.0.into()
        }
        Some("mesh") => {
            let wire = serde_json::from_str::<JsonObject<ToolMeshWire>>(raw).map_err(fail)?.0;
            mesh(&wire, read).map_err(|(key, message)| wrong(message, Some(key)))?
        }
        Some(other) => {
            return Err(wrong(unknown("type", other, &KNOWN_TYPES), Some("type")));
        }
        None => return Err(wrong(format!("it has no `type`; {}", are_known(&KNOWN_TYPES)), None)),
    };
    Ok(shape)
}

/// Reads the mesh of a shape; the error contains the key that it belongs to.
fn mesh(wire: &ToolMeshWire, read: ReadFile<'_>) -> Result<ToolShape, (&'static str, String)> {
    let named = NamedMesh { file: &wire.file, scale: wire.scale };
    Ok(ToolShape::Mesh {
        hull: named.read(read, ConvexHull::from_mesh)?,
        origin_m: wire.origin_mm.map(from_mm),
        rpy_rad: wire.rpy_deg.map(f64::to_radians),
    })
}
