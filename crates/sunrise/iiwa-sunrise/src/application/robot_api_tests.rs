//! Applications as API calls, and the resulting programs.

use std::rc::Rc;

use iiwa_java::{EvaluationStop, JavaObject, Value};
use iiwa_kin::{Joints, Robot};
use iiwa_program::{Blend, Course, LimitKind, Motion, Program, Ptp, TargetRef};

use crate::application::{
    frames_api::transformation_static,
    robot_value::{RobotValue, robot},
    robotics::Robotics,
    spot::Spot,
    station::{Station, StationSetup},
    test_station::{doubles, flange, lbr, machine, reason, texts},
};

const READY: Joints = [0.0, 0.5, 0.0, -1.4, 0.0, 1.2, 0.0];

fn finished(machine: &mut Robotics<'static>) -> (Program, Vec<u32>) {
    let idle = Station::new(StationSetup::default());
    let (program, places, _) = std::mem::replace(machine.station, idle).finish();
    let lines = places.iter().map(|place| place.line).collect();
    // The output must be a readable program.
    let again = Program::from_json(&program.to_json()).map(|again| again.motions.len());
    assert_eq!(again.ok(), Some(program.motions.len()));
    (program, lines)
}

fn ready(machine: &mut Robotics<'static>) -> Result<(), EvaluationStop> {
    let (lbr, motion) = (lbr(), machine.motion("ptp", &doubles(&READY))?);
    machine.on(&lbr, "move", &[motion])?;
    Ok(())
}

fn gripper(machine: &mut Robotics<'static>) -> Result<Value, EvaluationStop> {
    let (gripper, flange) = (machine.injected_body("Gripper", false), flange());
    machine.on(&gripper, "attachTo", &[flange])?;
    Ok(gripper)
}

fn course(program: &Program, index: usize) -> Option<&Course> {
    match program.motions.get(index)? {
        Motion::Cartesian(cartesian) => Some(&cartesian.course),
        _ => None,
    }
}

#[test]
fn joints_and_their_limits() -> Result<(), EvaluationStop> {
    let mut machine = machine("");
    let motion = machine.motion("ptp", &doubles(&READY))?;
    let motion = machine.on(&motion, "setJointVelocityRel", &doubles(&[0.25]))?;
    let motion = machine.on(&motion, "setBlendingCart", &doubles(&[30.0]))?;
    let lbr = lbr();
    machine.on(&lbr, "moveAsync", std::slice::from_ref(&motion))?;
    let home = machine.motion("ptpHome", &[])?;
    machine.on(&lbr, "move", &[home])?;
    let (program, lines) = finished(&mut machine);
    let expected = Ptp::to(READY).velocity(0.25).blend(Blend::CartMm(30.0));
    assert_eq!(program.motions, [Motion::Ptp(expected), Motion::Ptp(Ptp::to([0.0; 7]).blocking())]);
    assert_eq!(lines, [4, 5]);
    Ok(())
}

#[test]
fn frames_of_the_tree_keep_their_names() -> Result<(), EvaluationStop> {
    let mut machine = machine("");
    ready(&mut machine)?;
    let pick = machine.frame("/Table/Pick")?;
    let motion = machine.motion("ptp", std::slice::from_ref(&pick))?;
    let lbr = lbr();
    machine.on(&lbr, "move", &[motion])?;
    let table = machine.frame("/Table")?;
    let mut offset = doubles(&[10.0, 0.0, 0.0]);
    offset.push(table);
    let motion = machine.motion("linRel", &offset)?;
    machine.on(&lbr, "move", &[motion])?;
    let at_rad = machine.station.at_rad;
    let (program, _) = finished(&mut machine);
    assert_eq!(course(&program, 1), Some(&Course::Ptp { to: "Table/Pick".into() }));
    let base = match course(&program, 2) {
        Some(Course::LinRel { within: Some(TargetRef::Given(within)), .. }) => {
            within.base.as_deref()
        }
        _ => None,
    };
    assert_eq!(base, Some("Table"));
    assert_eq!(program.workcell.frames.keys().collect::<Vec<_>>(), ["Table/Pick"]);
    assert_eq!(program.workcell.bases.keys().collect::<Vec<_>>(), ["Table"]);
    // A frame keeps its E1; an offset keeps the E1 of its start.
    assert!((at_rad[2] - 0.1).abs() < 1e-12);
    let tip = Robot::default().flange_pose(&at_rad).position_m;
    assert!((tip[0] - 0.5101).abs() < 1e-9 && (tip[1] + 0.05).abs() < 1e-9, "{tip:?}");
    Ok(())
}

#[test]
fn computed_frames_are_in_the_robots_foot() -> Result<(), EvaluationStop> {
    let mut machine = machine("");
    ready(&mut machine)?;
    let pick = machine.frame("/Table/Pick")?;
    let copy = machine.on(&pick, "copyWithRedundancy", &[])?;
    machine.on(&copy, "setZ", &doubles(&[210.5]))?;
    let z = machine.on(&pick, "getZ", &[])?;
    assert_eq!(z.number(), Some(200.0));
    let lin = machine.motion("lin", std::slice::from_ref(&copy))?;
    let lbr = lbr();
    machine.on(&lbr, "move", &[lin])?;
    let plain = machine.on(&pick, "copy", &[])?;
    let lin = machine.motion("lin", &[plain])?;
    machine.on(&lbr, "move", &[lin])?;
    let (program, _) = finished(&mut machine);
    let target = |index| match course(&program, index) {
        Some(Course::Lin { to: TargetRef::Given(target) }) => Some(target.clone()),
        _ => None,
    };
    let with = target(1);
    assert_eq!(with.as_ref().map(|target| target.frame.xyz_mm), Some([500.1, -50.0, 310.5]));
    assert_eq!(with.as_ref().and_then(|target| target.base.as_deref()), Some("robot"));
    assert_eq!(with.and_then(|target| target.e1_rad), Some(0.1));
    assert_eq!(target(2).and_then(|target| target.e1_rad), None);
    assert!(program.workcell.frames.is_empty() && program.workcell.bases.is_empty());
    Ok(())
}

#[test]
fn a_frame_rotates_about_its_axes() -> Result<(), EvaluationStop> {
    let mut machine = machine("");
    let frame = machine.new_frame(&doubles(&[500.0, 0.0, 400.0, 0.0, 0.0, std::f64::consts::PI]));
    let down = transformation_static("ofDeg", &doubles(&[0.0, 0.0, 50.0, 0.0, 0.0, 0.0]));
    machine.on(&frame, "transform", &[down.unwrap_or(Value::Null)])?;
    let z = machine.on(&frame, "getZ", &[])?.number().unwrap_or_default();
    assert!((z - 350.0).abs() < 1e-12, "{z}");
    let other = machine.new_frame(&doubles(&[500.0, 30.0, 390.0, 0.0, 0.0, 0.0]));
    let distance = machine.on(&frame, "distanceTo", &[other])?.number().unwrap_or_default();
    assert!((distance - 50.0).abs() < 1e-9, "{distance}");
    Ok(())
}

#[test]
fn tools_and_workpieces_change_the_load() -> Result<(), EvaluationStop> {
    let mut machine = machine("");
    let gripper = gripper(&mut machine)?;
    ready(&mut machine)?;
    let tip = machine.on(&gripper, "getFrame", &texts(&["/Tip"]))?;
    let data = machine.robot_injected("IApplicationData", None, "data")?.unwrap_or(Value::Null);
    let part = machine.on(&data, "createFromTemplate", &texts(&["Box"]))?;
    machine.on(&part, "attachTo", std::slice::from_ref(&tip))?;
    let attached_at = machine.place.line;
    let pick = machine.frame("Table/Pick")?;
    for mover in [&tip, &part, &flange()] {
        let motion = machine.motion("ptp", std::slice::from_ref(&pick))?;
        machine.on(mover, "move", &[motion])?;
    }
    machine.on(&part, "detach", &[])?;
    ready(&mut machine)?;
    let (program, lines) = finished(&mut machine);
    assert_eq!(program.workcell.tool.as_deref(), Some("Gripper"));
    let masses: Vec<f64> =
        program.loads().iter().map(|load| load.map_or(0.0, |load| load.mass_kg)).collect();
    assert_eq!(masses, [1.5, 2.0, 2.0, 2.0, 2.0, 1.5, 1.5]);
    assert_eq!(lines[1], attached_at);
    let Some(Motion::Load(Some(load))) = program.motions.get(1) else {
        return Err(EvaluationStop::Refused(Box::new(iiwa_java::JavaRefusal {
            reason: "no load".to_owned(),
            place: iiwa_java::SourceLine { file: "".into(), line: 0 },
        })));
    };
    // Loads of 1.5 kg at 50 mm and 0.5 kg at 160 mm.
    assert!((load.load.center_mm[2] - 77.5).abs() < 1e-9);
    let tools: Vec<Option<&str>> = program
        .motions
        .iter()
        .filter_map(|motion| match motion {
            Motion::Cartesian(cartesian) => Some(cartesian.tool.as_deref()),
            _ => None,
        })
        .collect();
    // The tip belongs to the program's tool; the workpiece is a composed tool.
    assert_eq!(tools, [None, Some("Box"), Some("flange")]);
    assert_eq!(program.workcell.tools["Box"].tips["Edge"].xyz_mm, [30.0, 0.0, 170.0]);
    Ok(())
}

#[test]
fn a_batch_passes_settings_to_its_members() -> Result<(), EvaluationStop> {
    let mut machine = machine("");
    ready(&mut machine)?;
    let down = machine.motion("linRel", &doubles(&[0.0, 0.0, 20.0]))?;
    let up = machine.motion("linRel", &doubles(&[0.0, 0.0, -20.0]))?;
    let up = machine.on(&up, "setCartVelocity", &doubles(&[40.0]))?;
    let batch = machine.motion("batch", &[down, up])?;
    let batch = machine.on(&batch, "setCartVelocity", &doubles(&[90.0]))?;
    let batch = machine.on(&batch, "setBlendingCart", &doubles(&[10.0]))?;
    let lbr = lbr();
    machine.on(&lbr, "move", &[batch])?;
    let (program, _) = finished(&mut machine);
    let actual: Vec<(f64, Option<f64>)> = program
        .motions
        .iter()
        .filter_map(|motion| match motion {
            Motion::Cartesian(cartesian) => {
                let blend = cartesian.blend.and_then(|blend| blend.cart_mm);
                Some((cartesian.tool_limits.way[LimitKind::Velocity], blend))
            }
            _ => None,
        })
        .collect();
    assert_eq!(actual, [(0.09, Some(10.0)), (0.04, None)]);
    Ok(())
}

#[test]
fn waits_overlap_running_motions() -> Result<(), EvaluationStop> {
    let mut machine = machine("");
    let lbr = lbr();
    machine.robot_static("ThreadUtil", "milliSleep", &[Value::Int(700)])?;
    let motion = machine.motion("ptp", &doubles(&READY))?;
    let sent = machine.on(&lbr, "moveAsync", &[motion])?;
    machine.robot_static("Thread", "sleep", &[Value::Long(250)])?;
    machine.on(&sent, "await", &[])?;
    let second = machine.robot_constant("TimeUnit", "SECONDS")?.unwrap_or(Value::Null);
    machine.on(&second, "sleep", &[Value::Int(2)])?;
    let (program, _) = finished(&mut machine);
    let waits: Vec<&Motion> = program.motions.iter().filter(|motion| !motion.moves()).collect();
    let wait = |seconds, overlap| Motion::Wait { seconds, overlap };
    assert_eq!(waits, [&wait(0.7, 0), &wait(0.25, 1), &wait(2.0, 0)]);
    Ok(())
}

#[test]
fn waits_for_conditions_take_time() -> Result<(), EvaluationStop> {
    // The call after the motion to the start.
    let place = "Job.java:3";
    let arguments = |machine: &mut Robotics<'static>| -> Result<Vec<Value>, EvaluationStop> {
        let second = machine.robot_constant("TimeUnit", "SECONDS")?.unwrap_or(Value::Null);
        Ok(vec![robot(RobotValue::opaque("ICondition")), Value::Int(5), second])
    };
    let manager = || robot(RobotValue::opaque("IObserverManager"));
    let fired = |answer: bool| format!("[fired]\n\"{place}\" = {answer}\n");
    let time = format!("[times]\n\"{place}\" = 1.5\n");
    let note = "a wait for a condition, of at most 5 s: its time is not in the plan";
    for (answers, waits, noted) in [
        (fired(false), vec![5.0], None),
        (fired(true), vec![], Some(note)),
        (fired(true) + &time, vec![1.5], None),
        (time.clone(), vec![1.5], None),
        (String::new(), vec![], Some(note)),
    ] {
        let mut machine = machine(&answers);
        ready(&mut machine)?;
        let arguments = arguments(&mut machine)?;
        let answer = machine.on(&manager(), "waitFor", &arguments)?;
        assert_eq!(matches!(answer, Value::Unknown(_)), !answers.contains("fired"), "{answers}");
        let is_noted = machine.notes.iter().any(|it| it.text.contains(note));
        assert_eq!(is_noted, noted.is_some(), "{answers}: {:?}", machine.notes);
        let (program, _) = finished(&mut machine);
        let actual: Vec<f64> = program
            .motions
            .iter()
            .filter_map(|motion| match motion {
                Motion::Wait { seconds, .. } => Some(*seconds),
                _ => None,
            })
            .collect();
        assert_eq!(actual, waits, "{answers}");
    }
    // Longer than the time limit.
    let mut machine = machine(&time.replace("1.5", "5.5"));
    ready(&mut machine)?;
    let arguments = arguments(&mut machine)?;
    assert!(machine.on(&manager(), "waitFor", &arguments).is_err());
    // Without a time limit, and with a time.
    let mut machine = self::machine(&time);
    ready(&mut machine)?;
    machine.on(&manager(), "waitFor", &arguments[..1])?;
    let (program, _) = finished(&mut machine);
    assert_eq!(program.motions[1], Motion::Wait { seconds: 1.5, overlap: 0 });
    Ok(())
}

#[test]
fn questions_are_answered_and_recorded() -> Result<(), EvaluationStop> {
    let answers = "[answers]\n\"part\" = [1, 0]\n[inputs]\n\"Belt.Lane\" = 2\n[data]\ncount = 7\n";
    let mut machine = machine(answers);
    let ui = machine.robot_injected("IApplicationUI", None, "ui")?.unwrap_or(Value::Null);
    for expected in [1, 0, 0] {
        let mut arguments = texts(&["QUESTION", "Which part?", "A", "B"]);
        let answer = machine.on(&ui, "displayModalDialog", &arguments)?;
        assert_eq!(answer.integer(), Some(expected));
        arguments.truncate(3);
    }
    let data = machine.robot_injected("IApplicationData", None, "data")?.unwrap_or(Value::Null);
    for (id, expected) in [("velocity", 0.25), ("count", 7.0)] {
        let value = machine.on(&data, "getProcessData", &texts(&[id]))?;
        assert_eq!(machine.on(&value, "getValue", &[])?.number(), Some(expected));
    }
    let belt = machine.robot_injected("BeltIOGroup", None, "belt")?.unwrap_or(Value::Null);
    assert_eq!(machine.on(&belt, "getLane", &[])?.integer(), Some(2));
    let absent = machine.on(&belt, "getHeight", &[])?;
    let why = absent.unknown().map(|unknown| unknown.reason.clone()).unwrap_or_default();
    assert!(why.contains("`Belt.Height`"), "{why}");
    machine.on(&belt, "setGate", &[Value::Boolean(true)])?;
    assert!(matches!(machine.on(&belt, "getGate", &[])?, Value::Boolean(true)));
    let given: Vec<bool> =
        machine.station.questions.iter().map(|question| question.is_given).collect();
    assert_eq!(given, [true, true, true, false, true, true]);
    Ok(())
}

#[test]
fn unsupported_motions_are_rejected_by_name() -> Result<(), EvaluationStop> {
    let mut machine = machine("");
    ready(&mut machine)?;
    let lbr = lbr();
    for (class, arguments) in [("SmartServo", doubles(&READY)), ("SplineJP", Vec::new())] {
        let motion = machine.robot_new(class, &arguments)?.unwrap_or(Value::Null);
        let why = reason(machine.on(&lbr, "moveAsync", &[motion]));
        assert!(why.contains(class), "{why}");
    }
    let motion = machine.motion("handGuiding", &[])?;
    let why = reason(machine.on(&lbr, "move", &[motion]));
    assert!(why.contains("`handGuiding`"), "{why}");
    let hold = machine.motion("positionHold", &[Value::Null, Value::Int(3), Value::Null])?;
    let why = reason(machine.on(&lbr, "move", &[hold]));
    assert!(why.contains("the time of this hold"), "{why}");
    let motion = machine.motion("ptp", &doubles(&READY))?;
    let overlay = machine.robot_new("FRIJointOverlay", &[])?.unwrap_or(Value::Null);
    let motion = machine.on(&motion, "addMotionOverlay", &[overlay])?;
    let why = reason(machine.on(&lbr, "move", &[motion]));
    assert!(why.contains("FRI"), "{why}");
    Ok(())
}

#[test]
fn unknown_names_are_rejected_with_the_nearest_name() {
    let mut machine = machine("");
    let why = reason(machine.frame("/Table/Pock"));
    assert!(why.contains("`/Table/Pock`") && why.contains("`/Table/Pick`"), "{why}");
    let why = reason(machine.body_of_template(&Value::text("Griper")));
    assert!(why.contains("`Gripper`"), "{why}");
}

#[test]
fn unreachable_frames_are_rejected_with_the_distance() -> Result<(), EvaluationStop> {
    let mut machine = machine("");
    let (lbr, shelf) = (lbr(), machine.frame("/Shelf")?);
    let motion = machine.motion("ptp", &[shelf])?;
    let why = reason(machine.on(&lbr, "move", &[motion]));
    assert!(why.contains("`Shelf`") && why.contains("mm too short"), "{why}");
    Ok(())
}

#[test]
fn unknown_values_affect_only_their_uses() -> Result<(), EvaluationStop> {
    let mut machine = machine("");
    ready(&mut machine)?;
    let lbr = lbr();
    let force = machine.on(&lbr, "getExternalForceTorque", &[flange()])?;
    let pick = machine.frame("/Table/Pick")?;
    let copy = machine.on(&pick, "copy", &[])?;
    machine.on(&copy, "setX", std::slice::from_ref(&force))?;
    let motion = machine.motion("lin", &[copy])?;
    let why = reason(machine.on(&lbr, "move", &[motion]));
    assert_eq!(why, "the target of this motion depends on a measured force (src/Job.java:3)");
    let motion = machine.motion("ptp", &doubles(&READY))?;
    machine.on(&motion, "setJointVelocityRel", &[force])?;
    let why = reason(machine.on(&lbr, "move", &[motion]));
    assert!(why.starts_with("the argument of `setJointVelocityRel`"), "{why}");
    Ok(())
}

#[test]
fn a_velocity_of_0_throws_as_on_the_controller() -> Result<(), EvaluationStop> {
    let mut machine = machine("");
    let motion = machine.motion("ptp", &doubles(&READY))?;
    let why = reason(machine.on(&motion, "setJointVelocityRel", &doubles(&[0.0])));
    assert!(why.starts_with("IllegalArgumentException"), "{why}");
    Ok(())
}

#[test]
fn the_arm_knows_where_it_stands() -> Result<(), EvaluationStop> {
    let mut machine = machine("");
    gripper(&mut machine)?;
    ready(&mut machine)?;
    let (lbr, flange) = (lbr(), flange());
    let frame = machine.on(&lbr, "getCurrentCartesianPosition", &[flange])?;
    let expected = Robot::default().flange_pose(&READY).position_m[2] * 1e3;
    let z = machine.on(&frame, "getZ", &[])?.number().unwrap_or_default();
    assert!((z - expected).abs() < 1e-9, "{z} {expected}");
    let joints = machine.on(&lbr, "getCurrentJointPosition", &[])?;
    assert_eq!(machine.on(&joints, "get", &[Value::Int(3)])?.number(), Some(-1.4));
    Ok(())
}

#[test]
fn batches_within_batches_come_to_an_end() -> Result<(), EvaluationStop> {
    let mut machine = machine("");
    let mut batch = machine.motion("ptp", &doubles(&READY))?;
    let why = loop {
        match machine.motion("batch", &[batch.clone(), batch]) {
            Ok(twice) => batch = twice,
            stopped => break reason(stopped),
        }
    };
    assert!(why.contains("16384 motions"), "{why}");
    Ok(())
}

#[test]
fn frames_within_frames_stay_where_they_are() -> Result<(), EvaluationStop> {
    let mut machine = machine("");
    let mut frame = machine.new_frame(&doubles(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]));
    for _ in 0..100_000 {
        let mut within = vec![frame];
        within.extend(doubles(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]));
        frame = machine.new_frame(&within);
    }
    let world = robot(RobotValue::Spot(Spot::World));
    machine.on(&frame, "setParent", &[world])?;
    assert_eq!(machine.on(&frame, "getX", &[])?.number(), Some(100_001.0));
    Ok(())
}

#[test]
fn inputs_of_a_project_group() -> Result<(), EvaluationStop> {
    let mut machine = machine("[inputs]\n\"Belt.Height\" = 37\n\"Belt.Full\" = 1\n");
    let group = Rc::new(JavaObject::detached());
    machine.robot_constructed(&group, "AbstractIOGroup", &[Value::Null, Value::text("Belt")])?;
    let mut read = |name: &str, signal: &str| {
        let arguments = [Value::text(signal), Value::Boolean(false)];
        let value = machine.robot_inherited(&group, "AbstractIOGroup", name, &arguments)?;
        Ok::<_, EvaluationStop>(value.unwrap_or(Value::Null))
    };
    assert!(matches!(read("getAnalogIOValue", "Height")?, Value::Double(37.0)));
    assert!(matches!(read("getNumberIOValue", "Height")?, Value::Int(37)));
    assert!(matches!(read("getBooleanIOValue", "Full")?, Value::Boolean(true)));
    assert!(reason(read("getBooleanIOValue", "Height")).contains("`37`: it is true or false"));
    Ok(())
}

#[test]
fn inexpressible_calls_are_rejected_with_their_place() -> Result<(), EvaluationStop> {
    let mut machine = machine("");
    ready(&mut machine)?;
    let lbr = lbr();
    let rel = || doubles(&[0.0, 0.0, 1.0]);
    let segments =
        (0..21).map(|_| machine.motion("linRel", &rel())).collect::<Result<Vec<_>, _>>()?;
    let spline = machine.robot_new("Spline", &segments)?.unwrap_or(Value::Null);
    let why = reason(machine.on(&lbr, "move", &[spline]));
    assert!(why.contains("21") && why.contains("20"), "{why}");
    let motion = machine.motion("linRel", &rel())?;
    let ignore = machine.robot_constant("SplineOrientationType", "Ignore")?.unwrap_or(Value::Null);
    let motion = machine.on(&motion, "setOrientationType", &[ignore])?;
    let why = reason(machine.on(&lbr, "move", &[motion]));
    assert!(why.contains("orientation"), "{why}");
    let why = reason(machine.robot_static("Thread", "sleep", &[Value::Long(100_000_000)]));
    assert!(!why.starts_with("motion") && why.contains("100000 s"), "{why}");
    Ok(())
}
