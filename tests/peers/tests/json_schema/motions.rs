//! Motions of all kinds, read and written.

#[path = "../../../../crates/core/iiwa-path/tests/any_program.rs"]
mod any_program;

use iiwa_program::Program;
use proptest::prelude::*;
use serde_json::{Value, json};

use super::{assert_fits, validator};
use any_program::any_program;

/// A program as it is written.
fn written(program: &Program) -> Value {
    serde_json::from_str(&program.to_json()).unwrap()
}

proptest! {
    /// Written programs fit the schema.
    #[test]
    fn random_programs_fit(program in any_program()) {
        let json = written(&program);
        let result = jsonschema::validate(&Program::schema(), &json);
        prop_assert!(result.is_ok(), "{}: {}", result.unwrap_err(), json);
    }
}

#[test]
fn motions_to_frames_fit() {
    let text = include_str!("../../../../crates/core/iiwa-path/tests/every_motion.json");
    let schema = validator(&Program::schema());
    assert_fits(&schema, &serde_json::from_str(text).unwrap());
    assert_fits(&schema, &written(&Program::from_json(text).unwrap()));
}

#[test]
fn splines_fit_when_they_are_written() {
    let frame = |y_mm: f64, z_mm: f64| {
        let (x_mm, z_mm) = (500.0, 300.0 + z_mm);
        json!({ "x_mm": x_mm, "y_mm": y_mm, "z_mm": z_mm, "a_deg": 0, "b_deg": 180, "c_deg": 0 })
    };
    let circ = json!({
        "type": "circ", "frame": frame(-100.0, 0.0), "aux": frame(-60.0, 40.0),
        "circ_angle_deg": 200.0, "orientation_reference": "path"
    });
    let text = json!({
        "version": 1,
        "start": { "joints_deg": [0, 20, 0, -110, 0, -40, 90] },
        "motions": [
            { "type": "spl", "frame": frame(-60.0, -40.0) },
            {
                "type": "spline", "segments": [circ, { "type": "spl", "frame": frame(0.0, 0.0) }],
                "cart_velocity_mm_s": 100.0
            }
        ]
    });
    let program = Program::from_json(&text.to_string()).unwrap();
    assert_fits(&validator(&Program::schema()), &written(&program));
}
