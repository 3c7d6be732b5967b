//! JSON forms of a scene: the input form, which the JSON Schema describes, and the form for
//! drawings ([`drawn`]).

mod drawn;
mod error;
mod ignored;
mod mesh;
mod numbers;
mod obstacle;
mod tool;

use iiwa_json::{Unread, read_version, without_mark};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::value::RawValue;

use crate::{
    fault::SceneFault,
    scene::{Scene, check_count, check_triangles},
};

pub use error::SceneError;
use error::{VERSION, json_error};
use ignored::{IgnoredPart, ignored_pair};
use obstacle::{ObstacleWire, obstacle};
use tool::{ToolShapeWire, tool_shape};

impl Scene {
    /// Reads a scene (version 1) without meshes; [`from_json_with`](Self::from_json_with)
    /// reads all scenes.
    ///
    /// # Errors
    ///
    /// If the text is not a scene, has invalid obstacles, or refers to a mesh; the error contains
    /// the place in the text.
    pub fn from_json(text: &str) -> Result<Self, SceneError> {
        Self::from_json_with(text, |_| {
            Err("only the text of the scene is available, but no other file".to_owned())
        })
    }

    /// Reads a scene (version 1). `read` receives the name of a mesh file and returns its bytes, or
    /// the reason why it cannot be read; it decides which files a scene may refer to.
    ///
    /// ```
    /// use iiwa_scene::Scene;
    ///
    /// let text = r#"{
    ///     "version": 1,
    ///     "obstacles": [],
    ///     "tool": [{ "type": "mesh", "file": "wedge.obj" }]
    /// }"#;
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
        let text = without_mark(text);
        let wire =
            read_version(text, VERSION, |wire: &SceneWire<'_>| wire.version).map_err(|error| {
                match error {
                    Unread::Version { found, place } => SceneError::Version { found, place },
                    Unread::Json(error) => json_error(text, text, None, &error),
                }
            })?;
        // The numbers are checked before the obstacles, and the triangles after each of them, so
        // that a small file cannot make this read more than a scene may have.
        let fault = |fault: SceneFault| SceneError::Fault { place: fault.place_in(text), fault };
        check_count(wire.obstacles.len()).map_err(fault)?;
        let mut triangles = 0;
        let obstacles = wire.obstacles.iter().enumerate().map(|(index, raw)| {
            let obstacle = obstacle(text, index, raw.get(), &mut read)?;
            triangles += obstacle.triangles();
            check_triangles(triangles).map_err(fault)?;
            Ok(obstacle)
        });
        let obstacles = obstacles.collect::<Result<Vec<_>, SceneError>>()?;
        let tool = wire.tool.iter().enumerate();
        let tool = tool.map(|(index, raw)| tool_shape(text, index, raw.get(), &mut read));
        let tool = tool.collect::<Result<Vec<_>, _>>()?;
        let ignored = wire.ignore.iter().enumerate();
        let ignored = ignored.map(|(index, raw)| ignored_pair(text, index, raw.get(), &obstacles));
        let ignored = ignored.collect::<Result<Vec<_>, _>>()?;
        Self::new(obstacles)
            .and_then(|scene| scene.with_tool(tool)?.with_ignored(ignored))
            .map_err(fault)
    }

    /// Returns the JSON Schema of a scene (draft 2020-12).
    #[must_use]
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(SceneWire<'_>).to_value()
    }
}

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
