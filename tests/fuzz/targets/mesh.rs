//! Meshes: STL, OBJ or Collada, by the first byte; those of tools to a clearance.

#![no_main]

use iiwa_kin::Robot;
use iiwa_scene::{
    ArmInScene, ConvexHull, Form, Obstacle, Patch, Scene, ToolShape, TriangleMesh,
};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|file: &[u8]| {
    let Some((first, bytes)) = file.split_first() else { return };
    let name = if *first == b'2' {
        "a.dae"
    } else if first % 2 == 0 {
        "a.stl"
    } else {
        "a.obj"
    };
    if let Ok(mesh) = TriangleMesh::read(name, bytes, |_| None) {
        let is_whole = |patch: &Patch| {
            patch.triangles.iter().flatten().all(|corner| (*corner as usize) < patch.points.len())
        };
        assert!(mesh.patches.iter().all(is_whole));
    }
    let Ok(hull) = ConvexHull::from_mesh(name, bytes, 1.0) else { return };
    assert_eq!(hull.triangles().len(), 2 * hull.corners_m().len() - 4);
    let form =
        Form::Box { center_m: [0.5, 0.1, 0.6], size_m: [0.2, 0.1, 0.4], rpy_rad: [0.1, 0.2, 0.3] };
    let scene = Scene::new(vec![Obstacle { name: "post".to_owned(), form }]).expect("a good scene");
    let tool = ToolShape::Mesh { hull, origin_m: [0.0; 3], rpy_rad: [0.0; 3] };
    let scene = scene.with_tool(vec![tool]).expect("a good tool");
    let arm = ArmInScene::new(&Robot::lbr_iiwa_7_r800(), &scene);
    let clearance = arm.clearance(&[0.3, 1.2, -0.4, -1.9, 0.8, 1.1, 2.0]).expect("there is a post");
    assert!(clearance.distance_m >= 0.0);
});
