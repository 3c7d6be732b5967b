//! STL files as different programs write them.

// Test helpers may panic.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use iiwa_scene::{ConvexHull, Scene, TriangleMesh};

use crate::mesh::{ascii_stl, binary_stl};

fn read(bytes: &[u8]) -> Result<TriangleMesh, String> {
    TriangleMesh::read("a.stl", bytes, |_| None).map_err(|error| error.to_string())
}

/// Any name, any case of the keywords, and any line ends give the same triangles.
#[test]
fn text_has_any_name() {
    let expected = read(&binary_stl()).unwrap();
    assert_eq!(expected.patches[0].triangles.len(), 12);
    let text = String::from_utf8(ascii_stl()).unwrap();
    let named =
        |name: &str| text.replace("solid gripper\n", &format!("solid{name}\n")).into_bytes();
    let mut cases: Vec<Vec<u8>> = [
        "",
        " ",
        " a b c",
        " facet",
        " solid",
        " facet normal 0 0 0",
        " Gr\u{fc}n",
        "\tx",
        " \u{feff}",
    ]
    .map(named)
    .to_vec();
    cases.extend([
        text.to_uppercase().into_bytes(),
        text.replace('\n', "\r\n").into_bytes(),
        text.replace('\n', "\r").into_bytes(),
        format!("\u{feff}{text}").into_bytes(),
        format!("\n  {text}\n\n").into_bytes(),
        text.replace("normal 0 0 0", "normal nan -nan(ind) 1.#QNAN").into_bytes(),
        // A name that is not UTF-8.
        text.replace("gripper", "~~")
            .bytes()
            .map(|it| if it == b'~' { 0xfc } else { it })
            .collect(),
        // Two solids.
        text.replacen("endfacet\n", "endfacet\nendsolid gripper\nsolid b\n", 1).into_bytes(),
    ]);
    for case in cases {
        let start = String::from_utf8_lossy(&case[..20]).into_owned();
        assert_eq!(read(&case).as_ref(), Ok(&expected), "{start:?}");
    }
}

#[test]
fn binary_files_have_any_header_and_trailing_bytes() {
    let whole = binary_stl();
    let expected = read(&whole).unwrap();
    for header in
        ["solid", "solid gripper", "SOLID a\nfacet normal 0 0 0", "\u{feff}solid", "COLOR="]
    {
        let mut file = whole.clone();
        file[..header.len()].copy_from_slice(header.as_bytes());
        assert_eq!(read(&file).as_ref(), Ok(&expected), "{header}");
        for trailing in [&b"\n"[..], b"\r\n", &[0; 50], &[7; 131]] {
            let file = [&file, trailing].concat();
            assert_eq!(read(&file).as_ref(), Ok(&expected), "{header}");
            assert!(ConvexHull::from_mesh("a.stl", &file, 1.0).is_ok());
        }
    }
}

#[test]
fn damaged_files_are_refused_with_the_line() {
    let text = String::from_utf8(ascii_stl()).unwrap();
    let cases = [
        (text.replacen("vertex", "corner", 1), "line 4: expected `vertex`, found `corner`"),
        (text.replacen("-40 ", "-40,5 ", 1), "line 4: expected a number, found `-40,5`"),
        (text.replacen("-40 ", "inf ", 1), "line 4: expected a number, found `inf`"),
        (
            text.replacen("endloop", "vertex 1 2 3\nendloop", 1),
            "line 7: expected `endloop`, found `vertex`",
        ),
        (text.replace("endsolid gripper\n", ""), "expected `facet` or `endsolid`, found the end"),
        (
            text[..text.find("endloop").unwrap()].to_owned(),
            "expected `endloop`, found the end of the file",
        ),
        (text.clone() + "vertex", "line 87: expected `solid`, found `vertex`"),
        (text.replacen("solid", "solidity", 1), "it is not text that begins with `solid`"),
        ("solid a\nendsolid a\n".to_owned(), "it has no triangles"),
        ("solid".to_owned(), "line 1: expected `facet` or `endsolid`, found the end of the file"),
    ];
    for (text, words) in cases {
        let error = read(text.as_bytes()).unwrap_err();
        assert!(error.contains(words), "{error}: {words}");
    }
    let mut zero = binary_stl();
    zero[80..84].fill(0);
    let error = read(&zero).unwrap_err();
    assert!(error.contains("its header states 0 triangles, and 600 bytes follow"), "{error}");
}

/// Text files of a scene may begin with the byte order mark of UTF-8. Places count from behind the
/// mark.
#[test]
fn scenes_may_begin_with_a_mark() {
    let text =
        r#"{ "version": 1, "obstacles": [], "tool": [{ "type": "mesh", "file": "a.obj" }] }"#;
    let obj = "\u{feff}v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 2 3\nf 1 2 4\n";
    let marked = format!("\u{feff}{text}");
    let scene = Scene::from_json_with(&marked, |_| Ok(obj.into())).unwrap();
    assert_eq!(scene.tool().len(), 1);
    let wrong = marked.replace("mesh", "mash");
    let error = Scene::from_json_with(&wrong, |_| Ok(obj.into())).unwrap_err();
    let read = wrong.trim_start_matches('\u{feff}');
    assert_eq!(&read[error.place().span.clone()], "\"mash\"");
}
