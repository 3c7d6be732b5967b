//! Scenes of obstacles, and meshes of tools.

#[path = "../../../../crates/analysis/iiwa-scene/tests/documents.rs"]
mod documents;

use iiwa_scene::Scene;

use super::{assert_fits, validator};
use documents::{GOOD_MESH, WRONG_MESHES, good_scenes, with_tool, wrong_scenes};

#[test]
fn scenes_agree() {
    let schema = validator(&Scene::schema());
    for scene in good_scenes() {
        assert_fits(&schema, &scene);
    }
    for wrong in wrong_scenes() {
        assert!(!schema.is_valid(&wrong), "{wrong}");
    }
}

#[test]
fn meshes_agree() {
    let schema = validator(&Scene::schema());
    assert_fits(&schema, &with_tool(GOOD_MESH));
    for wrong in WRONG_MESHES {
        assert!(!schema.is_valid(&with_tool(wrong)), "{wrong}");
    }
}
