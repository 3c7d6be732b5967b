//! Pairs of a part of the arm and an obstacle that a scene ignores.

use iiwa_json::{JsonPlace, JsonStep, locate, problem, unknown};
use schemars::JsonSchema;

use super::error::SceneError;
use crate::{
    links::{FIRST_LINK, IgnoredPair, PARTS},
    scene::Obstacle,
};

/// A part of the arm.
#[derive(JsonSchema)]
#[schemars(inline, extend("enum" = PARTS))]
pub(super) struct IgnoredPart(#[expect(dead_code, reason = "the schema is made of it")] String);

/// Reads a pair such as `["link 2", "pedestal"]`; `obstacles` are those of the scene.
pub(super) fn ignored_pair(
    text: &str,
    index: usize,
    raw: &str,
    obstacles: &[Obstacle],
) -> Result<IgnoredPair, SceneError> {
    let wrong = |message: String, place: JsonPlace| SceneError::Json {
        message: format!("ignored pair {}: {message}", index + 1),
        obstacle: None,
        place,
    };
    let place_of = |name: usize| {
        locate(text, &[JsonStep::Key("ignore"), JsonStep::Index(index), JsonStep::Index(name)])
    };
    let [part, obstacle] = serde_json::from_str::<[String; 2]>(raw).map_err(|error| {
        let message = format!("{}; a pair is [\"link 2\", \"NAME\"]", problem(&error));
        wrong(message, locate(text, &[JsonStep::Key("ignore"), JsonStep::Index(index)]))
    })?;
    let link = PARTS
        .iter()
        .position(|name| *name == part)
        .map(|place| FIRST_LINK + place)
        .ok_or_else(|| wrong(unknown("part of the arm", &part, &PARTS), place_of(0)))?;
    let obstacle = obstacles.iter().position(|it| it.name == obstacle).ok_or_else(|| {
        /// Limits the list of names, so that it does not hide the message.
        const SHOWN: usize = 8;
        let names: Vec<&str> = obstacles.iter().map(|it| it.name.as_str()).collect();
        let message = match iiwa_json::meant(&obstacle, names.iter().copied()) {
            None if names.len() > SHOWN => format!(
                "unknown obstacle `{}`; the scene has {} others",
                iiwa_json::excerpt(&obstacle),
                names.len()
            ),
            _ => unknown("obstacle", &obstacle, &names),
        };
        wrong(message, place_of(1))
    })?;
    Ok(IgnoredPair { link, obstacle })
}
