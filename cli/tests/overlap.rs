//! Waits that overlap motions, and source lines of motions, in the output of `iiwasim plan`.

use std::fs;

use predicates::str::contains;
use tempfile::tempdir;

use crate::helpers::{figures, plan};

#[test]
fn says_which_blends_came_too_late_and_where_motions_come_from() {
    let folder = tempdir().unwrap();
    let motion = |a1: f64, line: u32| {
        serde_json::json!({
            "type": "ptp", "joints_deg": [a1, 30, 0, -60, 0, 90.0 - 0.5 * a1, 0],
            "blend": { "fraction": 0.2 },
            "source": { "file": "Weld.java", "line": line },
        })
    };
    let wait =
        |seconds: f64| serde_json::json!({ "type": "wait", "seconds": seconds, "overlap": true });
    let text = serde_json::json!({
        "version": 1,
        "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
        "motions": [
            motion(40.0, 41), wait(0.05), motion(0.0, 43), wait(2.0), motion(40.0, 45), wait(0.0)
        ],
    });
    let file = folder.path().join("overlap.json");
    fs::write(&file, text.to_string()).unwrap();
    let table = plan(&folder, &file, &[]).success();
    let table = String::from_utf8(table.get_output().stdout.clone()).unwrap();
    assert!(table.contains("source") && table.contains("Weld.java:43"), "{table}");
    assert!(table.contains("Blend after motion 3 missed: the next motion is known at "), "{table}");
    assert!(!table.contains("Blend after motion 1"), "{table}");

    let figures = figures(plan(&folder, &file, &["--json", "--no-output"]));
    let late = figures["blends_too_late"].as_array().unwrap();
    assert_eq!(late.len(), 1);
    assert_eq!(late[0]["after_motion"], 3);
    assert!(late[0]["known_s"].as_f64() > late[0]["needed_s"].as_f64());
    assert_eq!(
        figures["motions"][0]["source"],
        serde_json::json!({ "file": "Weld.java", "line": 41 })
    );
    let waited = figures["motions"]
        .as_array()
        .unwrap()
        .iter()
        .find(|motion| motion["type"] == "wait")
        .unwrap();
    assert_eq!(waited["index"], 4);
    let ends = [&waited["end_s"], &late[0]["known_s"]].map(|time_s| time_s.as_f64().unwrap());
    assert!((ends[0] - ends[1]).abs() < 1e-12, "{ends:?}");

    // Output for programs without them is unchanged.
    let mut plain = text.clone();
    for motion in plain["motions"].as_array_mut().unwrap() {
        let keys = motion.as_object_mut().unwrap();
        keys.retain(|key, _| !["source", "blend", "overlap"].contains(&key.as_str()));
    }
    let stops = folder.path().join("stops.json");
    fs::write(&stops, plain.to_string()).unwrap();
    let figures = self::figures(plan(&folder, &stops, &["--json", "--no-output"]));
    assert!(figures.get("blends_too_late").is_none());
    assert!(figures["motions"][0].get("source").is_none());

    let far = text.to_string().replace("[0.0,30", "[200.0,30");
    fs::write(&file, far).unwrap();
    plan(&folder, &file, &[]).failure().stderr(contains("motion 3 (Weld.java:43): joint A1"));
}
