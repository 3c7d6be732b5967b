//! The server for Foxglove and Lichtblick against the library of their SDK. Without a twin: tests
//! choose the times and publish more than any robot does.

mod peer;
mod viewer;

use std::{
    net::{Ipv4Addr, SocketAddr, TcpListener},
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use iiwa_kin::{Joints, Robot, RosNames, RosStack};
use iiwa_link::message::{DriveState, DriveStatus, FriStatus, IoValue, Presence, Sensors};
use iiwa_log::{Arm, Encoder, FramePose, Topic};
use iiwasim_tests::{child_processes, ports::free_address};
use serde_json::{Value, json};

use iiwa_foxglove::Viewers;

use self::viewer::Viewer;

const JOINTS: Joints = [0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.7];
const ARM_TOPICS: [&str; 3] = ["/joint_states", "/tf", "/tcp_pose"];
/// Topics that are there.
const ALL: usize = 7;

fn listen() -> Viewers {
    listen_with(&RosNames::default())
}

fn listen_with(names: &RosNames) -> Viewers {
    Viewers::listen(&Robot::default(), names, free_address()).unwrap()
}

/// So long after a time of these days.
fn at(since: Duration) -> SystemTime {
    UNIX_EPOCH + Duration::from_millis(1_800_000_000_500) + since
}

fn since_1970(time: SystemTime) -> Duration {
    time.duration_since(UNIX_EPOCH).unwrap()
}

fn nanoseconds(t: Duration) -> u64 {
    u64::try_from(t.as_nanos()).unwrap()
}

fn status() -> DriveStatus {
    let mut fri = FriStatus::new("commanding_active", "excellent");
    fri.lost = 1;
    fri.late = 2;
    let mut status = DriveStatus::new(DriveState::RunningTrajectory, fri);
    status.joints_rad = Some(JOINTS);
    status.t_s = Some(1.5);
    status.robot_program = Presence::Connected;
    status
}

/// The same before the robot has sent anything.
fn without_positions() -> DriveStatus {
    let mut status = status();
    status.joints_rad = None;
    status.t_s = None;
    status
}

/// A viewer that is subscribed to these topics, and has received the description.
fn subscriber(viewers: &Viewers, topics: &[&str]) -> Viewer {
    let mut viewer = Viewer::connect(viewers.address(), ALL);
    viewer.subscribe(topics);
    viewer.next_on("/robot_description");
    viewer
}

#[test]
fn viewers_find_the_topics_of_a_recording() {
    let viewers = listen();
    let viewer = Viewer::connect(viewers.address(), ALL);
    assert_eq!(viewer.info.name, "iiwasim");
    assert!(viewer.info.capabilities.is_empty(), "{:?}", viewer.info);

    for topic in [Topic::JointStates, Topic::Tf, Topic::TcpPose, Topic::RobotDescription] {
        let channel = &viewer.channels[topic.name()];
        assert_eq!(channel.encoding, "cdr");
        assert_eq!(channel.schema_encoding.as_deref(), Some("ros2msg"));
        assert_eq!(channel.schema_name, topic.type_name());
        assert_eq!(channel.schema, topic.schema());
    }
    for topic in ["/drive_state", "/sensors", "/inputs_outputs"] {
        let channel = &viewer.channels[topic];
        assert_eq!(channel.encoding, "json");
        assert_eq!(channel.schema_encoding.as_deref(), Some("jsonschema"));
    }
}

#[test]
fn samples_arrive_as_they_are_encoded_in_a_recording() {
    samples_arrive(&RosNames::default());
}

#[test]
fn names_are_those_of_another_ros_package() {
    samples_arrive(&RosNames::new(RosStack::LbrFriRos2Stack, Some("left".parse().unwrap())));
}

fn samples_arrive(names: &RosNames) {
    let mut viewers = listen_with(names);
    let mut viewer = subscriber(&viewers, &ARM_TOPICS);
    let arm = Arm::with_names(&Robot::default(), names);
    let mut encoder = Encoder::with_names(Duration::ZERO, names).unwrap();

    let (start, span) = (Duration::from_millis(30), Duration::from_millis(250));
    let moved = JOINTS.map(|joint| joint + 0.5);
    for (t, joints, velocities) in [(start, JOINTS, [0.0; 7]), (start + span, moved, [2.0; 7])] {
        viewers.joints(at(t), &joints).unwrap();

        let t = since_1970(at(t));
        let arrived = viewer.next_on("/joint_states");
        assert_eq!(arrived.time_ns, nanoseconds(t));
        assert_eq!(arrived.data, encoder.joint_state(t, &joints, &velocities, None).unwrap());
        let arrived = viewer.next_on("/tf");
        assert_eq!(arrived.data, encoder.transforms(t, &arm.links(&joints)).unwrap());
        let FramePose { parent, translation_m, rotation_xyzw, .. } = arm.flange(&joints);
        let arrived = viewer.next_on("/tcp_pose");
        let pose = encoder.tcp_pose(t, parent, translation_m, rotation_xyzw).unwrap();
        assert_eq!(arrived.data, pose);
    }
}

#[test]
fn a_clock_that_is_set_back_does_no_harm() {
    let mut viewers = listen();
    let mut viewer = subscriber(&viewers, &["/joint_states"]);
    let mut encoder = Encoder::new(Duration::ZERO).unwrap();
    for t in [at(Duration::from_secs(9)), at(Duration::from_secs(2))] {
        viewers.joints(t, &JOINTS).unwrap();
        let expected = encoder.joint_state(since_1970(t), &JOINTS, &[0.0; 7], None).unwrap();
        assert_eq!(viewer.next_on("/joint_states").data, expected);
    }
}

#[test]
fn of_a_fast_stream_viewers_get_a_hundred_samples_a_second() {
    let mut viewers = listen();
    let mut viewer = subscriber(&viewers, &["/joint_states"]);
    for ms in 0..1000 {
        viewers.joints(at(Duration::from_millis(ms)), &JOINTS).unwrap();
    }
    for k in 0..100 {
        let t = since_1970(at(Duration::from_millis(10 * k)));
        assert_eq!(viewer.next_on("/joint_states").time_ns, nanoseconds(t));
    }
    viewers.drive_state(at(Duration::ZERO), &status());
    drop(viewers);
    assert!(viewer.next().is_none());
}

#[test]
fn late_viewers_get_the_description_and_the_last_state() {
    let viewers = listen();
    let mut early = subscriber(&viewers, &["/drive_state"]);
    viewers.drive_state(at(Duration::ZERO), &without_positions());
    let arrived = early.next_on("/drive_state");
    assert_eq!(arrived.time_ns, nanoseconds(since_1970(at(Duration::ZERO))));
    viewers.drive_state(at(Duration::ZERO), &status());
    let last = early.next_on("/drive_state");

    let mut late = Viewer::connect(viewers.address(), ALL);
    late.subscribe(&["/drive_state", "/sensors"]);
    assert_eq!(late.next_on("/drive_state").data, last.data);
    // Nothing was published on /sensors so far.
    let description = late.next_on("/robot_description").data;
    let mut encoder = Encoder::new(Duration::ZERO).unwrap();
    let urdf = Robot::default().to_urdf();
    assert_eq!(description, encoder.robot_description(&urdf).unwrap());

    // The early viewer does not get it again.
    viewers.drive_state(at(Duration::from_secs(1)), &status());
    let arrived = early.next_on("/drive_state");
    assert_eq!(arrived.time_ns, nanoseconds(since_1970(at(Duration::from_secs(1)))));
}

/// Asserts that a value fits a schema, in the subset of JSON Schema that viewers support.
fn assert_fits(value: &Value, schema: &Value) {
    match schema["type"].as_str().unwrap() {
        "object" => {
            let properties = schema["properties"].as_object().unwrap();
            for (name, value) in value.as_object().unwrap() {
                assert_fits(value, &properties[name]);
            }
        }
        "array" => {
            assert_ne!(schema["items"]["type"], "array");
            value.as_array().unwrap().iter().for_each(|item| assert_fits(item, &schema["items"]));
        }
        "string" => assert!(value.is_string(), "{value}"),
        "number" => assert!(value.is_number(), "{value}"),
        "integer" => assert!(value.is_u64(), "{value}"),
        other => panic!("viewers do not know the type {other}"),
    }
}

#[test]
fn json_messages_fit_their_schemas() {
    let viewers = listen();
    let mut viewer = subscriber(&viewers, &["/drive_state", "/sensors", "/inputs_outputs"]);
    let start = at(Duration::ZERO);
    let sensors = Sensors::new(Some([31.5; 7]), JOINTS);
    let values = [
        ("gripper_closed", IoValue::Boolean(true)),
        ("count", IoValue::Digital(7)),
        ("pressure", IoValue::Analog(-0.25)),
    ];
    viewers.drive_state(start, &status());
    viewers.drive_state(start, &without_positions());
    viewers.sensors(start, &sensors);
    viewers.inputs_outputs(start, &values);

    let schemas: Vec<Value> = ["/drive_state", "/drive_state", "/sensors", "/inputs_outputs"]
        .map(|topic| serde_json::from_str(&viewer.channels[topic].schema).unwrap())
        .to_vec();
    let messages: Vec<Value> =
        (0..4).map(|_| serde_json::from_slice(&viewer.next().unwrap().data).unwrap()).collect();
    for (message, schema) in messages.iter().zip(&schemas) {
        assert_fits(message, schema);
    }
    for place in [0, 2] {
        let properties = schemas[place]["properties"].as_object().unwrap();
        assert!(properties.keys().eq(messages[place].as_object().unwrap().keys()));
    }
    assert_eq!(messages[0], serde_json::to_value(status()).unwrap());
    assert_eq!(
        messages[3],
        json!({ "values": [
            { "name": "gripper_closed", "value": 1 },
            { "name": "count", "value": 7 },
            { "name": "pressure", "value": -0.25 },
        ] })
    );
}

#[test]
fn a_viewer_that_does_not_read_delays_nothing_and_then_gets_the_newest() {
    const SENT: u64 = 60_000;
    let mut viewers = listen();
    let mut viewer = subscriber(&viewers, &["/tf"]);
    let started = Instant::now();
    for k in 0..SENT {
        viewers.joints(at(Duration::from_millis(10 * k)), &JOINTS).unwrap();
    }
    assert!(started.elapsed() < Duration::from_secs(10), "{:?}", started.elapsed());

    let newest = nanoseconds(since_1970(at(Duration::from_millis(10 * (SENT - 1)))));
    let mut arrived = 1;
    while viewer.next_on("/tf").time_ns < newest {
        arrived += 1;
    }
    assert!(arrived < SENT, "all {SENT} messages were kept for it");
}

#[test]
fn the_end_does_not_wait_for_a_viewer_that_does_not_read() {
    let mut viewers = listen();
    let _viewer = subscriber(&viewers, &["/tf"]);
    for k in 0..60_000 {
        viewers.joints(at(Duration::from_millis(10 * k)), &JOINTS).unwrap();
    }
    let address = viewers.address();
    let started = Instant::now();
    drop(viewers);
    assert!(started.elapsed() < Duration::from_secs(5), "{:?}", started.elapsed());
    child_processes::await_all();
    drop(Viewers::listen(&Robot::default(), &RosNames::default(), address).unwrap());
}

#[test]
fn the_end_disconnects_viewers_and_frees_the_port() {
    let viewers = listen();
    let address = viewers.address();
    let mut viewer = subscriber(&viewers, &ARM_TOPICS);
    drop(viewers);
    assert!(viewer.next().is_none());
    child_processes::await_all();
    drop(TcpListener::bind(address).unwrap());
}

#[test]
fn viewers_only_read() {
    let viewers = listen();
    let mut viewer = subscriber(&viewers, &[]);
    let channel = r#"{ "id": 1, "topic": "/joint_states", "encoding": "json", "schemaName": "" }"#;
    for message in [
        format!(r#"{{ "op": "advertise", "channels": [{channel}] }}"#),
        r#"{ "op": "setParameters", "parameters": [{ "name": "a", "value": 1 }] }"#.to_owned(),
    ] {
        viewer.send(message);
        let status = viewer.status();
        assert!(status.message.contains("does not support"), "{status:?}");
    }
}

#[test]
fn viewers_receive_errors() {
    let viewers = listen();
    let mut viewer = subscriber(&viewers, &["/tf"]);
    let subscribe = |id: u64, channel: u64| {
        json!({
            "op": "subscribe", "subscriptions": [{ "id": id, "channelId": channel }]
        })
    };
    let (tf, sensors) = (viewer.channels["/tf"].id, viewer.channels["/sensors"].id);
    for (message, expected) in [
        (subscribe(9, 99).to_string(), "unknown channel 99"),
        (subscribe(9, tf).to_string(), "already subscribed"),
        (subscribe(0, sensors).to_string(), "subscription 0 is in use"),
        ("no JSON".to_owned(), "invalid message"),
    ] {
        viewer.send(message);
        let status = viewer.status();
        assert!(status.message.contains(expected), "{status:?}");
    }
}

#[test]
fn who_unsubscribes_gets_no_more() {
    let mut viewers = listen();
    let mut viewer = subscriber(&viewers, &["/tf", "/joint_states"]);
    viewer.send(json!({ "op": "unsubscribe", "subscriptionIds": [0] }).to_string());
    // Answered in turn: the other one has been carried out by then.
    viewer.send("{}".to_owned());
    viewer.status();
    viewers.joints(at(Duration::ZERO), &JOINTS).unwrap();
    viewer.next_on("/joint_states");
    viewers.joints(at(Duration::from_secs(1)), &JOINTS).unwrap();
    viewer.next_on("/joint_states");
}

#[test]
fn there_are_sixteen_viewers_at_most_and_a_place_is_free_again() {
    let viewers = listen();
    let mut seated: Vec<_> = (0..16).map(|_| Viewer::connect(viewers.address(), ALL)).collect();
    assert!(Viewer::is_refused(viewers.address()));
    seated.pop();
    let started = Instant::now();
    while Viewer::is_refused(viewers.address()) {
        assert!(started.elapsed() < Duration::from_secs(20), "no place became free");
    }
}

#[test]
fn a_page_that_speaks_another_protocol_is_refused() {
    let viewers = listen();
    assert!(Viewer::is_refused_with(viewers.address(), "foxglove.sdk.v2"));
}

#[test]
fn an_address_in_use_is_reported() {
    let taken = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let address = taken.local_addr().unwrap();
    let error = Viewers::listen(&Robot::default(), &RosNames::default(), address)
        .err()
        .unwrap()
        .to_string();
    assert!(error.starts_with(&format!("cannot listen for viewers at {address}: ")), "{error}");
}

#[test]
fn port_0_takes_a_free_one() {
    for host in ["127.0.0.1:0", "[::1]:0"] {
        let host: SocketAddr = host.parse().unwrap();
        if TcpListener::bind(host).is_err() {
            eprintln!("left out: there is no {host} here");
            continue;
        }
        let viewers = Viewers::listen(&Robot::default(), &RosNames::default(), host).unwrap();
        assert_eq!(viewers.address().ip(), host.ip());
        assert_eq!(Viewer::connect(viewers.address(), ALL).info.name, "iiwasim");
    }
}
