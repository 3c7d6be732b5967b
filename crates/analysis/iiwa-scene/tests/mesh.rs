//! Meshes of a tool: formats, clearances, and places of faults.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fmt::Write as _;

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_scene::{ArmInScene, ConvexHull, Scene, ToolShape};
use iiwa_traj::{Timing, Trajectory};
use iiwasim_tests::fixture;

use crate::documents::{GOOD_MESH, WRONG_MESHES, with_tool};

/// Returns a box about the origin by its full lengths: its corners, and two triangles for each
/// side.
fn cuboid(size: [f32; 3]) -> ([[f32; 3]; 8], [[usize; 3]; 12]) {
    let corner = |i: usize| {
        let side = |axis: usize| if i >> axis & 1 == 0 { -0.5 } else { 0.5 };
        std::array::from_fn(|axis| side(axis) * size[axis])
    };
    let triangles = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    (std::array::from_fn(corner), triangles)
}

const SIZE: [f32; 3] = [80.0, 30.0, 44.0];

pub(crate) fn binary_stl() -> Vec<u8> {
    let (corners, triangles) = cuboid(SIZE);
    let mut file = [0; 80].to_vec();
    file.extend(u32::try_from(triangles.len()).unwrap().to_le_bytes());
    for triangle in triangles {
        file.extend([0; 12]);
        for value in triangle.iter().flat_map(|corner| corners[*corner]) {
            file.extend(value.to_le_bytes());
        }
        file.extend([0; 2]);
    }
    file
}

pub(crate) fn ascii_stl() -> Vec<u8> {
    let (corners, triangles) = cuboid(SIZE);
    let mut file = "solid gripper\n".to_owned();
    for triangle in triangles {
        file += "facet normal 0 0 0\nouter loop\n";
        for [x, y, z] in triangle.map(|corner| corners[corner]) {
            writeln!(file, "vertex {x} {y:e} {z}").unwrap();
        }
        file += "endloop\nendfacet\n";
    }
    (file + "endsolid gripper\n").into()
}

/// Creates an OBJ file in m, with a material that does not exist.
fn obj() -> Vec<u8> {
    let (corners, triangles) = cuboid(SIZE);
    let mut file = "mtllib none.mtl\n".to_owned();
    for [x, y, z] in corners {
        writeln!(file, "v {} {} {}", x / 1e3, y / 1e3, z / 1e3).unwrap();
    }
    for [a, b, c] in triangles {
        writeln!(file, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    file.into()
}

fn scene(tool: &str, read: impl FnMut(&str) -> Result<Vec<u8>, String>) -> Scene {
    let text = format!(
        r#"{{ "version": 1,
             "obstacles": [
               {{ "name": "floor", "type": "plane", "point_mm": [0, 0, -50], "normal": [0, 0, 1] }},
               {{ "name": "post", "type": "box", "center_mm": [500, 300, 300],
                  "size_mm": [60, 70, 500], "rpy_deg": [5, 0, 20] }}
             ],
             "tool": [{tool}] }}"#
    );
    Scene::from_json_with(&text, read).unwrap()
}

/// A box, as a box and as a mesh in three formats, has the same clearance at each pose and in a
/// plan.
#[test]
fn a_box_is_as_near_as_its_mesh() {
    let place = r#""rpy_deg": [10, 20, 30]"#;
    let as_box = scene(
        &format!(
            r#"{{ "type": "box", "center_mm": [10, -5, 60], "size_mm": [80, 30, 44], {place} }}"#
        ),
        |_| Err("no file".to_owned()),
    );
    let mesh = |file: &str, more: &str, bytes: Vec<u8>| {
        let shape = format!(
            r#"{{ "type": "mesh", "file": "{file}", "origin_mm": [10, -5, 60], {place}{more} }}"#
        );
        scene(&shape, |name| {
            assert_eq!(name, file);
            Ok(bytes.clone())
        })
    };
    let meshes = [
        mesh("gripper.stl", "", binary_stl()),
        mesh("gripper.STL", "", ascii_stl()),
        mesh("gripper.obj", r#", "scale": 1000"#, obj()),
    ];
    assert_eq!(meshes[0].tool(), meshes[1].tool());
    let robot = Robot::default();
    let arms = meshes.each_ref().map(|scene| ArmInScene::new(&robot, scene));
    let box_arm = ArmInScene::new(&robot, &as_box);
    let mut random = fastrand::Rng::with_seed(6);
    let mut by_tool = 0;
    for _ in 0..2000 {
        let q = robot.limits().at_shares(&[(); 7].map(|()| 1.8 * random.f64() - 0.9));
        let expected = box_arm.clearance(&q).unwrap();
        by_tool += u32::from(expected.link == 8);
        // A file has numbers with six digits.
        for (arm, error) in arms.iter().zip([1e-9, 1e-9, 1e-8]) {
            let actual = arm.clearance(&q).unwrap();
            assert!(
                (actual.distance_m - expected.distance_m).abs() < error,
                "{expected:?} {actual:?}"
            );
        }
    }
    assert!(by_tool > 100, "{by_tool}");

    let program = std::fs::read_to_string(fixture("pick-and-place.json")).unwrap();
    let path = JointPath::new(&Program::from_json(&program).unwrap(), &robot).unwrap();
    let trajectory = Trajectory::plan(&path, Timing::default()).unwrap();
    let expected = box_arm.clearance_of(&trajectory).unwrap().clearance.distance_m;
    assert!(expected > 0.0);
    for arm in &arms {
        let actual = arm.clearance_of(&trajectory).unwrap().clearance.distance_m;
        // The bounds of a box and of a hull exclude different spans: both results are within 0.1
        // mm.
        assert!((actual - expected).abs() < 1e-4, "{actual} {expected}");
        let sampled =
            trajectory.samples(300.0).map(|state| arm.clearance(&state.q).unwrap().distance_m);
        let min_m = sampled.fold(f64::MAX, f64::min);
        assert!(actual <= min_m + 1e-9 && actual > min_m - 1e-3, "{actual} {min_m}");
    }
}

/// During a motion between two poses, no clearance differs from that at an end by more than the
/// travel bound.
#[test]
fn travel_bounds_clearances() {
    let tool = r#"{ "type": "mesh", "file": "a.stl", "origin_mm": [0, 40, 90], "scale": 3 }"#;
    let scene = scene(tool, |_| Ok(binary_stl()));
    let robot = Robot::default();
    let arm = ArmInScene::new(&robot, &scene);
    let mut random = fastrand::Rng::with_seed(9);
    let mut tightest = f64::MAX;
    for _ in 0..2000 {
        let from = robot.limits().at_shares(&[(); 7].map(|()| 1.6 * random.f64() - 0.8));
        let to = from.map(|q| q + 0.05 * (random.f64() - 0.5));
        let bound_m = arm.travel_bound_m(&from, &to);
        let middle = std::array::from_fn(|j| from[j] + 0.3 * (to[j] - from[j]));
        let [a, b] = [from, middle].map(|q| arm.clearance(&q).unwrap().distance_m);
        assert!((a - b).abs() <= 0.3 * bound_m + 1e-7, "{a} {b} {bound_m}");
        tightest = tightest.min(bound_m - (a - b).abs() / 0.3);
    }
    // The bound is useful: some poses come close to it.
    assert!(tightest < 0.02, "{tightest}");
}

#[test]
fn invalid_meshes_are_refused_at_their_key() {
    let refused = |shape: &str, bytes: Result<Vec<u8>, &str>| {
        let text = format!("{{\n\"version\": 1, \"obstacles\": [],\n\"tool\": [\n{shape}] }}");
        let error =
            Scene::from_json_with(&text, |_| bytes.clone().map_err(str::to_owned)).unwrap_err();
        assert_eq!(error.place().line, 4, "{error}");
        (error.message(), text[error.place().span.clone()].to_owned())
    };
    let stl = r#"{ "type": "mesh", "file": "a.stl" }"#;
    let obj = |text: &str| refused(r#"{ "type": "mesh", "file": "a.obj" }"#, Ok(text.into()));
    let points = |points: &str| obj(&format!("{points}\nf 1 2 3\nf 2 3 4\n"));
    let solid = "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9";
    let mut not_finite = binary_stl();
    not_finite[96..100].copy_from_slice(&f32::NAN.to_le_bytes());
    let whole = binary_stl();
    let cut = whole[..whole.len() - 50].to_vec();
    let cases = [
        (refused(stl, Err("there is no file")), "`a.stl`: there is no file"),
        (refused(stl, Ok(b"hello".to_vec())), "`a.stl`: not a valid STL file"),
        (refused(stl, Ok(b"solid a\nfacet normal 0 0 0\nouter".to_vec())), "not a valid STL file"),
        (refused(stl, Ok(binary_stl()[..100].to_vec())), "not a valid STL file"),
        (refused(stl, Ok(binary_stl()[..84].to_vec())), "has at least 684 bytes, not 84"),
        // Truncated between two triangles, and with a header that looks like text.
        (refused(stl, Ok(cut.clone())), "12 triangles has at least 684 bytes, not 634"),
        (refused(stl, Ok([b"solid", &cut[5..]].concat())), "at least 684 bytes, not 634"),
        (refused(stl, Ok(Vec::new())), "it is empty"),
        (refused(stl, Ok(not_finite)), "a coordinate that is not a number"),
        (obj("v 1 2\n"), "not a valid OBJ file"),
        (obj("v 0 0 0\nv 1 0 0\nf 1 2 3\n"), "not a valid OBJ file"),
        (obj(""), "fewer than four"),
        (points("v 0 0 0\nv 9 0 0\nv 0 9 0\nv 9 9 0"), "all in one plane"),
        (points("v 0 0 0\nv 1e30 0 0\nv 0 9 0\nv 0 9 9"), "more than 2000 mm"),
        (
            points("v 0 0 0\nv 0.09 0 0\nv 0 0.09 0\nv 0 0 0.09"),
            "it is 0.09 mm long, less than 1 mm: one unit of the file was taken as 1 mm",
        ),
        (refused(r#"{ "type": "mesh", "file": "a.dae" }"#, Ok(Vec::new())), "*.stl or *.obj"),
    ];
    for ((message, span), words) in cases {
        assert!(
            message.starts_with("tool, shape 1: `a.") && message.contains(words),
            "{message}: {words}"
        );
        assert!(span.starts_with("\"a."), "{message}: {span}");
    }
    for (keys, words, span) in [
        (r#""scale": 0"#, "scale is 0; it must be from 0.000001 to 1000000", "0"),
        (r#""origin_mm": [0, 1e7, 0]"#, "number 2 of origin_mm is 10000000", "1e7"),
        (r#""rpy_deg": [0, 0, 400]"#, "number 3 of rpy_deg is 400", "400"),
        (r#""center_mm": [0, 0, 0]"#, "unknown key `center_mm`", "\"center_mm\""),
    ] {
        let shape = format!(r#"{{ "type": "mesh", "file": "a.obj", {keys} }}"#);
        let faces = "f 1 2 3\nf 2 3 4\n";
        let (message, place) = refused(&shape, Ok(format!("{solid}\n{faces}").into()));
        assert!(message.contains(words) && place == span, "{message}: {place}");
    }
    let (message, _) = refused(r#"{ "type": "mesh" }"#, Ok(Vec::new()));
    assert!(message.contains("the key `file` is missing"), "{message}");
    let text =
        r#"{ "version": 1, "obstacles": [], "tool": [{ "type": "mesh", "file": "a.stl" }] }"#;
    let error = Scene::from_json(text).unwrap_err();
    assert!(error.message().contains("only the text of the scene is available"), "{error}");
}

#[test]
fn meshes_with_too_many_triangles_are_refused() {
    let triangle = &binary_stl()[84..134];
    let mut file = [0; 80].to_vec();
    file.extend(2_000_001_u32.to_le_bytes());
    file.extend(triangle.repeat(2_000_001));
    let error = ConvexHull::from_mesh("scan.stl", &file, 1.0).unwrap_err().to_string();
    assert_eq!(error, "it has 2000001 triangles; it may have 2000000");
}

#[test]
fn meshes_are_read_from_scenes() {
    let read = |shape: &str| {
        let text = with_tool(shape).to_string();
        Scene::from_json_with(&text, |_| Ok(binary_stl()))
    };
    let good = read(GOOD_MESH).unwrap();
    let ToolShape::Mesh { hull, origin_m, .. } = &good.tool()[0] else { panic!() };
    assert_eq!(*origin_m, [0.0; 3]);
    assert_eq!((hull.corners_m().len(), hull.triangles().len()), (8, 12));
    assert!(hull.corners_m().contains(&[0.1, 0.0375, 0.055]));
    for wrong in WRONG_MESHES {
        assert!(read(wrong).is_err(), "{wrong}");
    }
}
