//! One message of each kind, also for the JSON Schema in `tests/peers`.

use std::net::{IpAddr, Ipv4Addr};

use iiwa_bridge::{
    Content, Message, Timestamp,
    message::{
        BridgeStatus, CommandCounts, CycleSample, RobotConditions, RunKind, RunMessage, RunPhase,
        VERSION,
    },
    spool::Level,
};
use iiwa_link::message::{
    BindingLimit, Conditions, Direction, DriveState, FriStatus, Hello, IoValue, OperationMode,
    Presence, Refusal, RunEnd, RunLabel, RunPlan, Sensors, Signal,
};

fn message(content: Content) -> Message {
    Message {
        version: VERSION,
        robot: "cell-1".to_owned(),
        session: 1_764_108_000_123,
        seq: 4711,
        at: Timestamp::from_micros(1_764_108_000_123_456),
        content,
    }
}

fn run(result: Option<RunEnd>, label: RunLabel) -> Content {
    let event = if result.is_some() { RunPhase::End } else { RunPhase::Begin };
    Content::Run(RunMessage { t_s: 1.5, run: 7, event, what: RunKind::Motions, label, result })
}

fn conditions() -> RobotConditions {
    let mut fri = FriStatus::new("commanding_active", "excellent");
    fri.unexpected_source = Some(IpAddr::V4(Ipv4Addr::LOCALHOST));
    fri.safety_stop = true;
    let mut conditions = Conditions::default();
    conditions.operation_mode = Some(OperationMode::Aut);
    conditions.override_rel = Some(0.5);
    conditions.safety_stop = Some(false);
    conditions.tool = Some("gripper".to_owned());
    RobotConditions {
        drive: Presence::Connected,
        state: Some(DriveState::Idle),
        fri: Some(fri),
        robot_program: Presence::Connected,
        simulated: true,
        hello: Some(Hello::new(1, "iiwasim 0.1.0")),
        conditions: Some(conditions),
    }
}

/// Returns one message of each kind, with all keys and with as few as permitted.
pub(crate) fn all() -> Vec<Message> {
    let sample =
        CycleSample { t_s: 12.345, joints_rad: [0.1; 7], measured_nm: None, external_nm: None };
    let full = CycleSample { measured_nm: Some([1.0; 7]), external_nm: Some([0.5; 7]), ..sample };
    let limit = BindingLimit { motion: 1, joint: None, kind: "cart_velocity".into(), share: 0.5 };
    let plan = RunPlan { cycle_time_s: 2.0, limited_by: vec![limit] };
    let label = RunLabel { program: Some("pick".to_owned()), plan: Some(plan), planned_for: None };
    let mut end = RunEnd::default();
    end.cycle_time_s = Some(2.01);
    end.start_s = Some(1.0);
    let mut failed = RunEnd::default();
    failed.error = Some(Refusal::robot("the emergency stop is pressed"));
    let signal =
        |name: &str, value| Signal { name: name.to_owned(), direction: Direction::Output, value };
    let io = vec![
        signal("a", IoValue::Boolean(true)),
        signal("b", IoValue::Digital(7)),
        signal("c", IoValue::Analog(-0.5)),
    ];
    let silent = RobotConditions {
        drive: Presence::Silent,
        state: None,
        fri: None,
        robot_program: Presence::Silent,
        simulated: false,
        hello: None,
        conditions: None,
    };
    let status = BridgeStatus {
        online: true,
        commands: CommandCounts { accepted: 3, refused: 1 },
        spools: [("kafka".to_owned(), Level { bytes: 8, dropped: 0 })].into(),
    };
    [
        Content::Joints(sample),
        Content::Joints(full),
        Content::State { t_s: 1.0, state: DriveState::RunningTrajectory },
        run(None, RunLabel::default()),
        run(Some(end), label),
        run(Some(failed), RunLabel::default()),
        Content::Io { io },
        Content::Sensors(Sensors::new(None, [0.0; 7])),
        Content::Sensors(Sensors::new(Some([30.0; 7]), [0.0; 7])),
        Content::Conditions(Box::new(conditions())),
        Content::Conditions(Box::new(silent)),
        Content::Bridge(status),
    ]
    .into_iter()
    .map(message)
    .chain([BridgeStatus::last_will("cell-1", 5)])
    .collect()
}
