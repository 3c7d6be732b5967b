//! Invalid instructions to the robot program: each gets an error and has no other effect.

use iiwasim_tests::socket::{Socket, SocketType};
use serde_json::json;

use crate::link::{
    corrupted::{Corrupted, good_requests, trajectory_to},
    instructions::{OTHER_WORDS, SEQ, corrupted_instructions, garbage},
    request_socket::{RequestSocket, assert_error},
    rig::{LONG, Rig},
};

#[test]
fn invalid_instructions_get_an_error_and_have_no_effect() {
    let mut rig = Rig::parts(5);
    rig.start_cabinet();
    let socket = RequestSocket::new(&rig.cabinet_config.instructions);
    let before = rig.cabinet().position();
    let mut motions = good_requests().swap_remove(0);
    motions["run"] = json!(1);
    let mut with_more = motions;
    with_more["seq"] = json!(SEQ);
    with_more["speed"] = json!(1);
    let answer = socket.request(&with_more.to_string());
    assert_error(
        &answer["error"],
        "bad_request",
        &["unknown key `speed`"],
        "a key that is not known",
    );
    for (_, Corrupted { message, name, .. }) in corrupted_instructions() {
        let instruction = message.to_string();
        let answer = socket.request(&instruction);
        let names: Vec<&str> = OTHER_WORDS.into_iter().chain([name.as_str()]).collect();
        assert_error(&answer["error"], "bad_request", &names, &instruction);
        if message["seq"].is_u64() && message["type"].is_string() {
            assert_eq!(answer["seq"], SEQ, "{instruction}");
        }
    }
    for garbage in garbage() {
        let answer = socket.request(&garbage);
        assert_error(
            &answer["error"],
            "bad_request",
            &["column", "fly", "xxx...", "object", "seq"],
            &garbage,
        );
    }
    assert!(socket.request_bytes(b"\xff\xfe").contains("bad_request"));
    assert!(socket.request_frames(&[b"{}", b"{}"]).contains("one frame"));
    // Messages of peers without REQ framing receive no reply and have no effect.
    let dealer = Socket::connect(SocketType::Dealer, &rig.cabinet_config.instructions).unwrap();
    for frames in [[b"x".as_slice(), b"y"].as_slice(), &[b""], &[b"", b""], &[b"{}"]] {
        dealer.send(frames).unwrap();
    }
    let outside = json!({"seq": 8, "type": "run_motions", "run": 1, "motions":
        [{"type": "ptp", "joints_deg": [171, 0, 0, 0, 0, 0, 0]}]});
    let answer = socket.request(&outside.to_string());
    assert_error(&answer["error"], "limit", &["joint A1"], "outside");
    assert_eq!(rig.cabinet().position(), before);
    let answer = socket.request(r#"{"seq": 9, "type": "get_io", "name": "MediaFlange.LEDBlue"}"#);
    assert_eq!((&answer["seq"], &answer["value"]), (&json!(9), &json!(false)));
    rig.start_drive();
    rig.wait_until_ready();
    rig.client().run_trajectory(trajectory_to(1.0), Some(LONG)).unwrap();
}
