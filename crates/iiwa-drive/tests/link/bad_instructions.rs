//! Invalid instructions to the robot program: each gets an error and has no other effect.

use serde_json::{Value, json};

use crate::{
    corrupted::{Field, Requirement, corrupted, fields_of, good_requests, trajectory_to},
    request_socket::{RequestSocket, assert_error},
    rig::{LONG, Rig},
};

#[test]
fn invalid_instructions_get_an_error_and_have_no_effect() {
    let mut rig = Rig::parts(5);
    rig.start_cabinet();
    let socket = RequestSocket::new(&rig.cabinet_config.instructions);
    let before = rig.cabinet().position();
    let seq = Field("/seq", Requirement::Required, &["3"]);
    let kind = Field("/type", Requirement::Required, &[]);
    let run = || Field("/run", Requirement::Required, &["3"]);
    let mut motions = good_requests().swap_remove(0);
    motions["run"] = json!(1);
    let mut with_more = motions.clone();
    with_more["seq"] = json!(7);
    with_more["speed"] = json!(1);
    let answer = socket.ask(&with_more.to_string());
    assert_error(
        &answer["error"],
        "bad_request",
        &["unknown key `speed`"],
        "a key that is not known",
    );
    let instructions = [
        (motions, {
            let mut fields = fields_of("run_motions");
            fields.push(run());
            fields
        }),
        (json!({"type": "run_trajectory", "run": 1}), vec![run()]),
        (json!({"type": "end_trajectory", "run": 1}), vec![run()]),
        (json!({"type": "get_io", "name": "MediaFlange.LEDBlue"}), fields_of("get_io")),
        (
            json!({"type": "set_io", "name": "MediaFlange.LEDBlue", "value": true}),
            fields_of("set_io"),
        ),
        (json!({"type": "read_sensors"}), vec![kind]),
        (json!({"type": "list_io"}), vec![Field("/type", Requirement::Required, &[])]),
        (json!({"type": "stop"}), vec![seq]),
    ];
    for (mut good, fields) in instructions {
        good["seq"] = json!(7);
        for (instruction, field) in corrupted(&good, &fields) {
            let answer = socket.ask(&instruction);
            let names = [
                &field,
                "column",
                "motion 1",
                "no input or output",
                "true or false",
                "`x`",
                "there is no",
            ];
            assert_error(&answer["error"], "bad_request", &names, &instruction);
            let head: Value = serde_json::from_str(&instruction).unwrap();
            if head["seq"].is_u64() && head["type"].is_string() {
                assert_eq!(answer["seq"], 7, "{instruction}");
            }
        }
    }
    for garbage in [
        String::new(),
        "{}".to_owned(),
        "[]".to_owned(),
        "null".to_owned(),
        r#"{"seq": 1, "seq": 1, "type": "stop"}"#.to_owned(),
        r#"{"seq": 18446744073709551616, "type": "stop"}"#.to_owned(),
        format!(r#"{{"seq": 1, "type": "{}\u001b"}}"#, "x".repeat(10_000)),
        r#"{"seq": 1, "type": "fly\u001b"}"#.to_owned(),
        "[".repeat(100_000),
    ] {
        let answer = socket.ask(&garbage);
        assert_error(&answer["error"], "bad_request", &["column", "fly", "xxx..."], &garbage);
    }
    assert!(socket.ask_bytes(b"\xff\xfe").contains("bad_request"));
    socket.socket.send_multipart(["{}", "{}"], 0).unwrap();
    assert!(socket.socket.recv_string(0).unwrap().unwrap().contains("one frame"));
    // Messages of peers that do not frame them like REQ get no reply and have no effect.
    let dealer = zmq::Context::new().socket(zmq::DEALER).unwrap();
    dealer.set_linger(0).unwrap();
    dealer.connect(&rig.cabinet_config.instructions).unwrap();
    for frames in [[b"x".as_slice(), b"y"].as_slice(), &[b""], &[b"", b""], &[b"{}"]] {
        dealer.send_multipart(frames, 0).unwrap();
    }
    let outside = json!({"seq": 8, "type": "run_motions", "run": 1, "motions":
        [{"type": "ptp", "joints_deg": [171, 0, 0, 0, 0, 0, 0]}]});
    let answer = socket.ask(&outside.to_string());
    assert_error(&answer["error"], "limit", &["joint A1"], "outside");
    assert_eq!(rig.cabinet().position(), before);
    let answer = socket.ask(r#"{"seq": 9, "type": "get_io", "name": "MediaFlange.LEDBlue"}"#);
    assert_eq!((&answer["seq"], &answer["value"]), (&json!(9), &json!(false)));
    rig.start_drive();
    rig.wait_until_ready();
    rig.client().run_trajectory(trajectory_to(1.0), Some(LONG)).unwrap();
}
