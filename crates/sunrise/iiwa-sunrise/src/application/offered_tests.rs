//! Calls all methods that the host offers, on all values that it has: each returns a value that is
//! known, queried or unknown with its place and reason, or is refused. The names are taken from the
//! match arms in the sources.

use std::{collections::BTreeSet, rc::Rc};

use iiwa_java::{EvaluationStop, Value};

use crate::application::{
    enum_constant::EnumConstant,
    frame_value::{FrameValue, RedundancyValue},
    motion_value::{MotionPath, MotionValue},
    robot_value::{JointsValue, LoadRef, RobotValue, Sent},
    robotics::Robotics,
    spot::Spot,
    test_station::machine,
};

const SOURCES: [&str; 21] = [
    include_str!("application_api.rs"),
    include_str!("dialogs.rs"),
    include_str!("fired.rs"),
    include_str!("frame_changes.rs"),
    include_str!("frames_api.rs"),
    include_str!("inputs.rs"),
    include_str!("joints_api.rs"),
    include_str!("library_api.rs"),
    include_str!("load_api.rs"),
    include_str!("motion_setters.rs"),
    include_str!("motions.rs"),
    include_str!("moves.rs"),
    include_str!("opaque_api.rs"),
    include_str!("platform_api.rs"),
    include_str!("process_data.rs"),
    include_str!("robot_api.rs"),
    include_str!("station_host.rs"),
    include_str!("threads_api.rs"),
    include_str!("tools_api.rs"),
    include_str!("user_keys.rs"),
    include_str!("waits.rs"),
];

/// Returns texts in the sources that may be names of methods or of classes.
fn names(is_class: bool) -> BTreeSet<String> {
    let is_name = |text: &&str| {
        let first = text.chars().next();
        let begins =
            first.is_some_and(
                |letter| if is_class { letter.is_uppercase() } else { letter.is_lowercase() },
            );
        begins && text.len() > 1 && text.chars().all(char::is_alphanumeric)
    };
    let texts = SOURCES.iter().flat_map(|source| source.split('"').skip(1).step_by(2));
    let mut names: BTreeSet<_> = texts.filter(is_name).map(str::to_owned).collect();
    if !is_class {
        names.insert("methodThatNobodyKnows".to_owned());
    }
    names
}

/// Creates a value of each kind; opaque objects by their classes.
fn receivers() -> Vec<RobotValue> {
    let joints = JointsValue { joints_rad: [0.1; 7], unknown: None };
    let motion = MotionValue::new(MotionPath::Home);
    let mut all = vec![
        RobotValue::Robot,
        RobotValue::Joints(Rc::new(joints.into())),
        RobotValue::frame(FrameValue::within(Spot::World, iiwa_program::Frame::default())),
        RobotValue::Spot(Spot::World),
        RobotValue::Spot(Spot::Flange),
        RobotValue::Spot(Spot::Tree(1)),
        RobotValue::Transformation(Rc::default()),
        RobotValue::Vector(Rc::new([1.0, 2.0, 3.0])),
        RobotValue::Redundancy(Rc::new(RedundancyValue::default().into())),
        RobotValue::motion(motion),
        RobotValue::Container(Rc::new(Sent { count: 0, has_break: true })),
        RobotValue::JointLimits,
        RobotValue::Load(LoadRef::Own(Rc::default())),
        RobotValue::ProcessData(Rc::from("velocity")),
        RobotValue::IoGroup(Rc::from("Cell")),
        RobotValue::source("Scanner", "data of a file"),
    ];
    let classes = [
        "IApplicationData",
        "IApplicationUI",
        "ITaskLogger",
        "IObserver",
        "IApplicationControl",
        "IContext",
        "Controller",
        "IObserverManager",
        "ICondition",
        "FRISession",
        "Thread",
        "MobilePlatform",
        "PlatformMotion",
        "IUserKeyBar",
        "IUserKey",
    ];
    all.extend(classes.map(RobotValue::opaque));
    let constant = EnumConstant::named("TimeUnit", "SECONDS");
    all.extend(constant.map(|constant| RobotValue::Constant(Rc::new(constant))));
    all
}

fn unknown(machine: &Robotics<'_>) -> Value {
    machine.unknown("an argument")
}

/// Returns true if the contents of a value are unknown.
fn is_spoiled(receiver: &RobotValue) -> bool {
    match receiver {
        RobotValue::Joints(joints) => joints.borrow().unknown.is_some(),
        RobotValue::Frame(frame) => frame.borrow().unknown.is_some(),
        RobotValue::Motion(motion) => motion.borrow().obstacle.is_some(),
        _ => false,
    }
}

/// Returns true for methods whose results and effects do not depend on their arguments.
fn ignores_arguments(class: &str, name: &str) -> bool {
    match class {
        // Logging, displaying, observing, switching and setting there does not move the robot;
        // settings of a motion either change how the robot follows its path, or make it unknown.
        "ITaskLogger"
        | "IObserver"
        | "IApplicationUI"
        | "IApplicationControl"
        | "IObserverManager"
        | "FRISession"
        | "Controller"
        | "IContext"
        | "IUserKeyBar"
        | "IUserKey"
        // A platform drives whatever its motion is; load data that do not change are noted.
        | "MobilePlatform"
        | "PlatformMotion"
        | "LoadData"
        | "RobotMotion" => true,
        "Thread" => matches!(
            name,
            "join"
                | "interrupt"
                | "cancel"
                | "purge"
                | "setPriority"
                | "shutdown"
                | "shutdownNow"
                | "setDaemon"
                | "setName"
                | "isInterrupted"
                | "interrupted"
        ),
        // Conditions are combined; their outcome is queried.
        "ICondition" => matches!(name, "and" | "or" | "xor" | "invert" | "onePressed"),
        "IMotionContainer" => {
            matches!(
                name,
                "await" | "cancel" | "getErrorMessage" | "hasError" | "isCanceled" | "isFinished"
            )
        }
        // The value is kept, and is unknown where it is read.
        "AbstractIOGroup" | "IProcessData" => name.starts_with("set") || name.starts_with("add"),
        "JointLimits" => name.starts_with("get"),
        // Frame methods, whatever device is named.
        "Frame" | "ObjectFrame" | "Tool" => {
            // A frame that is changed by an unknown value has an unknown pose.
            name.ends_with("ransformationFromParent")
                || ["setTransformation", "changeTransformation", "setAdditionalParameter"]
                    .contains(&name)
                || ["getX", "getY", "getZ", "getRed", "hasRed", "isReady", "isAttached", "detach"]
                    .iter()
                    .any(|begin| name.starts_with(begin))
        }
        _ => false,
    }
}

#[test]
fn each_offered_method_gives_a_value_a_question_or_unknown() {
    let names = names(false);
    assert!(names.len() > 150, "{}", names.len());
    let mut wrong = BTreeSet::new();
    let count = receivers().len();
    for index in 0..count {
        for name in &names {
            let mut machine = machine("[answers]\n\"Ready?\" = 0\n");
            for arguments in 0..8 {
                let open = unknown(&machine);
                let list: Vec<Value> = match arguments {
                    0 => vec![],
                    1 => vec![Value::Null],
                    2 => vec![Value::Double(0.5)],
                    3 => vec![Value::text("Ready?"), Value::Int(0)],
                    4 => vec![Value::Boolean(true), Value::text("a"), Value::text("b")],
                    5 => vec![open.clone()],
                    6 => vec![Value::text("a"), open.clone()],
                    _ => vec![open.clone(), open.clone(), open],
                };
                let Some(receiver) = receivers().into_iter().nth(index) else { continue };
                let notes = machine.notes.len();
                let result = machine.call_robot(&receiver, name, &list);
                let class = iiwa_java::HostValue::class(&receiver).to_owned();
                let call = format!("{class}.{name}");
                match result {
                    Ok(Value::Unknown(unknown)) => {
                        if unknown.reason.is_empty() || unknown.place.line == 0 {
                            wrong.insert(format!("{call}: unknown without a reason or a place"));
                        }
                    }
                    Err(EvaluationStop::Refused(refusal)) if !refusal.reason.is_empty() => {}
                    Err(EvaluationStop::Thrown(thrown)) if !thrown.message.is_empty() => {}
                    Err(stop) => {
                        wrong.insert(format!("{call}: {stop:?}"));
                    }
                    Ok(_) if arguments < 5 => {}
                    Ok(_) => {
                        let is_said = machine.notes.len() > notes || is_spoiled(&receiver);
                        if !is_said && !ignores_arguments(&class, name) {
                            wrong
                                .insert(format!("{call}: {arguments}: known by unknown arguments"));
                        }
                    }
                }
                if name == "methodThatNobodyKnows"
                    && matches!(
                        receiver,
                        RobotValue::Joints(_) | RobotValue::Frame(_) | RobotValue::Motion(_)
                    )
                    && !is_spoiled(&receiver)
                {
                    wrong.insert(format!("{call}: it may have changed its object"));
                }
            }
        }
    }
    let wrong: Vec<_> = wrong.into_iter().collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn static_methods_and_constructors_do_not_guess_by_unknown_arguments() {
    let (names, classes) = (names(false), names(true));
    let mut wrong = BTreeSet::new();
    for class in &classes {
        let mut machine = machine("");
        for count in 1..4 {
            let list = vec![unknown(&machine); count];
            // Opaque objects, and objects whose contents are unknown.
            if let Ok(Some(Value::Host(_))) = machine.robot_new(class, &list)
                && ["Frame", "JointPosition", "LBRE1Redundancy", "Vector"].contains(&class.as_str())
            {
                wrong.insert(format!("new {class}"));
            }
            for name in &names {
                // Servo motions are refused where they move.
                if name == "validateForImpedanceMode" {
                    continue;
                }
                if let Ok(Some(value)) = machine.robot_static(class, name, &list)
                    && !matches!(value, Value::Unknown(_) | Value::Host(_) | Value::Null)
                {
                    wrong.insert(format!("{class}.{name} of {count}: {value:?}"));
                }
            }
        }
    }
    let wrong: Vec<_> = wrong.into_iter().collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
