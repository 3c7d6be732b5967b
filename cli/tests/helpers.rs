//! Programs for tests from outside.

use std::path::{Path, PathBuf};

pub(crate) fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures").join(name)
}

pub(crate) const START: &str = r#""start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] }"#;

pub(crate) fn program(motions: &str) -> String {
    format!("{{\n  \"version\": 1,\n  {START},\n  \"motions\": [\n    {motions}\n  ]\n}}\n")
}

/// `count` motions there and back again, all blended.
pub(crate) fn long_program(count: usize) -> String {
    let motion = |i: usize| {
        let a = if i.is_multiple_of(2) { 10 } else { -10 };
        let blend = if i + 1 < count { r#", "blend": { "fraction": 0.25 }"# } else { "" };
        format!(r#"{{ "type": "ptp", "joints_deg": [{a}, {}, 0, -60, 0, 90, 0]{blend} }}"#, i % 7)
    };
    program(&(0..count).map(motion).collect::<Vec<_>>().join(",\n"))
}
