//! Projects as folders and as texts.

#![expect(clippy::expect_used, reason = "a test fails by it")]

use std::{fs, path::Path};

use iiwa_sunrise::{Project, ProjectData, ProjectError, SourceFault, SourceFile};

fn write(root: &Path, name: &str, contents: impl AsRef<[u8]>) {
    let path = root.join(name);
    fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    fs::write(path, contents).expect("a file");
}

fn paths(project: &Project) -> Vec<&str> {
    project.files().iter().map(SourceFile::path).collect()
}

#[test]
fn the_files_of_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    for name in ["src/b/B.java", "src/a/A.java", "Z.java", "lib/deep/er/C.java"] {
        write(root, name, "class X { }");
    }
    for name in [
        "bin/A.java",
        "src/target/A.java",
        ".metadata/A.java",
        "src/A.class",
        "src/java",
        "A.java.txt",
    ] {
        write(root, name, "none of Java");
    }
    let project = Project::open(root).unwrap();
    assert_eq!(paths(&project), ["Z.java", "lib/deep/er/C.java", "src/a/A.java", "src/b/B.java"]);
    assert!(project.files().iter().all(|file| file.error().is_none()));
    assert_eq!(*project.data(), ProjectData::Absent);
}

#[cfg(unix)]
#[test]
fn links_that_lead_around() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    write(root, "src/A.java", "class A { }");
    std::os::unix::fs::symlink(root, root.join("src/again")).unwrap();
    std::os::unix::fs::symlink(root.join("nowhere"), root.join("src/nothing")).unwrap();
    std::os::unix::fs::symlink(root.join("nowhere"), root.join("src/Nothing.java")).unwrap();
    let project = Project::open(root).unwrap();
    assert_eq!(paths(&project), ["src/A.java", "src/Nothing.java"]);
    let error = project.files()[1].error().unwrap();
    assert!(matches!(error.fault, SourceFault::Unreadable(_)), "{error}");
}

#[test]
fn a_folder_that_is_none() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "A.java", "class A { }");
    for name in ["none", "A.java"] {
        let error = Project::open(&folder.path().join(name)).unwrap_err();
        assert!(matches!(error, ProjectError::Folder { .. }), "{error}");
    }
    fs::create_dir(folder.path().join("empty")).unwrap();
    assert!(Project::open(&folder.path().join("empty")).unwrap().files().is_empty());
}

#[test]
fn the_data_file() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    let with_data = |path: &str, text: &str| ProjectData::Found {
        path: path.to_owned(),
        text: text.to_owned(),
    };
    write(root, "station/src/A.java", "class A { }");
    write(root, "RoboticsAPI.data.xml", "<around/>");
    let station = root.join("station");
    let data = |folder: &Path| Project::open(folder).unwrap().data().clone();
    assert_eq!(data(&station), with_data("../RoboticsAPI.data.xml", "<around/>"));
    write(root, "station/src/RoboticsAPI.data.xml", "\u{feff}<below/>");
    assert_eq!(data(&station), with_data("src/RoboticsAPI.data.xml", "<below/>"));
    write(root, "station/bin/RoboticsAPI.data.xml", "<built/>");
    assert_eq!(data(&station), with_data("src/RoboticsAPI.data.xml", "<below/>"));
    write(root, "station/other/RoboticsAPI.data.xml", "<other/>");
    let both = ["other/RoboticsAPI.data.xml", "src/RoboticsAPI.data.xml"].map(str::to_owned);
    assert_eq!(data(&station), ProjectData::Several(both.to_vec()));
    write(root, "station/RoboticsAPI.data.xml", "<here/>");
    assert_eq!(data(&station), with_data("RoboticsAPI.data.xml", "<here/>"));
}

#[test]
fn a_project_of_texts() {
    let files = [
        ("src/A.java", "class A { }"),
        ("src/B.java", "class B {"),
        ("RoboticsAPI.data.xml", "<xml/>"),
    ];
    let project = Project::from_texts(files).unwrap();
    assert_eq!(paths(&project), ["src/A.java", "src/B.java"]);
    assert!(project.files()[0].error().is_none());
    let error = project.files()[1].error().unwrap();
    assert_eq!(error.to_string(), "src/B.java:1:9: this `{` is not closed: `}` is expected");
    assert!(matches!(project.data(), ProjectData::Found { text, .. } if text == "<xml/>"));
}

/// Returns the place of a file's error.
fn place(contents: &[u8]) -> (u32, u32) {
    let project = Project::from_texts([("A.java", contents)]).expect("a project");
    let error = project.files()[0].error().expect("an error");
    (error.line, error.column)
}

#[test]
fn encodings() {
    // An umlaut before the error is one column in any encoding.
    let text = "class A { // \u{fc}\nString a = \"\u{e4}\u{2013}\" b;\n}";
    let expected = (2, 16);
    assert_eq!(place(text.as_bytes()), expected);
    assert_eq!(place(format!("\u{feff}{text}").as_bytes()), expected);
    let western = b"class A { // \xfc\r\nString a = \"\xe4\x96\" b;\r\n}";
    assert_eq!(place(western), expected);
    let units = |bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
        format!("\u{feff}{text}").encode_utf16().flat_map(bytes).collect()
    };
    assert_eq!(place(&units(u16::to_le_bytes)), expected);
    assert_eq!(place(&units(u16::to_be_bytes)), expected);
    assert_eq!(place(b"class A { \r// \xfc\rint a b;\r}"), (3, 6));
    for whole in
        [&b""[..], b"\xef\xbb\xbf", b"\xff\xfe", b"// \xfc", b"\xef\xbb\xbf/* all of it */"]
    {
        let project = Project::from_texts([("A.java", whole)]).unwrap();
        assert!(project.files()[0].error().is_none(), "{whole:?}");
    }
}

#[test]
fn binary_files_are_rejected() {
    let project = Project::from_texts([("A.java", b"class A {\n \0 }")]).unwrap();
    let error = project.files()[0].error().unwrap();
    assert_eq!((error.line, error.column, &error.fault), (2, 2, &SourceFault::Binary));
}

#[test]
fn bounds() {
    let large = vec![b' '; 10_000_001];
    let project =
        Project::from_texts([("A.java", &large), ("B.java", &b"class B { }".to_vec())]).unwrap();
    let error = project.files()[0].error().unwrap();
    assert_eq!(error.fault, SourceFault::TooLarge { bytes: 10_000_001, max_bytes: 10_000_000 });
    assert!(project.files()[1].error().is_none());
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "A.java", &large);
    let opened = Project::open(folder.path()).unwrap();
    assert_eq!(opened.files()[0].error(), project.files()[0].error());

    let blank = &large[..10_000_000];
    let files = (0..11).map(|number| (format!("{number}.java"), blank));
    assert!(matches!(Project::from_texts(files), Err(ProjectError::TooLarge { .. })));
    let files = (0..10_001).map(|number| (format!("{number}.java"), ""));
    assert!(matches!(
        Project::from_texts(files),
        Err(ProjectError::TooManyFiles { max_files: 10_000 })
    ));
}

#[test]
fn a_program_of_this_repository() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../sunrise");
    let project = Project::open(&folder).unwrap();
    assert!(project.files().len() > 50, "{} files", project.files().len());
    for file in project.files() {
        assert_eq!(file.error(), None);
    }
}
