//! JSON forms of a scene: the input form, which the JSON Schema describes, and the form for
//! drawings ([`drawn`]).

mod drawn;
mod error;
mod ignored;
mod numbers;
mod tool;

use iiwa_json::{JsonObject, JsonStep, Unread, are_known, locate, read_version, tag, unknown};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::value::RawValue;

use crate::scene::{Form, Obstacle, Scene};

pub use error::SceneError;
use error::{VERSION, json_error};
use ignored::{IgnoredPart, ignored_pair};
use numbers::{angle, from_mm, position, size, three};
use tool::{ToolShapeWire, tool_shape};

impl Scene {
    /// Reads a scene (version 1) whose tool has no mesh; [`from_json_with`](Self::from_json_with)
    /// reads all scenes.
    ///
    /// # Errors
    ///
    /// If the text is not a scene, has invalid obstacles, or refers to a mesh; the error contains
    /// the place in the text.
    pub fn from_json(text: &str) -> Result<Self, SceneError> {
        Self::from_json_with(text, |_| {
            Err("only the text of the scene is at hand, and no other file".to_owned())
        })
    }

    /// Reads a scene (version 1). `read` receives the name of a mesh file and returns its bytes, or
    /// the reason why it cannot be read; it decides which files a scene may refer to.
    ///
    /// ```
    /// use iiwa_scene::Scene;
    ///
    /// let text = r#"{ "version": 1, "obstacles": [], "tool": [{ "type": "mesh", "file": "wedge.obj" }] }"#;
    /// let wedge = "v 0 0 0\nv 60 0 0\nv 0 40 0\nv 0 0 20\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    /// let scene = Scene::from_json_with(text, |name| {
    ///     assert_eq!(name, "wedge.obj");
    ///     Ok(wedge.into())
    /// })?;
    /// assert_eq!(scene.tool().len(), 1);
    /// # Ok::<(), iiwa_scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the text is not a scene, or has invalid obstacles or an invalid tool; the error contains
    /// the place in the text.
    pub fn from_json_with(
        text: &str,
        mut read: impl FnMut(&str) -> Result<Vec<u8>, String>,
    ) -> Result<Self, SceneError> {
        let wire =
            read_version(text, VERSION, |wire: &SceneWire<'_>| wire.version).map_err(|error| {
                match error {
                    Unread::Version { found, place } => SceneError::Version { found, place },
                    Unread::Json(error) => json_error(text, text, None, &error),
                }
            })?;
        let obstacles = wire.obstacles.iter().enumerate();
        let obstacles = obstacles.map(|(index, raw)| obstacle(text, index, raw.get()));
        let obstacles = obstacles.collect::<Result<Vec<_>, _>>()?;
        let tool = wire.tool.iter().enumerate();
        let tool = tool.map(|(index, raw)| tool_shape(text, index, raw.get(), &mut read));
        let tool = tool.collect::<Result<Vec<_>, _>>()?;
        let ignored = wire.ignore.iter().enumerate();
        let ignored = ignored.map(|(index, raw)| ignored_pair(text, index, raw.get(), &obstacles));
        let ignored = ignored.collect::<Result<Vec<_>, _>>()?;
        Self::new(obstacles)
            .and_then(|scene| scene.with_tool(tool)?.with_ignored(ignored))
            .map_err(|fault| SceneError::Fault { place: fault.place_in(text), fault })
    }

    /// Returns the JSON Schema of a scene (draft 2020-12).
    #[must_use]
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(SceneWire<'_>).to_value()
    }
}

fn obstacle(text: &str, index: usize, raw: &str) -> Result<Obstacle, SceneError> {
    let fail = |error: serde_json::Error| json_error(text, raw, Some(index), &error);
    let wrong = |message: String, key: Option<&str>| {
        let path = [JsonStep::Key("obstacles"), JsonStep::Index(index)];
        let path = path.into_iter().chain(key.map(JsonStep::Key)).collect::<Vec<_>>();
        SceneError::Json { message, obstacle: Some(index), place: locate(text, &path) }
    };
    match tag(raw).map_err(fail)?.as_deref() {
        Some("box") => {
            serde_json::from_str::<JsonObject<BoxWire>>(raw).map_err(fail).map(|wire| wire.0.into())
        }
        Some("plane") => serde_json::from_str::<JsonObject<PlaneWire>>(raw)
            .map_err(fail)
            .map(|wire| wire.0.into()),
        Some(other) => Err(wrong(unknown("type", other, &KNOWN_TYPES), Some("type"))),
        None => Err(wrong(format!("it has no `type`; {}", are_known(&KNOWN_TYPES)), None)),
    }
}

/// Types of obstacles.
const KNOWN_TYPES: [&str; 2] = ["box", "plane"];

/// Obstacles around a KUKA LBR iiwa, in its base frame: z up, origin at the centre of its foot.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "iiwasim scene", rename = "Scene")]
struct SceneWire<'a> {
    /// Path or address of the JSON Schema of this format, for editors; nothing else uses it.
    #[serde(default, rename = "$schema")]
    #[expect(dead_code, reason = "it is for editors")]
    schema: Option<String>,
    /// Version of this format.
    #[schemars(extend("const" = 1))]
    version: u64,
    /// Obstacles that the arm must not touch.
    #[serde(borrow)]
    #[schemars(with = "Vec<ObstacleWire>", length(max = 10_000))]
    obstacles: Vec<&'a RawValue>,
    /// Shapes of the tool on the flange, in the frame of the flange: z out of the flange.
    #[serde(default, borrow)]
    #[schemars(with = "Vec<ToolShapeWire>", length(max = 100))]
    tool: Vec<&'a RawValue>,
    /// Pairs whose distance is ignored: a part of the arm and the name of an obstacle.
    #[serde(default, borrow)]
    #[schemars(with = "Vec<(IgnoredPart, String)>", length(max = 10_000))]
    ignore: Vec<&'a RawValue>,
}

/// An obstacle.
#[derive(JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "Obstacle")]
#[expect(dead_code, reason = "the schema is made of it; each kind is read by itself")]
enum ObstacleWire {
    Box(BoxWire),
    Plane(PlaneWire),
}

#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
enum BoxTag {
    #[serde(rename = "box")]
    Box,
}

#[derive(Deserialize, JsonSchema)]
#[schemars(inline)]
enum PlaneTag {
    #[serde(rename = "plane")]
    Plane,
}

/// A solid box.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Box")]
struct BoxWire {
    /// Name of the obstacle, unique in the scene.
    #[schemars(length(min = 1, max = 100))]
    name: String,
    #[expect(dead_code, reason = "it has been looked at")]
    r#type: BoxTag,
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

/// A half-space: everything behind the plane is solid.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Plane")]
struct PlaneWire {
    /// Name of the obstacle, unique in the scene.
    #[schemars(length(min = 1, max = 100))]
    name: String,
    #[expect(dead_code, reason = "it has been looked at")]
    r#type: PlaneTag,
    /// A point of the plane: x, y and z in mm.
    #[serde(deserialize_with = "three")]
    #[schemars(extend("items" = position()))]
    point_mm: [f64; 3],
    /// Vector out of the solid side, of any length above zero.
    #[serde(deserialize_with = "three")]
    #[schemars(extend("contains" = { "not": { "const": 0 } }))]
    normal: [f64; 3],
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
