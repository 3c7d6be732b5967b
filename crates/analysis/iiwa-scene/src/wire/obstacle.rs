//! JSON form of obstacles.

use iiwa_json::{JsonObject, JsonStep, are_known, locate, tag, unknown};
use schemars::JsonSchema;
use serde::Deserialize;

use super::{
    error::{SceneError, json_error},
    mesh::{MAX_SCALE, MIN_SCALE, NamedMesh, ReadFile, one},
    numbers::{angle, from_mm, position, size, three},
};
use crate::{
    scene::{Form, Obstacle},
    surface::TriangleSurface,
};

/// Types of obstacles.
const KNOWN_TYPES: [&str; 5] = ["box", "plane", "cylinder", "sphere", "mesh"];

/// An obstacle.
#[derive(JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "Obstacle")]
#[expect(dead_code, reason = "the schema is made of it; each kind is read by itself")]
pub(super) enum ObstacleWire {
    Box(BoxWire),
    Plane(PlaneWire),
    Cylinder(CylinderWire),
    Sphere(SphereWire),
    Mesh(MeshWire),
}

/// Declares a type of obstacles.
macro_rules! obstacle_wire {
    (
        $(#[$meta:meta])* $name:ident, $tag:ident = $type:literal
        { $($(#[$field_meta:meta])* $field:ident: $field_type:ty,)* }
    ) => {
        #[derive(Deserialize, JsonSchema)]
        #[schemars(inline)]
        enum $tag {
            #[serde(rename = $type)]
            Type,
        }

        #[derive(Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        $(#[$meta])*
        pub(super) struct $name {
            /// Name of the obstacle, unique in the scene.
            #[schemars(length(min = 1, max = 100))]
            name: String,
            #[expect(dead_code, reason = "it has been looked at")]
            r#type: $tag,
            $($(#[$field_meta])* $field: $field_type,)*
        }
    };
}

obstacle_wire! {
    /// A solid box.
    #[schemars(rename = "Box")]
    BoxWire, BoxTag = "box" {
        /// Centre: x, y and z in mm.
        #[serde(deserialize_with = "three")]
        #[schemars(extend("items" = position()))]
        center_mm: [f64; 3],
        /// Edge lengths along the box's own axes, in mm.
        #[serde(deserialize_with = "three")]
        #[schemars(extend("items" = size()))]
        size_mm: [f64; 3],
        /// Rotation as in a URDF: about the x, then y, then z axis of the base, in degrees.
        #[serde(default, deserialize_with = "three")]
        #[schemars(extend("items" = angle()))]
        rpy_deg: [f64; 3],
    }
}

obstacle_wire! {
    /// A half-space: everything behind the plane is solid.
    #[schemars(rename = "Plane")]
    PlaneWire, PlaneTag = "plane" {
        /// A point of the plane: x, y and z in mm.
        #[serde(deserialize_with = "three")]
        #[schemars(extend("items" = position()))]
        point_mm: [f64; 3],
        /// Vector out of the solid side, of any length above zero.
        #[serde(deserialize_with = "three")]
        #[schemars(extend("contains" = { "not": { "const": 0 } }))]
        normal: [f64; 3],
    }
}

obstacle_wire! {
    /// A solid cylinder along its own z axis.
    #[schemars(rename = "Cylinder")]
    CylinderWire, CylinderTag = "cylinder" {
        /// Centre: x, y and z in mm.
        #[serde(deserialize_with = "three")]
        #[schemars(extend("items" = position()))]
        center_mm: [f64; 3],
        /// Radius, in mm.
        #[schemars(extend("minimum" = 1e-3, "maximum" = 1e6))]
        radius_mm: f64,
        /// Length, in mm.
        #[schemars(extend("minimum" = 1e-3, "maximum" = 1e6))]
        length_mm: f64,
        /// Rotation as in a URDF: about the x, then y, then z axis of the base, in degrees.
        #[serde(default, deserialize_with = "three")]
        #[schemars(extend("items" = angle()))]
        rpy_deg: [f64; 3],
    }
}

obstacle_wire! {
    /// A solid sphere.
    #[schemars(rename = "Sphere")]
    SphereWire, SphereTag = "sphere" {
        /// Centre: x, y and z in mm.
        #[serde(deserialize_with = "three")]
        #[schemars(extend("items" = position()))]
        center_mm: [f64; 3],
        /// Radius, in mm.
        #[schemars(extend("minimum" = 1e-3, "maximum" = 1e6))]
        radius_mm: f64,
    }
}

obstacle_wire! {
    /// The surface of a mesh: triangles without an inside.
    #[schemars(rename = "Mesh")]
    MeshWire, MeshTag = "mesh" {
        /// Mesh file: *.stl (binary or ASCII) or *.obj, beside the scene or in a folder below it.
        #[schemars(regex(pattern = r"\.([sS][tT][lL]|[oO][bB][jJ])$"))]
        file: String,
        /// Position of the mesh's origin: x, y and z in mm.
        #[serde(default, deserialize_with = "three")]
        #[schemars(extend("items" = position()))]
        origin_mm: [f64; 3],
        /// Rotation as in a URDF: about the x, then y, then z axis of the base, in degrees.
        #[serde(default, deserialize_with = "three")]
        #[schemars(extend("items" = angle()))]
        rpy_deg: [f64; 3],
        /// Length unit of the file, in mm: 1 as in most CAD files, 1000 if the file is in m.
        #[serde(default = "one")]
        #[schemars(extend("minimum" = MIN_SCALE, "maximum" = MAX_SCALE))]
        scale: f64,
    }
}

impl From<BoxWire> for Obstacle {
    fn from(wire: BoxWire) -> Self {
        let form = Form::Box {
            center_m: wire.center_mm.map(from_mm),
            size_m: wire.size_mm.map(from_mm),
            rpy_rad: wire.rpy_deg.map(f64::to_radians),
        };
        Self { name: wire.name, form }
    }
}

impl From<PlaneWire> for Obstacle {
    fn from(wire: PlaneWire) -> Self {
        let form = Form::Plane { point_m: wire.point_mm.map(from_mm), normal: wire.normal };
        Self { name: wire.name, form }
    }
}

impl From<CylinderWire> for Obstacle {
    fn from(wire: CylinderWire) -> Self {
        let form = Form::Cylinder {
            center_m: wire.center_mm.map(from_mm),
            radius_m: from_mm(wire.radius_mm),
            length_m: from_mm(wire.length_mm),
            rpy_rad: wire.rpy_deg.map(f64::to_radians),
        };
        Self { name: wire.name, form }
    }
}

impl From<SphereWire> for Obstacle {
    fn from(wire: SphereWire) -> Self {
        let center_m = wire.center_mm.map(from_mm);
        Self { name: wire.name, form: Form::Sphere { center_m, radius_m: from_mm(wire.radius_mm) } }
    }
}

/// Reads an obstacle of one type.
fn object<'a, T: Deserialize<'a> + Into<Obstacle>>(
    raw: &'a str,
) -> Result<Obstacle, serde_json::Error> {
    serde_json::from_str::<JsonObject<T>>(raw).map(|JsonObject(wire)| wire.into())
}

/// Reads the obstacle at `index` from its text `raw`.
pub(super) fn obstacle(
    text: &str,
    index: usize,
    raw: &str,
    read: ReadFile<'_>,
) -> Result<Obstacle, SceneError> {
    let fail = |error: serde_json::Error| json_error(text, raw, Some(index), &error);
    let wrong = |message: String, key: Option<&str>| {
        let path = [JsonStep::Key("obstacles"), JsonStep::Index(index)];
        let path = path.into_iter().chain(key.map(JsonStep::Key)).collect::<Vec<_>>();
        SceneError::Json { message, obstacle: Some(index), place: locate(text, &path) }
    };
    match tag(raw).map_err(fail)?.as_deref() {
        Some("box") => object::<BoxWire>(raw).map_err(fail),
        Some("plane") => object::<PlaneWire>(raw).map_err(fail),
        Some("cylinder") => object::<CylinderWire>(raw).map_err(fail),
        Some("sphere") => object::<SphereWire>(raw).map_err(fail),
        Some("mesh") => {
            let JsonObject(wire) =
                serde_json::from_str::<JsonObject<MeshWire>>(raw).map_err(fail)?;
            let named = NamedMesh { file: &wire.file, scale: wire.scale };
            let surface = named
                .read(read, TriangleSurface::from_mesh)
                .map_err(|(key, message)| wrong(message, Some(key)))?;
            let form = Form::Mesh {
                surface,
                origin_m: wire.origin_mm.map(from_mm),
                rpy_rad: wire.rpy_deg.map(f64::to_radians),
            };
            Ok(Obstacle { name: wire.name, form })
        }
        Some(other) => Err(wrong(unknown("type", other, &KNOWN_TYPES), Some("type"))),
        None => Err(wrong(format!("it has no `type`; {}", are_known(&KNOWN_TYPES)), None)),
    }
}
