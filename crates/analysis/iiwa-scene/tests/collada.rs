//! Collada files: placements, units, primitives, colours, refusals and bounds.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fmt::Write as _;

use iiwa_kin::Robot;
use iiwa_scene::{ArmInScene, ArmMeshes, Patch, Scene, TriangleMesh, TriangleMeshError};

/// Indices of the triangles of a box, whose corner `i` is at the far end of axis `k` if bit `k` of
/// `i` is set.
const BOX: &str = "0 2 1 1 2 3 4 5 6 5 7 6 0 1 4 1 5 4 2 6 3 3 6 7 0 4 2 2 4 6 1 3 5 3 7 5";

/// Creates a geometry from a list of positions and primitives.
pub(crate) fn geometry(id: &str, positions: &str, primitives: &str) -> String {
    let count = positions.split_whitespace().count();
    format!(
        r##"<geometry id="{id}"><mesh>
<source id="{id}-p"><float_array id="{id}-a" count="{count}">{positions}</float_array>
<technique_common><accessor source="#{id}-a" count="{}" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="{id}-v"><input semantic="POSITION" source="#{id}-p"/></vertices>
{primitives}</mesh></geometry>"##,
        count / 3
    )
}

/// Creates triangles of the geometry with this `id`.
pub(crate) fn triangles(id: &str, corners: &str) -> String {
    let count = corners.split_whitespace().count() / 3;
    format!(
        r##"<triangles count="{count}">
            <input semantic="VERTEX" source="#{id}-v" offset="0"/><p>{corners}</p></triangles>"##
    )
}

/// Creates a box between two corners.
fn cuboid(id: &str, low: [f64; 3], high: [f64; 3]) -> String {
    let mut positions = String::new();
    for i in 0..8 {
        for axis in 0..3 {
            let value = if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
            write!(positions, "{value} ").unwrap();
        }
    }
    geometry(id, &positions, &triangles(id, BOX))
}

/// Creates a file with libraries, and with nodes in its scene.
pub(crate) fn file(asset: &str, libraries: &str, nodes: &str) -> String {
    format!(
        r##"<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>{asset}<up_axis>Z_UP</up_axis></asset>
{libraries}
<library_visual_scenes><visual_scene id="S">{nodes}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#S"/></scene>
</COLLADA>"##
    )
}

fn geometries(geometries: &str) -> String {
    format!("<library_geometries>{geometries}</library_geometries>")
}

pub(crate) fn read(text: &str) -> Result<Vec<Patch>, TriangleMeshError> {
    TriangleMesh::read("part.dae", text.as_bytes(), |_| None).map(|mesh| mesh.patches)
}

fn refused(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

fn points(patches: &[Patch]) -> Vec<[f64; 3]> {
    let corners = |patch: &Patch| {
        patch.triangles.iter().flatten().map(|it| patch.points[*it as usize]).collect::<Vec<_>>()
    };
    patches.iter().flat_map(corners).collect()
}

fn extents(patches: &[Patch]) -> [[f64; 2]; 3] {
    let points: Vec<_> = patches.iter().flat_map(|patch| patch.points.clone()).collect();
    [0, 1, 2].map(|axis| {
        let along = points.iter().map(|point| point[axis]);
        [along.clone().fold(f64::MAX, f64::min), along.fold(f64::MIN, f64::max)]
    })
}

/// Volume of a closed surface; negative if its triangles are oriented inwards.
fn volume(patches: &[Patch]) -> f64 {
    let corners = points(patches);
    let volumes = corners.chunks(3).map(|corners| {
        let [a, b, c] = [corners[0], corners[1], corners[2]];
        let across = [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            b[j] * c[k] - b[k] * c[j]
        });
        (a[0] * across[0] + a[1] * across[1] + a[2] * across[2]) / 6.0
    });
    volumes.sum()
}

fn assert_near(actual: &[f64], expected: &[f64]) {
    assert_eq!(actual.len(), expected.len());
    let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-12;
    assert!(actual.iter().zip(expected).all(near), "{actual:?} {expected:?}");
}

const METRE: &str = r#"<unit name="meter" meter="1"/>"#;
const INSTANCE: &str = r##"<instance_geometry url="#box"/>"##;

/// A block of 60 x 60 x 200 mm on the flange, 500 mm aside.
fn block(libraries: &str, nodes: &str) -> String {
    let block = cuboid("box", [-0.03, -0.03, 0.0], [0.03, 0.03, 0.2]);
    file(METRE, &(geometries(&block) + libraries), nodes)
}

/// Returns the clearance from a plane, in mm, of an arm that points upwards and has a mesh on its
/// flange.
fn clearance_mm(mesh: &str, plane: &str) -> f64 {
    let robot = Robot::lbr_iiwa_7_r800();
    let link = r#"<link name="iiwa_link_ee"/>"#;
    let with_mesh = r#"<link name="iiwa_link_ee"><visual><geometry>
        <mesh filename="tool.dae"/></geometry></visual></link>"#;
    let urdf = robot.to_urdf();
    assert!(urdf.contains(link), "{urdf}");
    let urdf = urdf.replace(link, with_mesh);
    let meshes = ArmMeshes::from_urdf(&robot, &urdf, |_| Ok(mesh.into())).unwrap();
    let scene = format!(
        r#"{{ "version": 1, "obstacles": [{{ "name": "p", "type": "plane", {plane} }}] }}"#
    );
    let scene = Scene::from_json(&scene).unwrap();
    let arm = ArmInScene::with_meshes(&robot, &scene, &meshes);
    1e3 * arm.clearance(&[0.0; 7]).unwrap().distance_m
}

#[test]
fn placements_of_instances_count() {
    let library = |nodes: &str| format!("<library_nodes>{nodes}</library_nodes>");
    let aside = "<matrix>1 0 0 0.5 0 1 0 0 0 0 1 0 0 0 0 1</matrix>";
    let cases = [
        ("", format!("<node id='n'>{aside}{INSTANCE}</node>")),
        (
            &library(&format!("<node id='lib'>{aside}{INSTANCE}</node>")),
            "<node><instance_node url='#lib'/></node>".to_owned(),
        ),
        (
            &library(&format!("<node id='lib'>{INSTANCE}</node>")),
            format!("<node>{aside}<instance_node url='#lib'/></node>"),
        ),
        // An instance of a node of the scene itself, whose instance is beyond the first one.
        (
            "",
            format!(
                "<node id='n'><translate>-0.5 0 0</translate>{INSTANCE}</node>\
                 <node><translate>1 0 0</translate><instance_node url='#n'/></node>"
            ),
        ),
        // Nested nodes.
        (
            "",
            format!(
                "<node><translate>0.25 0 0</translate><node><scale>1 1 1</scale>\
                 <translate>0.25 0 0</translate>{INSTANCE}</node></node>"
            ),
        ),
    ];
    for (libraries, nodes) in cases {
        let mesh = block(libraries, &nodes);
        let plane = r#""point_mm": [3000, 0, 0], "normal": [-1, 0, 0]"#;
        let clearance_mm = clearance_mm(&mesh, plane);
        assert!((clearance_mm - 2470.0).abs() < 1e-6, "{clearance_mm}: {nodes}");
    }
    // Each place of a part counts.
    let twice = block("", &format!("<node>{INSTANCE}</node><node>{aside}{INSTANCE}</node>"));
    let patches = read(&twice).unwrap();
    assert_eq!(points(&patches).len(), 2 * 36);
    assert_near(extents(&patches).as_flattened(), &[-0.03, 0.53, -0.03, 0.03, 0.0, 0.2]);
}

#[test]
fn the_unit_is_that_of_the_asset() {
    let node = format!("<node>{INSTANCE}</node>");
    let plane = r#""point_mm": [0, 0, 3000], "normal": [0, 0, -1]"#;
    let block_mm = geometries(&cuboid("box", [-30.0, -30.0, 0.0], [30.0, 30.0, 200.0]));
    let old = "<!-- exported, was <unit meter=\"0.001\"/> -->";
    let cases = [
        block("", &node).replace("<asset>", &format!("{old}<asset>")),
        block("", &node).replace(METRE, ""),
        block("", &node).replace(METRE, "<unit name='meter'/>"),
        file("<unit meter = ' 0.001 '\n name='mm' />", &block_mm, &node),
        file("<extra><unit meter='3'/></extra><unit meter='1E-3'/>", &block_mm, &node),
        // Another unit in a part of the document that is not shown.
        file(
            "<unit meter='0.001'/>",
            &(block_mm.clone()
                + "<library_lights><asset><unit meter='1'/></asset></library_lights>"),
            &node,
        ),
    ];
    for mesh in cases {
        let clearance_mm = clearance_mm(&mesh, plane);
        assert!((clearance_mm - 1508.0).abs() < 1e-6, "{clearance_mm}: {mesh}");
    }
    let mixed = block("", &node).replace("<mesh>", "<asset><unit meter='2'/></asset><mesh>");
    assert!(refused(&mixed).contains("another <unit> than the document"), "{}", refused(&mixed));
    for wrong in ["0", "-1", "1,5", "inf", ""] {
        let text = refused(&block("", &node).replace("meter=\"1\"", &format!("meter=\"{wrong}\"")));
        assert!(text.contains(&format!("line 3, column 8: the unit is \"{wrong}\" m")), "{text}");
    }
}

#[test]
fn transformations_are_applied_in_order() {
    let corner = geometry("box", "1 0 0 1 2 3 0 0 1", &triangles("box", "0 1 2"));
    let first = |transformations: &str| {
        let node = format!("<node>{transformations}{INSTANCE}</node>");
        points(&read(&file(METRE, &geometries(&corner), &node)).unwrap())
    };
    for (transformations, expected) in [
        ("", [[1.0, 0.0, 0.0], [1.0, 2.0, 3.0]]),
        (
            "<translate>1 2 3</translate><rotate>0 0 1 90</rotate><scale>2 2 2</scale>",
            [[1.0, 4.0, 3.0], [-3.0, 4.0, 9.0]],
        ),
        (
            "<scale>2 1 1</scale><rotate>0 0 1 90</rotate><translate>1 2 3</translate>",
            [[-4.0, 2.0, 3.0], [-8.0, 2.0, 6.0]],
        ),
        ("<rotate>1 1 1 120</rotate>", [[0.0, 1.0, 0.0], [3.0, 1.0, 2.0]]),
        ("<rotate>0 0 0 0</rotate>", [[1.0, 0.0, 0.0], [1.0, 2.0, 3.0]]),
        ("<lookat>1 0 0  0 0 0  0 0 1</lookat>", [[1.0, 1.0, 0.0], [4.0, 1.0, 2.0]]),
        (
            "<matrix>0 -1 0 5\n1 0 0 6\n0 0 1 7<!-- last row: -->\n0 0 0 1</matrix>",
            [[5.0, 7.0, 7.0], [3.0, 7.0, 10.0]],
        ),
    ] {
        let actual = first(transformations);
        assert_near(actual[..2].as_flattened(), expected.as_flattened());
    }
    // A mirrored solid is oriented outwards.
    for scale in ["1 1 1", "-1 1 1", "-1 -1 1", "-2 -0.5 -1"] {
        let node = format!("<node><scale>{scale}</scale>{INSTANCE}</node>");
        let volume = volume(&read(&block("", &node)).unwrap());
        assert!((volume - 0.06 * 0.06 * 0.2).abs() < 1e-12, "{scale}: {volume}");
    }
}

#[test]
fn only_shown_geometry_counts() {
    let node = format!("<node>{INSTANCE}</node>");
    // A geometry without an instance, a scene that is not shown, and a position without a triangle.
    let far = cuboid("far", [5.0; 3], [9.0; 3]);
    let other = "<library_visual_scenes><visual_scene id='T'><node>\
                 <instance_geometry url='#far'/></node></visual_scene></library_visual_scenes>";
    let corner = geometry("box", "0 0 0 1 0 0 7 7 7 0 1 0", &triangles("box", "0 1 3"));
    let patches = read(&file(METRE, &(geometries(&(corner + &far)) + other), &node)).unwrap();
    assert_eq!(patches.len(), 1);
    assert_eq!(patches[0].points, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(patches[0].triangles, [[0, 1, 2]]);
    // Lights and cameras have no shape.
    let lit =
        block("", &format!("<node><instance_light url='#a'/><extra><b/></extra>{INSTANCE}</node>"));
    assert_eq!(points(&read(&lit).unwrap()).len(), 36);
    assert_eq!(refused(&block("", "")), "it has no triangles");
}

#[test]
fn all_primitives_are_read() {
    let square = "0 0 0 1 0 0 1 1 0 0 1 0";
    let input = r##"<input semantic="VERTEX" source="#box-v" offset="1"/>
        <input semantic="NORMAL" source="#n" offset="0"/>"##;
    for (primitive, expected) in [
        ("<triangles count='2'>I<p>9 0 9 1 9 2 9 0 9 2 9 3</p></triangles>", [0, 1, 2, 0, 2, 3]),
        (
            "<polylist count='1'>I<vcount>4</vcount><p>9 0 9 1 9 2 9 3</p></polylist>",
            [0, 1, 2, 0, 2, 3],
        ),
        ("<polygons count='1'>I<p>9 0 9 1 9 2 9 3</p></polygons>", [0, 1, 2, 0, 2, 3]),
        (
            "<polygons count='2'>I<p>9 1 9 2 9 3</p><p>9 0 9 1 9 3</p></polygons>",
            [1, 2, 3, 0, 1, 3],
        ),
        ("<trifans count='1'>I<p>9 3 9 0 9 1 9 2</p></trifans>", [3, 0, 1, 3, 1, 2]),
        ("<tristrips>I<p>9 0 9 1 9 3 9 2</p></tristrips>", [0, 1, 3, 3, 1, 2]),
        (
            "<lines count='1'>I<p>9 0 9 2</p></lines><triangles count='0'>I</triangles>\
             <polylist count='3'>I<vcount>3 2 3</vcount>\
             <p>9 0 9 1 9 2 9 0 9 1 9 0 9 2 9 3</p></polylist>",
            [0, 1, 2, 0, 2, 3],
        ),
    ] {
        let primitive = primitive.replace('I', input);
        let mesh = geometry("box", square, &primitive);
        let patches = read(&file("", &geometries(&mesh), &format!("<node>{INSTANCE}</node>")));
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(points(&patches.unwrap()), expected.map(|it| corners[it]), "{primitive}");
    }
    // An accessor with an offset, and with a value that has no name.
    let accessor = file(
        "",
        &geometries(&geometry("box", square, &triangles("box", "0 1 2"))),
        &format!("<node>{INSTANCE}</node>"),
    )
    .replace("count=\"12\">", "count=\"14\">8 8 ")
    .replace(
        "count=\"4\" stride=\"3\">",
        "count=\"3\" stride=\"4\" offset=\"1\"><param type=\"float\"/>",
    );
    let corners = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]];
    assert_eq!(points(&read(&accessor).unwrap()), corners);
}

#[test]
fn colours_are_those_of_the_instance() {
    let effect = |id: &str, shader: &str| {
        format!(
            "<effect id='{id}'><profile_COMMON><technique sid='t'>{shader}\
             </technique></profile_COMMON></effect>"
        )
    };
    let effects = effect(
        "e1",
        "<phong><emission><color>9 9 9 1</color></emission>\
         <diffuse><color>0.25 0.5 1 1</color></diffuse></phong>",
    ) + &effect("e2", "<lambert><diffuse><texture texture='a'/></diffuse></lambert>")
        + &effect("e3", "<constant><emission><color>1 0 0</color></emission></constant>");
    let materials = ["1", "2", "3"].map(|number| {
        format!("<material id='m{number}'><instance_effect url='#e{number}'/></material>")
    });
    let libraries = format!(
        "<library_effects>{effects}</library_effects><library_materials>{}</library_materials>",
        materials.concat()
    );
    let bound = |target: &str| {
        format!(
            "<node><instance_geometry url='#box'><bind_material><technique_common>\
             <instance_material symbol='s' target='{target}'/></technique_common></bind_material>\
             </instance_geometry></node>"
        )
    };
    for (target, expected) in [
        ("#m1", Some([0.25, 0.5, 1.0])),
        ("#m2", None),
        ("#m3", Some([1.0, 0.0, 0.0])),
        ("#m4", None),
    ] {
        let text =
            block(&libraries, &bound(target)).replace("<triangles", "<triangles material='s'");
        assert_eq!(read(&text).unwrap()[0].rgb, expected, "{target}");
    }
}

/// A material is read once, and its faults are not located in the text.
#[test]
fn colours_of_many_instances_are_read() {
    let spaces = " ".repeat(1 << 20);
    let libraries = format!(
        "<library_effects><effect id='e'><profile_COMMON><technique><phong><diffuse>\
         <color>{spaces}1 0 x</color></diffuse></phong></technique></profile_COMMON></effect>\
         </library_effects><library_materials><material id='m'><instance_effect url='#e'/>\
         </material></library_materials>"
    );
    let bound = |target: &str| {
        format!(
            "<node><instance_geometry url='#box'><bind_material><technique_common>\
             <instance_material symbol='s' target='{target}'/></technique_common></bind_material>\
             </instance_geometry></node>"
        )
    };
    let nodes = (bound("#m") + &bound("#missing")).repeat(5000);
    let text = block(&libraries, &nodes).replace("<triangles", "<triangles material='s'");
    let patches = read(&text).unwrap();
    assert_eq!(patches.len(), 10_000);
    assert!(patches.iter().all(|patch| patch.rgb.is_none()));
}

/// Start tags that the parser would take long for are refused at their place.
#[test]
fn start_tags_are_bounded() {
    let long = format!("\n  <extra name='{}'/>", "x".repeat(100 << 10));
    let mut many = "\n  <extra".to_owned();
    for number in 0..50_000 {
        write!(many, " a{number}=''").unwrap();
    }
    many += "/>";
    for extra in [long, many] {
        let text = block("", &format!("<node>{INSTANCE}{extra}</node>"));
        let line = text.lines().position(|line| line.starts_with("  <extra")).unwrap() + 1;
        let message = refused(&text);
        let expected = format!("line {line}, column 3: a start tag has more than 65536 bytes");
        assert!(message.contains(&expected), "{message}");
    }
}

#[test]
fn text_may_have_a_mark_and_other_characters() {
    let mut bytes = b"\xef\xbb\xbf".to_vec();
    bytes.extend(block("", &format!("<node name='Gr\u{fc}n'>{INSTANCE}</node>")).bytes());
    let latin: Vec<u8> = bytes[3..].iter().copied().filter(|byte| *byte != 0xc3).collect();
    for bytes in [bytes, latin] {
        let mesh = TriangleMesh::read("a.dae", &bytes, |_| None).unwrap();
        assert_eq!(points(&mesh.patches).len(), 36);
    }
    let wide: Vec<u8> = "\u{feff}<COLLADA/>".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let error = TriangleMesh::read("a.dae", &wide, |_| None).unwrap_err().to_string();
    assert!(error.contains("UTF-16"), "{error}");
}

#[test]
fn what_cannot_be_applied_is_refused_at_its_place() {
    let node = |inner: &str| block("", &format!("<node id='n'>{inner}</node>"));
    let skin = "<library_controllers><controller id='c'><skin source='#box'/></controller>\
                </library_controllers>";
    let controller = block(skin, "<node id='n'><instance_controller url='#c'/></node>");
    let whole = node(INSTANCE);
    let primitive = |from: &str, to: &str| {
        assert!(whole.contains(from), "{whole}");
        whole.replace(from, to)
    };
    let cases = [
        (controller, "<instance_controller> in <node> \"n\" cannot be applied"),
        (node("<skew>45 0 1 0 1 0 0</skew>"), "<skew> in <node> \"n\" cannot be applied"),
        (node("<warp/>"), "<warp> in <node> \"n\" cannot be applied"),
        (node("<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1</matrix>"), "the last row of <matrix>"),
        (node("<translate>1 2</translate>"), "<translate> has 2 numbers; it must have 3"),
        (node("<translate>1 2 3,5</translate>"), "\"3,5\" in <translate> is not a finite number"),
        (node("<scale>1 2 NaN</scale>"), "\"NaN\" in <scale> is not a finite number"),
        (node("<rotate>0 0 0 5</rotate>"), "the axis of <rotate> has zero length"),
        (node("<lookat>0 0 0 0 0 1 0 0 1</lookat>"), "<lookat> has no direction"),
        (node("<instance_node url='#m'/>"), "refers to \"#m\", and no <node> has this id"),
        (node("<instance_node url='#n'/>"), "<node> \"n\" contains itself"),
        (node("<instance_node url='b.dae#n'/>"), "refers to \"b.dae#n\" outside of this file"),
        (node("<instance_geometry/>"), "<instance_geometry> has no attribute `url`"),
        (
            block(
                "",
                &format!(
                    "<node id='n'/><node id='n'/><node><instance_node url='#n'/>{INSTANCE}</node>"
                ),
            ),
            "refers to \"#n\", and several <node> have this id",
        ),
        (
            primitive("<p>0 2", "<p>0 1000000"),
            "a corner with the index 1000000, and its mesh has 8 positions",
        ),
        (primitive("<p>0 2", "<p>0 -2"), "\"-2\" in <p> is not an index"),
        (primitive("<p>0 2 1", "<p>0 2"), "<triangles> has 35 corners"),
        (primitive("<p>0 2 1", "<p>"), "<triangles> states 12, and has 11"),
        (primitive("<p>", "<ph/><p>"), "a polygon with holes"),
        (primitive("offset=\"0\"", "offset=\"1\""), ""),
        (primitive("offset=\"0\"", "offset=\"99999999999\""), "<input> has no valid `offset`"),
        (primitive("VERTEX", "TEXCOORD"), "has no <input> of its mesh's <vertices>"),
        (primitive("POSITION", "NORMAL"), "must have one <input> of POSITION"),
        (primitive("count=\"8\"", "count=\"9\""), "<accessor> has 9 positions of 3 numbers"),
        (primitive("count=\"8\"", "count=\"18446744073709551615\""), "<accessor> has 1844"),
        (primitive("name=\"Y\"", "name=\"V\""), "no <param> with the name Y"),
        (primitive("stride=\"3\"", "stride=\"2\""), "the stride of <accessor> is 2"),
        (
            primitive("<triangles", "<hexagons").replace("</triangles", "</hexagons"),
            "<hexagons> cannot be read",
        ),
        (
            primitive("<mesh>", "<brep>").replace("</mesh>", "</brep>"),
            "<brep> in <geometry> \"box\"",
        ),
        (primitive("<scene>", "<scenery>").replace("</scene>", "</scenery>"), "<scene> is missing"),
        ("<a/>".to_owned(), "the outermost element is <a>, not <COLLADA>"),
        (String::new(), "line 1, column 1"),
    ];
    for (text, words) in cases {
        let message = refused(&text);
        assert!(
            message.contains(words) && message.contains("Collada: line "),
            "{message}: {words}"
        );
    }
    for cut in [10, 200, 700, whole.len() - 12] {
        refused(&whole[..cut]);
    }
    // The place is that of the element.
    let text = node("\n  <skew>45 0 1 0 1 0 0</skew>");
    let line = text.lines().position(|line| line.contains("<skew>")).unwrap() + 1;
    let message = refused(&text);
    assert!(message.contains(&format!("line {line}, column 3: <skew>")), "{message}");
}

#[test]
fn scenes_are_bounded() {
    let chain = |length: usize, times: usize| {
        let mut nodes = String::new();
        for number in 0..length {
            let next = format!("<instance_node url='#n{}'/>", number + 1).repeat(times);
            write!(nodes, "<node id='n{number}'>{next}</node>").unwrap();
        }
        write!(nodes, "<node id='n{length}'>{INSTANCE}</node>").unwrap();
        let library = format!("<library_nodes>{nodes}</library_nodes>");
        block(&library, "<node><instance_node url='#n0'/></node>")
    };
    assert_eq!(points(&read(&chain(90, 1)).unwrap()).len(), 36);
    assert_eq!(points(&read(&chain(10, 2)).unwrap()).len(), 36 << 10);
    let text = refused(&chain(200, 1));
    assert!(text.contains("nodes are nested more than 100 deep"), "{text}");
    let text = refused(&chain(60, 2));
    assert!(text.contains("more than 2000000 triangles"), "{text}");
    let text = refused(&chain(60, 2).replace(INSTANCE, ""));
    assert!(text.contains("more than 1000000 elements"), "{text}");
    // A transformation is read once: its text is scanned 1 MB, not 64 GB.
    let spaces = " ".repeat(1 << 20);
    let matrix = format!("<matrix>{spaces}1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>");
    let replaced = chain(16, 2).replace(INSTANCE, &matrix);
    assert_eq!(refused(&replaced), "it has no triangles");
    // So are the children of a node, of any kind.
    let comments = "<!---->".repeat(100_000);
    let replaced = chain(16, 2).replace(INSTANCE, &comments);
    assert_eq!(refused(&replaced), "it has no triangles");
    // Two nodes that contain each other.
    let ring = "<library_nodes><node id='a'><instance_node url='#b'/></node>\
                <node id='b'><instance_node url='#a'/></node></library_nodes>";
    let text = refused(&block(ring, "<node><instance_node url='#a'/></node>"));
    assert!(text.contains("<node> \"a\" contains itself"), "{text}");
    // Nested elements that are not shown need no stack.
    let deep = format!("{}{}", "<b>".repeat(50_000), "</b>".repeat(50_000));
    let shown = block("", &format!("<node>{INSTANCE}<extra>{deep}</extra></node>"));
    assert_eq!(points(&read(&shown).unwrap()).len(), 36);
}
