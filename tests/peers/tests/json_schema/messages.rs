//! Messages of the bridge.

#[path = "../../../../crates/bridge/iiwa-bridge/tests/sample_messages.rs"]
mod sample_messages;

use iiwa_bridge::message::schema;

use super::{assert_fits, validator};
use sample_messages::all;

#[test]
fn messages_are_as_the_schema_says() {
    let schema = validator(&schema());
    for message in all() {
        assert_fits(&schema, &serde_json::from_str(&message.to_json()).unwrap());
    }
}

#[test]
fn the_schema_rejects_invalid_messages() {
    let schema = validator(&schema());
    let good = serde_json::to_value(&all()[0]).unwrap();
    for (key, wrong) in [
        ("joints_rad", serde_json::json!([1, 2, 3])),
        ("kind", "flight".into()),
        ("version", 2.into()),
        ("seq", (-1).into()),
    ] {
        let mut bad = good.clone();
        bad[key] = wrong;
        assert!(!schema.is_valid(&bad), "{bad}");
    }
}
