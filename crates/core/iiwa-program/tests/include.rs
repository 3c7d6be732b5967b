//! Programs that include a file of tools, bases and frames.

use iiwa_program::{Program, ProgramError, Workcell};

use crate::documents::{CELL, PROGRAM, bad_cells};

fn read(text: &str, file: &str) -> Result<Program, ProgramError> {
    Program::from_json_with(text, |name| {
        assert_eq!(name, "cell.json");
        Ok(file.to_owned())
    })
}

#[test]
fn the_program_overrides_names_of_the_included_file() {
    let program = read(PROGRAM, CELL).unwrap();
    let cell = Workcell::from_json(CELL).unwrap();
    let workcell = &program.workcell;
    assert_eq!(workcell.tools["gripper"].tcp.xyz_mm[2], 130.0);
    // A tool is replaced as a whole, payload included.
    assert_eq!(workcell.tools["gripper"].load, None);
    assert_eq!(workcell.tools["probe"], cell.tools["probe"]);
    assert_eq!(
        (workcell.tool.as_deref(), workcell.base.as_deref()),
        (Some("gripper"), Some("tray"))
    );
    assert_eq!(workcell.frames, cell.frames);
    // Included frames follow the program's base of the same name.
    let table = workcell.base(Some("table")).unwrap();
    let tray = workcell.base(None).unwrap();
    assert_eq!(table.position_m, [0.48, 0.0, 0.0]);
    assert_eq!(tray.position_m, [0.48, 0.04, 0.0]);
}

#[test]
fn a_text_alone_has_nothing_to_include() {
    let error = Program::from_json(PROGRAM).unwrap_err();
    assert!(matches!(&error, ProgramError::Include { name, .. } if name == "cell.json"));
    assert_eq!((error.place().line, error.place().column), (3, 14));
    assert!(error.to_string().contains("`cell.json`"), "{error}");
    let none = PROGRAM.replace("\"cell.json\"", "null");
    assert!(Program::from_json(&none).is_ok());
}

#[test]
fn a_file_that_cannot_be_read_is_refused_where_it_is_named() {
    let error = Program::from_json_with(PROGRAM, |_| Err("no such file".to_owned())).unwrap_err();
    assert_eq!(error.to_string(), "cannot include `cell.json`: no such file, at line 3, column 14");
    assert_eq!(error.message(), "cannot include `cell.json`: no such file");
}

#[test]
fn errors_within_the_file_have_their_places_there() {
    for (from, to, place, message) in [
        ("\"z_mm\": 300", "\"z_mm\": \"300\"", (4, 42), "expected a number"),
        ("\"version\": 1", "\"version\": 2", (2, 14), "these are frames of version 2; version 1"),
        ("\"e1_deg\": 5", "\"e1_rad\": 5, \"e1_deg\": 5", (7, 13), "`pick`: give either `e1_deg`"),
        ("\"status\": 2", "\"status\": 8", (7, 13), "status is 8"),
        (
            "\"frames\"",
            "\"include\": \"other.json\", \"frames\"",
            (6, 14),
            "cannot include other files",
        ),
        ("\"frames\"", "\"tool\": \"gripper\", \"frames\"", (6, 3), "unknown key `tool`"),
        ("\"place\": {", "\"place\": { \"speed\": 1,", (9, 16), "unknown key `speed`"),
        ("\n  }\n}", "\n  }\n", (12, 1), "the text ends too early"),
    ] {
        let file = CELL.replacen(from, to, 1);
        assert_ne!(file, CELL);
        match read(PROGRAM, &file) {
            Err(ProgramError::Included { name, text, error, place: include_place }) => {
                let actual = (error.place().line, error.place().column);
                assert_eq!((name.as_str(), &text), ("cell.json", &file));
                assert_eq!((include_place.line, include_place.column), (3, 14));
                assert!(error.message().contains(message), "{message}: {error}");
                if message != "the text ends too early" {
                    assert_eq!(actual, place, "{message}: {error}");
                }
            }
            other => unreachable!("{message}: {other:?}"),
        }
    }
}

#[test]
fn one_text_of_both_needs_no_file() {
    let merged = Program::merged_json(PROGRAM, CELL).unwrap();
    assert_eq!(Program::from_json(&merged).unwrap(), read(PROGRAM, CELL).unwrap());
    // The motions keep their original text.
    for written in ["0.30", "250.0", "\"e1_deg\": 5"] {
        assert!(merged.contains(written), "{merged}");
    }
    assert!(!merged.contains("include"), "{merged}");
    let bare = r#"{ "version": 1 }"#;
    let alone = Program::merged_json(PROGRAM, bare).unwrap();
    assert!(Program::from_json(&alone).unwrap().workcell.frames.is_empty());
    assert!(Program::merged_json(PROGRAM, "[]").is_err());
}

#[test]
fn written_files_are_read_back() {
    let cell = Workcell::from_json(CELL).unwrap();
    let text = cell.to_json();
    assert_eq!(Workcell::from_json(&text).unwrap(), cell);
    assert_eq!(Workcell::from_json(&Workcell::default().to_json()).unwrap(), Workcell::default());
}

#[test]
fn wrong_files_are_refused() {
    for bad in bad_cells() {
        assert!(Workcell::from_json(&bad.to_string()).is_err(), "the reader takes {bad}");
    }
}
