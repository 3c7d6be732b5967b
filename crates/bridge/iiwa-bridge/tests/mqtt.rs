//! Commands over MQTT 5, from a broker that reads and writes single packets.

#![expect(clippy::panic, clippy::unwrap_used, reason = "a failed test panics")]

use std::{
    io::{self, Read, Write},
    iter,
    net::{TcpListener, TcpStream},
    sync::Arc,
    thread,
    time::Duration,
};

use bytes::BytesMut;
use iiwa_bridge::{
    BridgedRobot, BrokerAccess, Timestamp,
    commands::CommandGate,
    encoding::JointFormat,
    mqtt::{Mqtt, MqttConnection, MqttOptions, MqttVersion},
};
use iiwa_link::Remote;
use iiwasim_tests::ports::free_address;
use rumqttc::v5::mqttbytes::{
    Error, QoS,
    v5::{
        ConnAck, ConnectReturnCode, Filter, Packet, PingResp, PubAck, Publish, PublishProperties,
        RetainForwardRule, SubAck, SubscribeReasonCode,
    },
};
use serde_json::Value;

const LONG: Duration = Duration::from_mins(1);

/// The broker's side of a connection.
struct Peer {
    stream: TcpStream,
    read: BytesMut,
    sent: u16,
}

impl Peer {
    /// Accepts a client and its subscription; `None` for a client that only probes the connection.
    fn accept(listener: &TcpListener) -> Option<(Self, Filter)> {
        let (stream, _) = listener.accept().unwrap();
        stream.set_read_timeout(Some(LONG)).unwrap();
        let mut peer = Self { stream, read: BytesMut::new(), sent: 0 };
        let Packet::Connect(..) = peer.next().ok()? else { return None };
        let code = ConnectReturnCode::Success;
        let accepted = ConnAck { session_present: false, code, properties: None };
        peer.send(&Packet::ConnAck(accepted)).ok()?;
        let Packet::Subscribe(subscribe) = peer.next().ok()? else { return None };
        let [filter] = &subscribe.filters[..] else { panic!("{subscribe:?}") };
        let return_codes = vec![SubscribeReasonCode::Success(QoS::AtLeastOnce)];
        let pkid = subscribe.pkid;
        peer.send(&Packet::SubAck(SubAck { pkid, return_codes, properties: None })).ok()?;
        Some((peer, filter.clone()))
    }

    /// Reads the next packet of the client.
    fn next(&mut self) -> io::Result<Packet> {
        loop {
            match Packet::read(&mut self.read, None) {
                Ok(packet) => return Ok(packet),
                Err(Error::InsufficientBytes(_)) => {}
                // Such as a DISCONNECT packet without a reason.
                Err(error) => return Err(io::Error::other(error)),
            }
            let mut bytes = [0; 4096];
            let count = self.stream.read(&mut bytes)?;
            if count == 0 {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            self.read.extend_from_slice(&bytes[..count]);
        }
    }

    fn send(&mut self, packet: &Packet) -> io::Result<()> {
        let mut bytes = BytesMut::new();
        packet.write(&mut bytes, None).unwrap();
        self.stream.write_all(&bytes)
    }

    /// Delivers a command.
    fn deliver(&mut self, body: &str, retain: bool, response_topic: Option<&str>) {
        let properties = PublishProperties {
            response_topic: response_topic.map(str::to_owned),
            correlation_data: Some("7f3c".into()),
            ..PublishProperties::default()
        };
        let body = body.as_bytes().to_vec();
        let mut publish =
            Publish::new("plant/cell-1/request", QoS::AtLeastOnce, body, Some(properties));
        publish.retain = retain;
        self.sent += 1;
        publish.pkid = self.sent;
        self.send(&Packet::Publish(publish)).unwrap();
    }

    /// Returns topic and content of the next client message, which contains the correlation data of
    /// the delivery.
    fn published(&mut self) -> (String, Value) {
        loop {
            match self.next().unwrap() {
                Packet::Publish(publish) => {
                    self.send(&Packet::PubAck(PubAck::new(publish.pkid, None))).unwrap();
                    let properties = publish.properties.unwrap();
                    assert_eq!(properties.correlation_data.as_deref(), Some(&b"7f3c"[..]));
                    let topic = String::from_utf8(publish.topic.to_vec()).unwrap();
                    return (topic, serde_json::from_slice(&publish.payload).unwrap());
                }
                Packet::PingReq(_) => self.send(&Packet::PingResp(PingResp)).unwrap(),
                Packet::PubAck(_) => {}
                other => panic!("{other:?}"),
            }
        }
    }
}

/// A bridge that accepts commands for a robot with an unavailable drive, and its broker.
struct Rig {
    gate: Arc<CommandGate>,
    peer: Peer,
    filter: Filter,
    _mqtt: Mqtt,
    _spool: tempfile::TempDir,
}

impl Rig {
    fn new() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let spool = tempfile::tempdir().unwrap();
        let options = MqttOptions {
            connection: MqttConnection {
                host: "127.0.0.1".to_owned(),
                port: listener.local_addr().unwrap().port(),
                version: MqttVersion::V5,
                access: BrokerAccess::default(),
                client_id: "bridge".to_owned(),
            },
            prefix: "plant".to_owned(),
            rate_hz: None,
            joints: JointFormat::default(),
            spool: spool.path().to_owned(),
            spool_bytes: 64 << 20,
        };
        let away = || format!("tcp://{}", free_address());
        let robot = BridgedRobot::new("cell-1", Remote::open(), away(), away()).unwrap();
        let robots = [robot];
        let gate = Arc::new(CommandGate::new(&robots, true).unwrap());
        let started = {
            let gate = Arc::clone(&gate);
            thread::spawn(move || Mqtt::start(&options, &robots, 1, &gate).unwrap())
        };
        // The bridge probes the connection before it subscribes.
        let (peer, filter) =
            iter::repeat_with(|| Peer::accept(&listener)).flatten().next().unwrap();
        Self { gate, peer, filter, _mqtt: started.join().unwrap(), _spool: spool }
    }

    /// Returns the numbers of accepted and refused commands.
    fn counts(&self) -> (u64, u64) {
        (self.gate.counts().accepted, self.gate.counts().refused)
    }
}

/// Returns a command that moves the robot, if accepted.
fn command(id: &str) -> String {
    let time = serde_json::to_string(&Timestamp::now()).unwrap();
    let request =
        r#"{"type":"run_motions","motions":[{"type":"ptp","joints_deg":[60,0,0,0,0,0,0]}]}"#;
    format!(r#"{{"version":1,"robot":"cell-1","id":"{id}","at":{time},"request":{request}}}"#)
}

fn check_refusal((topic, message): &(String, Value), id: &str, reason: &str) {
    assert_eq!(topic, "plant/cell-1/reply");
    assert_eq!((&message["robot"], &message["id"]), (&"cell-1".into(), &id.into()));
    assert_eq!(message["reply"]["ok"], false);
    let error = message["reply"]["error"]["message"].as_str().unwrap();
    assert!(error.contains(reason), "{error}");
}

#[test]
fn retained_commands_are_seen_and_refused() {
    let mut rig = Rig::new();
    assert_eq!(rig.filter.path, "plant/cell-1/request");
    assert!(rig.filter.preserve_retain);
    assert_eq!(rig.filter.retain_forward_rule, RetainForwardRule::OnEverySubscribe);
    rig.peer.deliver(&command("a"), true, None);
    check_refusal(&rig.peer.published(), "a", "the command is retained");
    // Invalid retained commands are also refused, as are retained commands with a permitted
    // response topic.
    rig.peer.deliver("nonsense", true, None);
    assert_eq!(rig.peer.published().1["reply"]["ok"], false);
    rig.peer.deliver(&command("b"), true, Some("plant/cell-1/reply/b"));
    let (topic, message) = rig.peer.published();
    assert_eq!((topic.as_str(), &message["id"]), ("plant/cell-1/reply/b", &"b".into()));
    assert_eq!(message["reply"]["ok"], false);
    assert_eq!(rig.counts(), (0, 3));
}

#[test]
fn removal_of_a_retained_command_is_no_command() {
    let mut rig = Rig::new();
    rig.peer.deliver("", true, None);
    rig.peer.deliver(&command("a"), true, None);
    // The first reply is the reply to the second message.
    check_refusal(&rig.peer.published(), "a", "the command is retained");
    assert_eq!(rig.counts(), (0, 1));
}

#[test]
fn commands_with_a_foreign_response_topic_are_refused() {
    let mut rig = Rig::new();
    let foreign = [
        "answers",
        "plant/cell-1/request",
        "plant/cell-1/state",
        "plant/cell-2/request",
        "plant/cell-1/reply/#",
        "$SYS/broker",
    ];
    for (i, topic) in foreign.iter().enumerate() {
        let id = i.to_string();
        rig.peer.deliver(&command(&id), false, Some(topic));
        let reason = "the response topic has to be `plant/cell-1/reply` or a topic below it";
        check_refusal(&rig.peer.published(), &id, reason);
    }
    assert_eq!(rig.counts(), (0, foreign.len() as u64));
    // Replies are published below the robot's topic, here for a command that the gate refuses.
    for topic in ["plant/cell-1/reply", "plant/cell-1/reply/client/7"] {
        rig.peer.deliver("{}", false, Some(topic));
        let (to, message) = rig.peer.published();
        assert_eq!(to, topic);
        let error = message["reply"]["error"]["message"].as_str().unwrap();
        assert!(error.contains("`version` has to be 1"), "{error}");
    }
}
