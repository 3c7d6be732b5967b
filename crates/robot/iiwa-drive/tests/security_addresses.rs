//! Addresses that require keys.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_drive::{Drive, DriveConfig};
use iiwa_link::{
    Client, LinkError, Remote, Server,
    security::{Endpoint, SecurityError},
};

fn endpoint(text: &str) -> Endpoint {
    text.parse().unwrap()
}

#[test]
fn loopback_addresses_require_no_keys() {
    let loopback = [
        "tcp://127.0.0.1:5560",
        "127.0.0.1:5560",
        "tcp://127.8.9.10:1",
        "localhost:5560",
        "tcp://LOCALHOST:65535",
        "tcp://[::1]:5560",
        "127.0.0.1:*",
    ];
    for text in loopback {
        assert!(endpoint(text).is_loopback(), "{text}");
        endpoint(text).check_bind(false).unwrap();
    }
    let public = [
        "tcp://0.0.0.0:5560",
        "tcp://*:5560",
        "*:*",
        "192.168.1.7:5560",
        "tcp://eth0:5560",
        "lo:5560",
        "robot.example:5560",
        "localhost.example:5560",
        "localhost.:5560",
        "127.1:5560",
        "tcp://[::]:5560",
        "tcp://[::ffff:127.0.0.1]:5560",
        "tcp://[fe80::1]:5560",
        "128.0.0.1:5560",
    ];
    for text in public {
        assert!(!endpoint(text).is_loopback(), "{text}");
        let error = endpoint(text).check_bind(false).unwrap_err();
        assert!(matches!(error, SecurityError::BindNeedsKeys { .. }), "{error}");
        let message = error.to_string();
        assert!(message.contains("CURVE keys are required"), "{message}");
        endpoint(text).check_bind(true).unwrap();
        assert!(endpoint(text).check_connect(false).is_err(), "{text}");
    }
    endpoint("robot.example:5560").check_connect(true).unwrap();
    let message = endpoint("robot.example:5560").check_connect(false).unwrap_err().to_string();
    assert!(message.contains("CURVE keys are required"), "{message}");
    for text in ["*:5560", "127.0.0.1:*"] {
        let error = endpoint(text).check_connect(true).unwrap_err();
        assert!(matches!(error, SecurityError::Address { .. }), "{error}");
    }
}

#[test]
fn endpoints_are_printed_in_canonical_form() {
    assert_eq!(endpoint("localhost:5560").to_string(), "tcp://127.0.0.1:5560");
    assert_eq!(endpoint("[0:0::1]:5560").to_string(), "tcp://[::1]:5560");
    assert_eq!(endpoint("robot.example:05560").to_string(), "tcp://robot.example:5560");
    assert_eq!(endpoint("*:*").to_string(), "tcp://*:*");
}

#[test]
fn invalid_addresses_are_refused() {
    let cases = [
        ("ipc:///tmp/drive", "only tcp://"),
        ("inproc://drive", "only tcp://"),
        ("TCP://127.0.0.1:5560", "only tcp://"),
        ("127.0.0.1", "HOST:PORT"),
        ("", "HOST:PORT"),
        (":5560", "HOST is"),
        ("127.0.0.1:", "a port"),
        ("127.0.0.1:0", "a port"),
        ("127.0.0.1:65536", "a port"),
        ("127.0.0.1:+5", "a port"),
        ("127.0.0.1:5560 ", "a port"),
        ("::1:5560", "brackets"),
        ("[::1%lo]:5560", "brackets"),
        ("127.0.0.1;10.0.0.1:5560", "HOST is"),
        ("10.0.0.1:1;127.0.0.1:5560", "brackets"),
        ("a b:5560", "HOST is"),
        ("127.0.0.1\0x:5560", "HOST is"),
    ];
    for (text, expected) in cases {
        let error = text.parse::<Endpoint>().unwrap_err().to_string();
        assert!(error.contains(expected), "{text:?}: {error}");
        assert!(!error.contains('\0'));
    }
}

#[test]
fn sockets_enforce_the_rule() {
    let config = |instructions: &str| {
        let mut config = DriveConfig::default();
        config.instructions = instructions.to_owned();
        config.stream = "tcp://127.0.0.1:*".into();
        config.fri = "127.0.0.1:0".parse().unwrap();
        config
    };
    let start = |address: &str| Drive::start(config(address), &Server::open(), &Remote::open());
    let error = start("0.0.0.0:*").unwrap_err();
    assert!(matches!(error, LinkError::Security(SecurityError::BindNeedsKeys { .. })), "{error}");
    let drive = start("localhost:*").unwrap();
    assert!(drive.instructions().starts_with("tcp://127.0.0.1:"), "{}", drive.instructions());

    let error = start(drive.instructions()).unwrap_err();
    assert!(matches!(error, LinkError::Bind { .. }), "{error}");
    assert!(error.to_string().contains(drive.instructions()));

    let error = Client::new(&Remote::open(), "10.0.0.1:5560").unwrap_err();
    assert!(
        matches!(error, LinkError::Security(SecurityError::ConnectNeedsKeys { .. })),
        "{error}"
    );
}
