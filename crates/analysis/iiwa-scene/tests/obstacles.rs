//! Cylinders, spheres and meshes as obstacles.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_program::Program;
use iiwa_scene::{
    ArmInScene, Form, Obstacle, Scene, SceneFault, SurfaceError, ToolShape, TriangleSurface,
};
use iiwa_traj::{Timing, Trajectory};

use crate::common::ball;

const ZERO: [f64; 3] = [0.0; 3];

/// Form at a point.
type FormAt = Box<dyn Fn([f64; 3]) -> Form>;

/// Cube with an edge length of 200 units, around the origin, as an OBJ file.
const CUBE: &str = "v -100 -100 -100\nv 100 -100 -100\nv 100 100 -100\nv -100 100 -100\n\
                    v -100 -100 100\nv 100 -100 100\nv 100 100 100\nv -100 100 100\n\
                    f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\n\
                    f 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n";

fn cube() -> TriangleSurface {
    TriangleSurface::from_mesh("cube.obj", CUBE.as_bytes(), 1.0).unwrap()
}

fn scene(form: Form) -> Scene {
    Scene::new(vec![Obstacle { name: "it".to_owned(), form }]).unwrap()
}

/// Returns the distance of an obstacle from a tool that is a sphere of 50 mm around the origin of
/// the flange, with the flange at `flange_m` and the arm stretched out upwards.
fn from_ball(form: impl Fn([f64; 3]) -> Form) -> f64 {
    let robot = Robot::lbr_iiwa_7_r800();
    let ball = ToolShape::Sphere { center_m: [0.0, 0.0, 0.3], radius_m: 0.05 };
    let [x, y, z] = robot.flange_position(&[0.0; 7]);
    let scene = scene(form([x, y, z + 0.3])).with_tool(vec![ball]).unwrap();
    let clearance = ArmInScene::new(&robot, &scene).clearance(&[0.0; 7]).unwrap();
    assert_eq!(clearance.link, 8, "{clearance:?}");
    clearance.distance_m
}

/// Distances of shapes from a sphere of 50 mm, computed by hand.
#[test]
fn distances_from_a_sphere_are_exact() {
    let above = |dx: f64, dz: f64| move |[x, y, z]: [f64; 3]| [x + dx, y, z + dz];
    let turned = [0.0, FRAC_PI_2, 0.0];
    let cylinder =
        |center_m, rpy_rad| Form::Cylinder { center_m, radius_m: 0.1, length_m: 0.4, rpy_rad };
    let mesh = |origin_m, rpy_rad| Form::Mesh { surface: cube(), origin_m, rpy_rad };
    let cases: [(f64, FormAt); 9] = [
        // Centres 0.5 m apart along the diagonal of 0.3 and 0.4, radii of 0.05 and 0.1.
        (0.35, Box::new(move |c| Form::Sphere { center_m: above(0.3, 0.4)(c), radius_m: 0.1 })),
        (0.0, Box::new(move |c| Form::Sphere { center_m: above(0.0, 0.14)(c), radius_m: 0.1 })),
        // Above the flat end: 0.5 - 0.2 - 0.05.
        (0.25, Box::new(move |c| cylinder(above(0.0, 0.5)(c), ZERO))),
        // Beside the round side, turned about y: 0.5 - 0.1 - 0.05.
        (0.35, Box::new(move |c| cylinder(above(0.0, 0.5)(c), turned))),
        // From the edge at (0.4 - 0.1, 0.6 - 0.2): a distance of 0.5.
        (0.45, Box::new(move |c| cylinder(above(0.4, 0.6)(c), ZERO))),
        // A face: 0.4 - 0.1 - 0.05. An edge: at (0.3, 0.4). A corner turned upwards by 45 degrees.
        (0.25, Box::new(move |c| mesh(above(0.0, 0.4)(c), ZERO))),
        (0.45, Box::new(move |c| mesh(above(0.4, 0.5)(c), ZERO))),
        (
            0.4 - 0.1 * 2.0_f64.sqrt() - 0.05,
            Box::new(move |c| mesh(above(0.0, 0.4)(c), [0.0, FRAC_PI_4, 0.0])),
        ),
        // Inside the cube: from the centre to a face, because a surface has no inside.
        (0.05, Box::new(move |c| mesh(c, ZERO))),
    ];
    for (number, (expected, form)) in cases.iter().enumerate() {
        let actual = from_ball(form);
        assert!((actual - expected).abs() < 1e-9, "case {number}: {actual}, {expected}");
    }
}

fn planned(text: &str) -> Trajectory {
    let program = Program::from_json(text).unwrap();
    let path = JointPath::new(&program, &Robot::default()).unwrap();
    Trajectory::plan(&path, Timing::default()).unwrap()
}

fn swing() -> Trajectory {
    planned(
        r#"{ "version": 1, "start": { "joints_deg": [-50, 40, 0, -70, 0, 60, 0] },
             "motions": [{ "type": "ptp", "joints_deg": [50, 60, 10, -60, 0, 40, 30] },
                         { "type": "lin_rel", "offset": { "z_mm": -80 } }] }"#,
    )
}

/// A box as twelve triangles, or as a solid: the same clearances where the arm is outside.
#[test]
fn a_box_of_triangles_is_as_near_as_a_box() {
    let robot = Robot::default();
    let plan = swing();
    for (center_m, rpy_rad) in [
        ([0.75, 0.2, 0.2], [0.3, 0.4, 0.5]),
        ([0.2, 0.9, 0.8], ZERO),
        ([0.9, 0.0, 0.9], [0.0, 0.0, FRAC_PI_4]),
    ] {
        let solid = scene(Form::Box { center_m, size_m: [0.2; 3], rpy_rad });
        let mesh = scene(Form::Mesh { surface: cube(), origin_m: center_m, rpy_rad });
        let [solid, mesh] = [solid, mesh].map(|scene| {
            let nearest = ArmInScene::new(&robot, &scene).clearance_of(&plan).unwrap();
            (nearest.clearance.distance_m, nearest.at_s, nearest.clearance.link)
        });
        assert!((solid.0 - mesh.0).abs() < 1e-4 && solid.2 == mesh.2, "{solid:?}, {mesh:?}");
        assert!(solid.0 > 0.0 || (solid.1 - mesh.1).abs() < 1e-3, "{solid:?}, {mesh:?}");
    }
}

/// Triangles on a sphere approximate it: the mesh is inside by at most the sagitta of a triangle.
#[test]
fn a_fine_mesh_of_a_sphere_approximates_the_sphere() {
    let robot = Robot::default();
    let plan = swing();
    let (center_m, radius_m) = ([1.0, 0.4, 0.3], 0.15);
    let clearance = |form| {
        let scene = scene(form);
        ArmInScene::new(&robot, &scene).clearance_of(&plan).unwrap().clearance.distance_m
    };
    let exact_m = clearance(Form::Sphere { center_m, radius_m });
    assert!(exact_m > 0.02, "{exact_m}");
    let mut last_m = f64::MAX;
    for steps in [8_u32, 32, 120] {
        let form = Form::Mesh { surface: ball(radius_m, steps), origin_m: center_m, rpy_rad: ZERO };
        let error_m = clearance(form) - exact_m;
        // Half of the diagonal of a cell with edges of pi / steps.
        let half_angle = std::f64::consts::PI / f64::from(steps) * 0.5_f64.sqrt();
        let sagitta_m = radius_m * (1.0 - half_angle.cos());
        assert!((-1e-4..sagitta_m + 1e-4).contains(&error_m), "{steps}: {error_m}, {sagitta_m}");
        assert!(error_m < last_m, "{steps}");
        last_m = error_m + 1e-4;
    }
}

/// Joint 1 turns the arm about the z axis of the base: obstacles that turn with it keep their
/// distances.
#[test]
fn obstacles_that_turn_with_the_arm_keep_their_distances() {
    let robot = Robot::default();
    let turn = 0.7_f64;
    let around = |[x, y, z]: [f64; 3]| {
        let (sin, cos) = turn.sin_cos();
        [cos * x - sin * y, sin * x + cos * y, z]
    };
    let forms = |place: fn([f64; 3], f64) -> [f64; 3], yaw: f64| {
        let at = |place_m| place(place_m, yaw);
        let rpy = |roll, pitch| [roll, pitch, yaw];
        [
            Form::Sphere { center_m: at([0.6, 0.1, 0.5]), radius_m: 0.07 },
            Form::Cylinder {
                center_m: at([0.5, -0.2, 0.7]),
                radius_m: 0.05,
                length_m: 0.3,
                rpy_rad: rpy(0.4, 0.9),
            },
            Form::Mesh { surface: cube(), origin_m: at([0.6, 0.3, 0.3]), rpy_rad: rpy(-0.2, 0.3) },
        ]
    };
    let here = forms(|place_m, _| place_m, 0.0);
    let there = forms(
        |[x, y, z], yaw| {
            let (sin, cos) = yaw.sin_cos();
            [cos * x - sin * y, sin * x + cos * y, z]
        },
        turn,
    );
    for (here, there) in here.into_iter().zip(there) {
        let [here, there] = [here, there].map(|form| ArmInScene::new(&robot, &scene(form)));
        let q = [0.2, 0.6, 0.1, -1.2, 0.3, 0.8, 0.0];
        let turned = std::array::from_fn(|j| if j == 0 { q[j] + turn } else { q[j] });
        let [here, there] = [here.clearance(&q).unwrap(), there.clearance(&turned).unwrap()];
        assert!((here.distance_m - there.distance_m).abs() < 1e-6, "{here:?}, {there:?}");
        assert_eq!(here.link, there.link);
        if here.distance_m > 0.0 {
            let moved = around(here.on_other_m);
            let error = (0..3).map(|i| (moved[i] - there.on_other_m[i]).abs()).fold(0.0, f64::max);
            assert!(error < 1e-3, "{here:?}, {there:?}");
        }
    }
}

#[test]
fn scenes_name_cylinders_spheres_and_meshes() {
    let text = r#"{ "version": 1, "obstacles": [
        { "name": "post", "type": "cylinder", "center_mm": [600, 0, 250], "radius_mm": 40,
          "length_mm": 500, "rpy_deg": [0, 90, 0] },
        { "name": "buoy", "type": "sphere", "center_mm": [0, 700, 300], "radius_mm": 80 },
        { "name": "fixture", "type": "mesh", "file": "cube.obj", "origin_mm": [400, 300, 0],
          "scale": 0.5 }
    ] }"#;
    let read = |text: &str| Scene::from_json_with(text, |_| Ok(CUBE.into()));
    let scene = read(text).unwrap();
    let [post, buoy, fixture] = scene.obstacles() else { panic!("{scene:?}") };
    let rpy_rad = [0.0, FRAC_PI_2, 0.0];
    let cylinder =
        Form::Cylinder { center_m: [0.6, 0.0, 0.25], radius_m: 0.04, length_m: 0.5, rpy_rad };
    assert_eq!(post.form, cylinder);
    assert_eq!(buoy.form, Form::Sphere { center_m: [0.0, 0.7, 0.3], radius_m: 0.08 });
    let Form::Mesh { surface, origin_m, .. } = &fixture.form else { panic!("{fixture:?}") };
    assert_eq!((surface.triangles().len(), *origin_m), (12, [0.4, 0.3, 0.0]));
    assert!(surface.points_m().contains(&[0.05, -0.05, 0.05]));
    let drawn = serde_json::to_value(&scene).unwrap();
    let types = drawn["obstacles"].as_array().unwrap().iter().map(|it| it["type"].clone());
    assert_eq!(types.collect::<Vec<_>>(), ["cylinder", "sphere", "mesh"]);
    assert_eq!(drawn["obstacles"][2]["triangles"].as_array().unwrap().len(), 12);

    for (from, to, message, span) in [
        ("\"radius_mm\": 80", "\"radius_mm\": 0", "obstacle 2: radius_mm is 0; it must be", "0"),
        ("\"radius_mm\": 80", "\"radius_mm\": \"80\"", "obstacle 2: expected a number", "\"80\""),
        (", \"radius_mm\": 80", "", "obstacle 2: the key `radius_mm` is missing", "{"),
        ("\"length_mm\": 500", "\"length_mm\": 1e7", "length_mm is 10000000; it must be", "1e7"),
        ("\"rpy_deg\"", "\"abc_deg\"", "obstacle 1: unknown key `abc_deg`", "\"abc_deg\""),
        ("cube.obj", "cube.step", "obstacle 3: `cube.step`: it has to be *.stl or *.obj", "\""),
        ("\"scale\": 0.5", "\"scale\": 0", "obstacle 3: scale is 0; it must be from", "0"),
        (
            "\"scale\": 0.5",
            "\"scale\": 1e-3",
            "`cube.obj`: it is 0.2 mm long, less than 1 mm",
            "\"",
        ),
        ("\"scale\": 0.5", "\"scale\": 1e4", "it is 2000000 mm long, more than 100000 mm", "\""),
    ] {
        let wrong = text.replacen(from, to, 1);
        assert_ne!(wrong, text, "{from}");
        let error = read(&wrong).unwrap_err();
        assert!(error.message().contains(message), "{}", error.message());
        assert!(wrong[error.place().span.clone()].starts_with(span), "{error}");
    }
    let error = Scene::from_json(text).unwrap_err();
    assert!(error.message().contains("`cube.obj`: only the text of the scene"), "{error}");
    let error = Scene::from_json_with(text, |_| Ok("v 0 0 0\n".into())).unwrap_err();
    assert!(error.message().contains("obstacle 3: `cube.obj`: "), "{error}");
}

#[test]
fn surfaces_are_checked() {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let surface = TriangleSurface::new(corners, [[0, 1, 2], [0, 1, 1]]).unwrap();
    assert_eq!((surface.points_m().len(), surface.triangles().len()), (3, 1));
    let error = |points: &[[f64; 3]], triangles: &[[u32; 3]]| {
        TriangleSurface::new(points.to_vec(), triangles.to_vec()).unwrap_err()
    };
    assert!(matches!(error(&corners, &[[0, 1, 3]]), SurfaceError::Corner { corner: 3, .. }));
    assert!(matches!(error(&corners, &[[0, 0, 2]]), SurfaceError::NoArea));
    assert!(matches!(error(&corners, &[]), SurfaceError::NoArea));
    assert!(matches!(error(&[[f64::NAN; 3]; 3], &[[0, 1, 2]]), SurfaceError::Range));
    let many = vec![[0, 1, 2]; 200_001];
    assert!(matches!(error(&corners, &many), SurfaceError::TooMany { found: 200_001, .. }));
    let half = TriangleSurface::new(corners, vec![[0, 1, 2]; 100_001]).unwrap();
    let mesh = |name: &str| Obstacle {
        name: name.to_owned(),
        form: Form::Mesh { surface: half.clone(), origin_m: ZERO, rpy_rad: ZERO },
    };
    let fault = Scene::new(vec![mesh("a"), mesh("b")]);
    assert_eq!(fault, Err(SceneFault::TooManyTriangles { found: 200_002, max: 200_000 }));
}

/// Meshes are not read any more once they have too many triangles.
#[test]
fn too_many_triangles_end_the_reading() {
    let mesh = |name: u32| format!(r#"{{ "name": "{name}", "type": "mesh", "file": "a.obj" }}"#);
    let meshes = (0..10).map(mesh).collect::<Vec<_>>().join(",");
    let text = format!(r#"{{ "version": 1, "obstacles": [{meshes}] }}"#);
    let obj = format!("v 0 0 0\nv 100 0 0\nv 0 100 0\n{}", "f 1 2 3\n".repeat(100_001));
    let mut reads = 0;
    let error = Scene::from_json_with(&text, |_| {
        reads += 1;
        Ok(obj.clone().into())
    });
    let message = error.unwrap_err().message();
    assert!(message.contains("more than 200000 triangles"), "{message}");
    assert_eq!(reads, 2);
}

/// A kilometre away, rounding makes the corners of a narrow triangle coincide.
#[test]
fn narrow_triangles_far_away_are_kept() {
    let text = r#"{ "version": 1, "obstacles": [{ "name": "a", "type": "mesh", "file": "a.obj",
        "origin_mm": [1000000, 1000000, 1000000], "rpy_deg": [10, 20, 30] }] }"#;
    let obj = "v 0 0 0\nv 1000 0 0\nv 0 0.00000100001 0\nf 1 2 3\n";
    let scene = Scene::from_json_with(text, |_| Ok(obj.into())).unwrap();
    let clearance = ArmInScene::new(&Robot::default(), &scene).clearance(&[0.0; 7]).unwrap();
    let expected_m = 1000.0 * 3.0_f64.sqrt();
    assert!((clearance.distance_m - expected_m).abs() < 2.0, "{clearance:?}");
}
