//! Meshes of a user's URDF: poses, clearances, and places of faults.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fmt::Write as _;

use iiwa_kin::Robot;
use iiwa_scene::{ArmInScene, ArmMeshError, ArmMeshes, Scene};

/// Creates a box between two corners, as OBJ.
fn cuboid(low: [f64; 3], high: [f64; 3]) -> String {
    let mut file = "mtllib paint.mtl\nusemtl blue\n".to_owned();
    for i in 0..8 {
        let [x, y, z] =
            [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { low[axis] } else { high[axis] });
        writeln!(file, "v {x} {y} {z}").unwrap();
    }
    for [a, b, c, d] in
        [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]]
    {
        writeln!(file, "f {a} {b} {c} {d}").unwrap();
    }
    file
}

/// Returns the robot's own URDF with an addition to the link of this number.
fn urdf_with(robot: &Robot, link: usize, element: &str) -> String {
    let name = format!("<link name=\"iiwa_link_{link}\">");
    let urdf = robot.to_urdf();
    assert!(urdf.contains(&name), "{urdf}");
    urdf.replace(&name, &format!("{name}{element}"))
}

fn visual(rest: &str) -> String {
    format!("<visual>{rest}</visual>")
}

fn nothing(name: &str) -> Result<Vec<u8>, String> {
    Err(format!("asked for {name}"))
}

fn extents(meshes: &ArmMeshes, link: usize) -> [[f64; 2]; 3] {
    let points: Vec<_> = meshes.visual[link].iter().flat_map(|patch| &patch.points).collect();
    [0, 1, 2].map(|i| {
        let along = points.iter().map(|point| point[i]);
        [along.clone().fold(f64::MAX, f64::min), along.fold(f64::MIN, f64::max)]
    })
}

#[test]
fn meshes_are_placed_and_painted() {
    let robot = Robot::lbr_iiwa_7_r800();
    let mesh = "<geometry><mesh filename=\"package://arm/box.obj\" scale=\"0.001 0.001 \
                -0.001\"/></geometry>";
    let origin = "<origin xyz=\"0.1 0 0\" rpy=\"0 0 1.5707963267948966\"/>";
    let read = |name: &str| match name {
        "package://arm/box.obj" => Ok(cuboid([0.0; 3], [10.0, 20.0, 30.0]).into_bytes()),
        "package://arm/paint.mtl" => Ok(b"newmtl blue\nKd 0 0 1\n".to_vec()),
        other => nothing(other),
    };
    let urdf = urdf_with(&robot, 3, &visual(&format!("{origin}{mesh}")));
    let meshes = ArmMeshes::from_urdf(&robot, &urdf, read).unwrap();
    for (actual, expected) in
        extents(&meshes, 3).iter().zip([[0.08, 0.1], [0.0, 0.01], [-0.03, 0.0]])
    {
        assert!((actual[0] - expected[0]).abs() < 1e-7, "{actual:?}");
        assert!((actual[1] - expected[1]).abs() < 1e-7, "{actual:?}");
    }
    // Triangles are oriented outwards although the mesh is mirrored.
    let patch = &meshes.visual[3][0];
    let volume: f64 = patch
        .triangles
        .iter()
        .map(|corners| {
            let [a, b, c] = corners.map(|it| patch.points[it as usize]);
            let across = [0, 1, 2].map(|i| {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                b[j] * c[k] - b[k] * c[j]
            });
            (a[0] * across[0] + a[1] * across[1] + a[2] * across[2]) / 6.0
        })
        .sum();
    assert!((volume - 6e-6).abs() < 1e-10, "{volume}");
    assert_eq!(patch.rgb, Some([0.0, 0.0, 1.0]));
    assert!((0..8).all(|link| link == 3 || meshes.visual[link].is_empty()));

    // The URDF's colour takes precedence over that of the file; it may be defined further below.
    let paint = "<material name=\"paint\"/>";
    let named = "<material name=\"paint\"><color rgba=\"1 0.5 0 1\"/></material></robot>";
    let urdf = urdf_with(&robot, 3, &visual(&format!("{mesh}{paint}"))).replace("</robot>", named);
    let meshes = ArmMeshes::from_urdf(&robot, &urdf, read).unwrap();
    assert_eq!(meshes.visual[3][0].rgb, Some([1.0, 0.5, 0.0]));
}

/// Frames fixed to a link move with it, wherever the URDF places them.
#[test]
fn fixed_links_are_parts() {
    let robot = Robot::lbr_iiwa_7_r800();
    let cover = "<link name=\"cover\"><visual><geometry><mesh \
                 filename=\"c.obj\"/></geometry></visual></link><joint name=\"cover_joint\" \
                 type=\"fixed\"><parent link=\"iiwa_link_2\"/><child link=\"cover\"/><origin \
                 xyz=\"0 0 0.5\"/></joint></robot>";
    let urdf = robot.to_urdf().replace("</robot>", cover);
    let read = |_: &str| Ok(cuboid([0.0; 3], [0.1; 3]).into_bytes());
    let meshes = ArmMeshes::from_urdf(&robot, &urdf, read).unwrap();
    let [_, _, along] = extents(&meshes, 2);
    assert!((along[0] - 0.5).abs() < 1e-7 && (along[1] - 0.6).abs() < 1e-7, "{along:?}");
}

/// A box that contains all of link 7 has the same clearance as the same box as a tool.
#[test]
fn clearances_are_those_of_the_hulls() {
    let robot = Robot::lbr_iiwa_7_r800();
    let cage = r#"{ "version": 1, "obstacles": [
        { "name": "post", "type": "box", "center_mm": [600, 200, 400], "size_mm": [80, 80, 900] },
        { "name": "floor", "type": "plane", "point_mm": [0, 0, -100], "normal": [0, 0, 1] }"#;
    let plain = Scene::from_json(&format!("{cage}] }}")).unwrap();
    let tool =
        r#"], "tool": [{ "type": "box", "center_mm": [0, 0, 0], "size_mm": [300, 300, 300] }] }"#;
    let as_tool = Scene::from_json(&format!("{cage}{tool}")).unwrap();
    // The frame of link 7 is at the wrist, and the flange is d7 further.
    let flange = robot.lengths().flange_m;
    let file = cuboid([-0.15, -0.15, flange - 0.15], [0.15, 0.15, flange + 0.15]);
    let mesh = "<geometry><mesh filename=\"box.obj\"/></geometry>";
    let urdf = urdf_with(&robot, 7, &visual(mesh));
    let meshes = ArmMeshes::from_urdf(&robot, &urdf, |_| Ok(file.clone().into_bytes())).unwrap();
    let meshed = ArmInScene::with_meshes(&robot, &plain, &meshes);
    let tooled = ArmInScene::new(&robot, &as_tool);
    let mut nearest = 0;
    for i in 0..40 {
        let q =
            [0.1, 0.4, -0.2, -1.1, 0.3, 0.7, 0.2].map(|v| v * (f64::from(i) * 0.37).sin() * 2.0);
        let (actual, expected) = (meshed.clearance(&q).unwrap(), tooled.clearance(&q).unwrap());
        assert!((actual.distance_m - expected.distance_m).abs() < 1e-6, "{actual:?} {expected:?}");
        if expected.link == 8 {
            assert_eq!(actual.link, 7);
            nearest += 1;
        }
    }
    assert!(nearest > 5, "the box is the nearest {nearest} times");

    // A collision mesh takes precedence over visual meshes.
    let small = "<collision><geometry><mesh filename=\"small.obj\"/></geometry></collision>";
    let urdf = urdf_with(&robot, 7, &format!("{}{small}", visual(mesh)));
    let read = |name: &str| match name {
        "box.obj" => Ok(file.clone().into_bytes()),
        _ => Ok(cuboid([-0.01; 3], [0.01; 3]).into_bytes()),
    };
    let meshes = ArmMeshes::from_urdf(&robot, &urdf, read).unwrap();
    assert_eq!(meshes.hulls[7].len(), 1);
    assert!(meshes.hulls[7][0].corners_m().iter().flatten().all(|v| v.abs() < 0.0101));
}

#[test]
fn invalid_arms_are_refused() {
    let robot = Robot::lbr_iiwa_7_r800();
    let mesh = visual("<geometry><mesh filename=\"package://arm/box.obj\"/></geometry>");
    let urdf = urdf_with(&robot, 5, &mesh);
    let refused = |urdf: &str, contents: Result<&[u8], &str>| {
        let contents = contents.map(<[u8]>::to_vec).map_err(str::to_owned);
        ArmMeshes::from_urdf(&robot, urdf, |_| contents.clone()).unwrap_err()
    };
    let error = refused(&urdf, Err("there is no such package"));
    let text = error.to_string();
    assert!(text.contains("package://arm/box.obj") && text.contains("no such package"), "{text}");
    assert!(error.place().is_some_and(|place| urdf[place.span.clone()].contains("box.obj")));
    assert!(!error.message().contains(" at line"), "{}", error.message());
    for (contents, reason) in [
        (&b"v 0 0 0\nv 1 0 0\n"[..], "it has no triangles"),
        (b"", "no triangles"),
        (b"v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 2 3\nf 1 2 4\n", "scale=\"0.001 0.001 0.001\""),
        (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "no volume"),
    ] {
        let text = refused(&urdf, Ok(contents)).to_string();
        assert!(text.contains(reason), "{text}");
    }
    let stl = urdf.replace("box.obj", "box.stl");
    let text = refused(&stl, Ok(&[0; 100])).to_string();
    assert!(text.contains("not a valid STL file"), "{text}");
    let text = refused(&urdf.replace("box.obj", "box.step"), Ok(b"")).to_string();
    assert!(text.contains("*.dae"), "{text}");
    let text = refused(&robot.to_urdf(), Ok(b"")).to_string();
    assert!(text.contains("names no meshes"), "{text}");
    let other = urdf_with(&Robot::lbr_iiwa_14_r820(), 5, &mesh);
    let error = refused(&other, Ok(b""));
    assert!(matches!(error, ArmMeshError::Urdf(_)), "{error}");
    assert!(error.to_string().contains("axis of joint 2"), "{error}");
}
