//! Included files, limits of requests, and interrupted planning.

use std::{fs, path::Path, sync::Arc, sync::atomic::AtomicBool};

use iiwa_plan::{Error, PlanOptions, PlanRequest, ProgramSource};
use iiwa_program::{Program, ProgramError};
use iiwa_traj::Timing;

const TEXT: &str = r#"{ "version": 1, "include": "cell.json", "tool": "gripper",
    "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
    "motions": [{ "type": "lin_rel", "offset": { "z_mm": -50 } }] }"#;

const CELL: &str = r#"{ "version": 1, "tools": { "gripper": { "tcp": { "z_mm": 120 } } } }"#;

#[test]
fn a_program_is_read_with_its_includes() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("program.json");
    fs::write(&file, format!("\u{feff}{TEXT}")).unwrap();
    let error = ProgramSource::load(&file).unwrap_err();
    assert!(matches!(error, Error::Program(ProgramError::Include { .. })), "{error}");
    assert_eq!(error.place().unwrap().line, 1);
    fs::write(folder.path().join("cell.json"), CELL).unwrap();
    let source = ProgramSource::load(&file).unwrap();
    assert_eq!(source.text.as_read(), TEXT);
    assert_eq!(Program::from_json(source.text.complete()).unwrap(), *source.program);
    ProgramSource::from_json(TEXT).unwrap_err();
}

#[test]
fn files_elsewhere_are_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let below = folder.path().join("below");
    fs::create_dir(&below).unwrap();
    fs::write(folder.path().join("cell.json"), CELL).unwrap();
    let text = TEXT.replace("cell.json", "../cell.json");
    let error = ProgramSource::beside(&below.join("program.json"), &text).unwrap_err();
    assert!(error.to_string().contains("beside the file that names it"), "{error}");
    let error = ProgramSource::load(Path::new("missing.json")).unwrap_err();
    assert!(matches!(error, Error::File { .. }), "{error}");
    assert!(error.place().is_none() && error.motion().is_none());
}

fn swing() -> ProgramSource {
    Program::from_deg([0.0; 7]).ptp_deg([60.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).build().into()
}

#[test]
fn limits_of_the_request_win() {
    let at = |request: &PlanRequest| request.plan(&swing()).unwrap().figures();
    let full = at(&PlanRequest::default());
    let slow = at(&PlanRequest { speed_override: Some(0.5), ..PlanRequest::default() });
    assert!((slow.motion_time_s - 2.0 * full.motion_time_s).abs() < 1e-9);
    assert_eq!(slow.override_percent, Some(50.0));
    let weak = at(&PlanRequest { torque_limit_rel: Some(0.5), ..PlanRequest::default() });
    assert_eq!(weak.limit_torque_percent, Some(50.0));
}

#[test]
fn sections_add_up_to_the_plan() {
    let text = include_str!("../../../../fixtures/waits-and-stops.json");
    let source = ProgramSource::from_json(text).unwrap();
    let plan = PlanRequest::default().plan(&source).unwrap();
    let mut planning = PlanRequest::default().begin(&source).unwrap();
    let count = planning.by_ref().map(Result::unwrap).count();
    assert_eq!(count, plan.trajectory.sections().len());
    assert_eq!(planning.progress(), 1.0);
    assert_eq!(planning.figures(), &plan.figures());
    let figures = planning.finish();
    assert_eq!(figures.warnings, plan.warnings(&figures));
    assert_eq!(figures, plan.figures());
}

#[test]
fn an_interrupt_differs_from_failures() {
    let stop = Arc::new(AtomicBool::new(true));
    let mut planning = PlanRequest::default().begin(&swing()).unwrap().interrupted_by(stop);
    let error = planning.next().unwrap().unwrap_err();
    assert!(error.is_interrupt() && error.place().is_none(), "{error}");
    let stop = Arc::new(AtomicBool::new(true));
    let error = PlanRequest::default().plan_with(&mut None, &swing(), &stop).unwrap_err();
    assert!(error.is_interrupt(), "{error}");
}

#[test]
fn a_reused_planner_follows_timing_and_stop_of_each_call() {
    let with = |timing| PlanRequest {
        options: PlanOptions::with_timing(timing),
        ..PlanRequest::default()
    };
    let (sunrise, jerk) = (with(Timing::default()), with(Timing::jerk_limited()));
    let (mut planner, source) = (None, swing());
    let mut cycle_time_s = |request: &PlanRequest, stop: bool| {
        let stop = Arc::new(AtomicBool::new(stop));
        let plan = request.plan_with(&mut planner, &source, &stop);
        plan.map(|plan| plan.trajectory.cycle_time_s())
    };
    let expected_s =
        [&sunrise, &jerk].map(|request| request.plan(&swing()).unwrap().trajectory.cycle_time_s());
    assert_ne!(expected_s[0], expected_s[1]);
    assert_eq!(cycle_time_s(&sunrise, false).unwrap(), expected_s[0]);
    assert_eq!(cycle_time_s(&jerk, false).unwrap(), expected_s[1]);
    assert!(cycle_time_s(&jerk, true).unwrap_err().is_interrupt());
    assert_eq!(cycle_time_s(&jerk, false).unwrap(), expected_s[1]);
    assert_eq!(cycle_time_s(&sunrise, false).unwrap(), expected_s[0]);
}

/// Missing meshes are reported up to the maximum number of errors.
#[test]
fn errors_of_meshes_are_bounded() {
    let load = |file: usize| {
        format!(
            r#"{{ "type": "load", "load": {{ "mass_kg": 1, "shapes":
                [{{ "type": "mesh", "file": "{file}.stl" }}] }} }}"#
        )
    };
    let loads: Vec<_> = (0..2 * iiwa_program::MAX_ERRORS).map(load).collect();
    let text = format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }},
            "motions": [{}] }}"#,
        loads.join(", ")
    );
    let error = ProgramSource::from_json(&text).unwrap_err();
    assert_eq!(error.errors().len(), iiwa_program::MAX_ERRORS);
}

/// A program with a mesh: its stored text contains the file, and reads back without it.
#[test]
fn meshes_are_read_beside_the_program_and_stored_with_it() {
    let text = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
        "motions": [{ "type": "load", "load": { "mass_kg": 1, "shapes":
            [{ "type": "mesh", "file": "parts/wedge.obj" }] } },
            { "type": "wait", "seconds": 1 }] }"#;
    let wedge = "v 0 0 0\nv 60 0 0\nv 0 40 0\nv 0 0 20\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("program.json");
    let error = ProgramSource::beside(&path, text).unwrap_err();
    let message = "motion 1: shape 1 of the load: `parts/wedge.obj`: no such file: ";
    assert!(error.to_string().starts_with(message), "{error}");
    assert_eq!(&text[error.place().unwrap().span.clone()], "\"parts/wedge.obj\"");
    let error = ProgramSource::from_json(text).unwrap_err();
    assert!(error.to_string().contains("only the text of the program is available"), "{error}");
    let error = ProgramSource::beside(Path::new("-"), text).unwrap_err();
    assert!(error.to_string().contains("read from standard input"), "{error}");
    let error = ProgramSource::beside(&path, &text.replace("parts/", "../")).unwrap_err();
    assert!(error.to_string().contains("beside the program or in a folder below it"), "{error}");

    fs::create_dir(folder.path().join("parts")).unwrap();
    fs::write(folder.path().join("parts/wedge.obj"), wedge).unwrap();
    let source = ProgramSource::beside(&path, text).unwrap();
    assert_eq!(source.mesh("parts/wedge.obj").unwrap(), wedge.as_bytes());
    let stored = ProgramSource::from_json(source.text.complete()).unwrap();
    assert_eq!(stored.text.complete(), source.text.complete());
    let shapes = stored.program.carried_shapes();
    let iiwa_program::LoadShape::Mesh { file, .. } = &shapes[0].workpiece.shapes[0] else {
        panic!("{shapes:?}")
    };
    assert!(file.starts_with("data:model/obj;base64,"), "{file}");
    assert_eq!(stored.mesh(file).unwrap(), wedge.as_bytes());
    let damaged = source.text.complete().replace(";base64,", ";base64,!");
    let error = ProgramSource::from_json(&damaged).unwrap_err();
    assert!(error.to_string().contains("not base64"), "{error}");

    // In a repeat block, the file is stored once.
    let (head, tail) = text.split_once("\"motions\": [").unwrap();
    let block = r#""motions": [{ "type": "repeat", "count": 3, "motions": ["#;
    let repeated = format!("{head}{block}{tail}").replace("1 }] }", "1 }] }] }");
    let repeated = ProgramSource::beside(&path, &repeated).unwrap();
    assert_eq!(repeated.text.complete().matches("data:model/obj").count(), 1);
    let stored = ProgramSource::from_json(repeated.text.complete()).unwrap();
    assert_eq!(stored.program.motions.len(), 6);
    assert_eq!(stored.program.motions[0], stored.program.motions[4]);
    assert_eq!(stored.mesh(file).unwrap(), wedge.as_bytes());

    // The files of all shapes together are limited, also if they are the same.
    fs::write(folder.path().join("parts/large.obj"), vec![b'#'; 10_100_000]).unwrap();
    let shape = r#"{ "type": "mesh", "file": "parts/large.obj" }"#;
    let [one, two] = [shape.to_owned(), format!("{shape}, {shape}")]
        .map(|shapes| text.replace(r#"{ "type": "mesh", "file": "parts/wedge.obj" }"#, &shapes));
    assert!(ProgramSource::beside(&path, &one).is_ok());
    let error = ProgramSource::beside(&path, &two).unwrap_err();
    let message = "motion 1: shape 2 of the load: `parts/large.obj`: the mesh files of all shapes";
    assert!(error.to_string().starts_with(message), "{error}");
    assert_eq!(error.place().unwrap().span.start, two.rfind("\"parts/large.obj").unwrap());
    let large = fs::File::create(folder.path().join("parts/large.obj")).unwrap();
    large.set_len(3_000_000_000).unwrap();
    let error = ProgramSource::beside(&path, &one).unwrap_err();
    assert!(error.to_string().contains("more than 20000000 bytes"), "{error}");
}
