//! Invalid requests to the drive: each gets an error and has no other effect.

use iiwa_link::message::Request;
use serde_json::json;

use crate::link::{
    corrupted::{Corrupted, corrupted, fields_of, good_requests},
    invalid_requests::invalid_requests,
    request_socket::{RequestSocket, assert_error},
    rig::Rig,
};

#[test]
fn invalid_requests_get_an_error_and_have_no_effect() {
    let rig = Rig::new(5);
    let socket = RequestSocket::new(&rig.drive_config.instructions);
    let before = rig.cabinet().position();
    let assert_refused = |request: &str, code: &str, names: &[&str]| {
        let answer = socket.request(request);
        assert_eq!(answer["ok"], false, "{request}: {answer}");
        assert_error(&answer["error"], code, names, request);
        assert_eq!(socket.request(r#"{"type": "state"}"#)["state"], "idle", "{request}");
        assert_eq!(rig.cabinet().position().map(f64::to_bits), before.map(f64::to_bits));
    };
    let mut count = 0;
    for good in good_requests() {
        let name = good["type"].as_str().unwrap();
        let mut with_more = good.clone();
        with_more["speed"] = json!(1);
        assert_refused(&with_more.to_string(), "bad_request", &["`speed`"]);
        for Corrupted { message, name, .. } in corrupted(&good, &fields_of(name)) {
            assert_refused(
                &message.to_string(),
                "bad_request",
                &[&name, "column", "motion 1", "points", "no input or output", "true or false"],
            );
            count += 1;
        }
    }
    for (request, code, name) in invalid_requests() {
        assert_refused(&request, code, &[name]);
        count += 1;
    }
    for body in [b"\xff".as_slice(), b"{\"type\": \"st\xc3\"}", b"\0", b"\xef\xbb\xbf{}"] {
        let answer = socket.request_bytes(body);
        assert!(answer.contains("bad_request"), "{answer}");
    }
    assert!(count > 200, "{count}");

    assert_refused(r#"{"type": "last_run"}"#, "bad_request", &["no run"]);
    for good in good_requests() {
        let answer = socket.request(&good.to_string());
        assert_eq!(answer["ok"], true, "{good}: {answer}");
    }
    assert_eq!(good_requests().len(), Request::TYPES.len());
}

#[test]
fn ids_of_every_kind_are_returned() {
    let rig = Rig::new(5);
    let socket = RequestSocket::new(&rig.drive_config.instructions);
    let deep = format!("{}{}", "[".repeat(10_000), "]".repeat(10_000));
    let ids = [
        "null",
        "true",
        "-0.0",
        "12345678901234567890123",
        "1e5",
        r#""a\n\u0000""#,
        "[]",
        "[ 1,  2 ]",
        r#"{"b": {}, "a": null}"#,
        deep.as_str(),
    ];
    for id in ids {
        for rest in [
            r#""type": "state"}"#,
            r#""type": "read_sensors"}"#,
            r#""type": "get_io", "name": "x"}"#,
            r#""type": "state", "x": 1}"#,
            r#""type": "fly"}"#,
            r#""type": 3}"#,
            r#""type": "state", "type": "state"}"#,
            r#""types": []}"#,
        ] {
            let answer = socket.request_bytes(format!("{{\"id\": {id}, {rest}").as_bytes());
            assert!(answer.contains(&format!("\"id\":{id}")), "{id}, {rest}: {answer}");
        }
    }
    for without in [r#"{"type": "state"}"#, r#"{"type": 3}"#, r#"{"id": 1"#, "{", "7"] {
        assert!(!socket.request_bytes(without.as_bytes()).contains("\"id\""), "{without}");
    }
}
