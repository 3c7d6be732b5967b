//! Included files, limits of requests, and interrupted planning.

use std::{fs, path::Path, sync::Arc, sync::atomic::AtomicBool};

use iiwa_plan::{Error, PlanRequest, ProgramSource};
use iiwa_program::{Program, ProgramError};

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
    let (figures, warnings) = planning.finish();
    assert_eq!(warnings, plan.warnings(&figures));
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
