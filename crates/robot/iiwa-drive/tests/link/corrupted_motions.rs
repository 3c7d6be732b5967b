//! TCP motions with all their keys, and invalid values of each key.

use serde_json::{Value, json};

use crate::link::corrupted::{
    Corrupted, Field, NUMBER,
    Requirement::{self, Optional, Required},
    corrupted,
};

/// A key within a motion, its requirement, and the values that are valid for it.
type Key = (&'static str, Requirement, &'static [&'static str]);

const NULL: &[&str] = &["null"];
/// Valid values of an optional number.
const MAYBE: &[&str] = &["3", "-0.5", "null"];
/// Valid values of a limit.
const LIMIT: &[&str] = &["3", "null"];

/// A list of motions with many keys, and the keys to be corrupted.
struct Sample {
    kind: &'static str,
    list: Value,
    /// Path prefix of each key, such as `/motions/0`.
    prefix: &'static str,
    keys: Vec<Key>,
}

fn samples() -> Vec<Sample> {
    let frame = json!({"x_mm": 0, "y_mm": 0, "z_mm": 0, "a_deg": 0, "b_deg": 0, "c_deg": 0});
    let one = |kind, motion: Value, keys| Sample {
        kind,
        list: json!({"motions": [motion]}),
        prefix: "/motions/0",
        keys,
    };
    let mut full = frame.clone();
    for (key, value) in [("e1_deg", 0), ("status", 2), ("turn", 0)] {
        full[key] = json!(value);
    }
    full["base"] = json!("robot");
    let mut samples = vec![
        one(
            "lin",
            json!({"type": "lin", "frame": full, "tool": "flange", "base": "robot",
                "orientation": "constant",
                "velocity_rel": 0.5, "acceleration_rel": [1, 1, 1, 1, 1, 1, 1], "jerk_rel": 0.5,
                "cart_velocity_mm_s": 1, "cart_acceleration_mm_s2": 1, "cart_jerk_mm_s3": 1,
                "orientation_velocity_deg_s": 1, "orientation_acceleration_deg_s2": 1,
                "orientation_jerk_deg_s3": 1,
                "blend": {"cart_mm": 5, "ori_deg": 5, "sunrise_rel": 0.1}}),
            lin_keys(),
        ),
        one(
            "ptp",
            json!({"type": "ptp", "frame": frame, "tool": "flange", "base": "robot",
                "velocity_rel": [1, 1, 1, 1, 1, 1, 1], "blend": {"cart_mm": 5}}),
            vec![
                ("type", Required, &[]),
                ("frame", Required, &[]),
                ("frame/x_mm", Required, NUMBER),
                ("frame/b_deg", Required, NUMBER),
                ("tool", Optional, NULL),
                ("base", Optional, NULL),
                ("velocity_rel", Optional, &[]),
                ("velocity_rel/6", Required, &[]),
                ("blend", Optional, NULL),
                ("blend/cart_mm", Required, &["3"]),
            ],
        ),
        one(
            "lin_rel",
            json!({"type": "lin_rel", "offset": {"x_mm": 1, "y_mm": 1, "z_mm": 1, "a_deg": 1,
                "b_rad": 0.1, "c_deg": 1}, "in": frame, "e1_deg": 0, "tool": "flange",
                "base": "robot", "orientation": "variable", "velocity_rel": 1,
                "cart_velocity_mm_s": 1, "blend": {"ori_deg": 5}}),
            vec![
                ("offset", Required, &["{}"]),
                ("offset/x_mm", Optional, MAYBE),
                ("offset/y_mm", Optional, MAYBE),
                ("offset/a_deg", Optional, MAYBE),
                ("offset/b_rad", Optional, MAYBE),
                ("in", Optional, NULL),
                ("in/x_mm", Required, NUMBER),
                ("in/c_deg", Required, NUMBER),
                ("e1_deg", Optional, MAYBE),
                ("tool", Optional, NULL),
                ("base", Optional, NULL),
                ("orientation", Optional, &[]),
                ("velocity_rel", Optional, NULL),
                ("cart_velocity_mm_s", Optional, LIMIT),
                ("blend/ori_deg", Optional, LIMIT),
            ],
        ),
        one(
            "circ",
            json!({"type": "circ", "aux": frame, "frame": frame, "circ_angle_deg": 90,
                "orientation_reference": "path", "aux_orientation": "ignore",
                "end_orientation": "extrapolate", "orientation": "variable", "tool": "flange",
                "base": "robot", "cart_velocity_mm_s": 1, "orientation_jerk_deg_s3": 1,
                "blend": {"cart_mm": 5}}),
            vec![
                ("aux", Required, &[]),
                ("aux/x_mm", Required, NUMBER),
                ("aux/a_deg", Required, NUMBER),
                ("frame", Required, &[]),
                ("frame/z_mm", Required, NUMBER),
                ("circ_angle_deg", Optional, MAYBE),
                ("orientation_reference", Optional, &[]),
                ("aux_orientation", Optional, &[]),
                ("end_orientation", Optional, &[]),
                ("orientation", Optional, &[]),
                ("tool", Optional, NULL),
                ("base", Optional, NULL),
                ("cart_velocity_mm_s", Optional, LIMIT),
                ("orientation_jerk_deg_s3", Optional, LIMIT),
                ("blend", Optional, NULL),
                ("blend/cart_mm", Optional, LIMIT),
            ],
        ),
    ];
    samples.extend([spl(&frame), wait(), load(), spline(&frame), workcell(&frame)]);
    samples
}

fn lin_keys() -> Vec<Key> {
    let mut keys: Vec<Key> = vec![
        ("type", Required, &[]),
        ("frame", Required, &[]),
        ("frame/x_mm", Required, NUMBER),
        ("frame/y_mm", Required, NUMBER),
        ("frame/z_mm", Required, NUMBER),
        ("frame/a_deg", Required, NUMBER),
        ("frame/b_deg", Required, NUMBER),
        ("frame/c_deg", Required, NUMBER),
        ("frame/e1_deg", Optional, MAYBE),
        ("frame/status", Optional, LIMIT),
        ("frame/turn", Optional, LIMIT),
        ("frame/base", Optional, NULL),
        ("tool", Optional, NULL),
        // The frame has its own base.
        ("base", Optional, &["null", "\"x\""]),
        ("orientation", Optional, &[]),
        ("velocity_rel", Optional, NULL),
        ("acceleration_rel", Optional, NULL),
        ("acceleration_rel/3", Required, &[]),
        ("jerk_rel", Optional, NULL),
        ("blend", Optional, NULL),
        ("blend/cart_mm", Optional, LIMIT),
        ("blend/ori_deg", Optional, LIMIT),
        // Ignored in the presence of `cart_mm`.
        ("blend/sunrise_rel", Optional, MAYBE),
    ];
    keys.extend(
        [
            "cart_velocity_mm_s",
            "cart_acceleration_mm_s2",
            "cart_jerk_mm_s3",
            "orientation_velocity_deg_s",
            "orientation_acceleration_deg_s2",
            "orientation_jerk_deg_s3",
        ]
        .map(|key| (key, Optional, LIMIT)),
    );
    keys
}

fn spl(frame: &Value) -> Sample {
    Sample {
        kind: "spl",
        list: json!({"motions": [{"type": "spl", "frame": frame, "tool": "flange", "base": "robot",
            "orientation": "constant", "jerk_rel": 1, "blend": {"cart_mm": 5}}]}),
        prefix: "/motions/0",
        keys: vec![
            ("frame", Required, &[]),
            ("frame/y_mm", Required, NUMBER),
            ("tool", Optional, NULL),
            ("base", Optional, NULL),
            ("orientation", Optional, &[]),
            ("jerk_rel", Optional, NULL),
            ("blend/cart_mm", Optional, LIMIT),
        ],
    }
}

fn wait() -> Sample {
    Sample {
        kind: "wait",
        list: json!({"motions": [{"type": "wait", "seconds": 1}]}),
        prefix: "/motions/0",
        keys: vec![("type", Required, &[]), ("seconds", Required, &["3"])],
    }
}

fn load() -> Sample {
    Sample {
        kind: "load",
        list: json!({"motions": [{"type": "load", "load": {"mass_kg": 1, "center_mm": [0, 0, 1],
            "inertia_kg_m2": [0, 0, 0], "abc_deg": [0, 0, 0]}}]}),
        prefix: "/motions/0",
        keys: vec![
            ("type", Required, &[]),
            ("load", Required, NULL),
            ("load/mass_kg", Required, &["3"]),
            ("load/center_mm", Optional, &[]),
            ("load/center_mm/1", Required, NUMBER),
            ("load/inertia_kg_m2", Optional, &[]),
            ("load/inertia_kg_m2/2", Required, &["3"]),
            ("load/abc_deg", Optional, &[]),
            ("load/abc_deg/0", Required, NUMBER),
        ],
    }
}

fn spline(frame: &Value) -> Sample {
    Sample {
        kind: "spline",
        list: json!({"motions": [{"type": "spline", "segments": [
            {"type": "lin", "frame": frame, "orientation": "ignore", "velocity_rel": 1,
             "cart_velocity_mm_s": 1},
            {"type": "circ", "aux": frame, "frame": frame, "circ_angle_deg": 90,
             "orientation_reference": "base", "aux_orientation": "consider",
             "end_orientation": "interpolate"}],
            "tool": "flange", "base": "robot", "orientation": "variable",
            "acceleration_rel": 1, "blend": {"cart_mm": 5}}]}),
        prefix: "/motions/0",
        keys: vec![
            ("segments", Required, &[]),
            ("segments/0", Optional, &[]),
            ("segments/0/type", Required, &[]),
            ("segments/0/frame", Required, &[]),
            ("segments/0/frame/y_mm", Required, NUMBER),
            ("segments/0/orientation", Optional, NULL),
            ("segments/0/velocity_rel", Optional, NULL),
            ("segments/0/cart_velocity_mm_s", Optional, LIMIT),
            ("segments/1/aux", Required, &[]),
            ("segments/1/aux/b_deg", Required, NUMBER),
            ("segments/1/circ_angle_deg", Optional, MAYBE),
            ("segments/1/orientation_reference", Optional, &[]),
            ("segments/1/aux_orientation", Optional, &[]),
            ("segments/1/end_orientation", Optional, &[]),
            ("tool", Optional, NULL),
            ("base", Optional, NULL),
            ("orientation", Optional, &[]),
            ("acceleration_rel", Optional, NULL),
            ("blend", Optional, NULL),
            ("blend/cart_mm", Optional, LIMIT),
        ],
    }
}

/// Returns tools, bases and frames, all of which the motion uses.
fn workcell(frame: &Value) -> Sample {
    let mut named = frame.clone();
    for (key, value) in [("e1_rad", json!(0)), ("status", json!(2)), ("turn", json!(0))] {
        named[key] = value;
    }
    named["base"] = json!("tray");
    Sample {
        kind: "names",
        list: json!({"motions": [{"type": "ptp", "frame": "pick"}],
            "tools": {"hand": {"tcp": {"z_mm": 120, "a_rad": 1},
                "tips": {"left": {"x_mm": 5, "b_deg": 1}},
                "load": {"mass_kg": 1, "center_mm": [0, 0, 1], "inertia_kg_m2": [0, 0, 0],
                    "abc_deg": [0, 0, 0]}}},
            "bases": {"table": {"x_mm": 500, "c_deg": 1}, "tray": {"base": "table", "y_mm": 5}},
            "frames": {"pick": named}, "tool": "hand/left", "base": "tray", "mode": "t1",
            "mount": {"rpy_deg": [180, 0, 0]}}),
        prefix: "",
        keys: vec![
            ("tools", Required, &[]),
            ("tools/hand", Required, &[]),
            ("tools/hand/tcp", Required, &["{}"]),
            ("tools/hand/tcp/z_mm", Optional, MAYBE),
            ("tools/hand/tcp/a_rad", Optional, MAYBE),
            ("tools/hand/tips", Required, &[]),
            ("tools/hand/tips/left", Required, &["{}"]),
            ("tools/hand/tips/left/x_mm", Optional, MAYBE),
            ("tools/hand/tips/left/b_deg", Optional, MAYBE),
            ("tools/hand/load", Optional, NULL),
            ("tools/hand/load/mass_kg", Required, &["3"]),
            ("tools/hand/load/center_mm", Optional, &[]),
            ("tools/hand/load/center_mm/1", Required, NUMBER),
            ("tools/hand/load/inertia_kg_m2", Optional, &[]),
            ("tools/hand/load/inertia_kg_m2/2", Required, NUMBER),
            ("tools/hand/load/abc_deg", Optional, &[]),
            ("tools/hand/load/abc_deg/0", Required, NUMBER),
            ("bases", Required, &[]),
            ("bases/table", Required, &["{}"]),
            ("bases/table/x_mm", Optional, MAYBE),
            ("bases/table/c_deg", Optional, MAYBE),
            ("bases/tray/base", Optional, NULL),
            ("bases/tray/y_mm", Optional, MAYBE),
            ("frames", Required, &[]),
            ("frames/pick", Required, &[]),
            ("frames/pick/x_mm", Required, NUMBER),
            ("frames/pick/y_mm", Required, NUMBER),
            ("frames/pick/z_mm", Required, NUMBER),
            ("frames/pick/a_deg", Required, NUMBER),
            ("frames/pick/b_deg", Required, NUMBER),
            ("frames/pick/c_deg", Required, NUMBER),
            ("frames/pick/e1_rad", Optional, MAYBE),
            ("frames/pick/status", Optional, LIMIT),
            ("frames/pick/turn", Optional, LIMIT),
            ("frames/pick/base", Optional, NULL),
            ("motions/0/frame", Required, &[]),
            ("tool", Optional, NULL),
            ("base", Optional, NULL),
            ("mode", Optional, NULL),
            ("mount", Optional, NULL),
            ("mount/rpy_deg", Required, &[]),
            ("mount/rpy_deg/1", Required, NUMBER),
        ],
    }
}

/// Returns lists of motions with an invalid, missing, unknown or duplicate key: the name of the
/// row, the keys that a message may name, and the text of the object.
pub(crate) fn corrupted_motions() -> Vec<(String, Vec<String>, String)> {
    let mut rows = Vec::new();
    for Sample { kind, list, prefix, keys } in samples() {
        let paths: Vec<String> = keys.iter().map(|(path, ..)| format!("{prefix}/{path}")).collect();
        let fields: Vec<Field<'_>> = (paths.iter().zip(&keys))
            .map(|(path, (_, requirement, valid))| Field(path, *requirement, valid))
            .collect();
        for Corrupted { message, change, .. } in corrupted(&list, &fields) {
            let (path, _) = change.split_once(' ').unwrap();
            rows.push((format!("{kind}: {change}"), names(path), message.to_string()));
        }
        for (path, object) in objects(&list, String::new()) {
            let names_are_free = ["/tools", "/bases", "/frames", "/tools/hand/tips"];
            if !path.is_empty() && !names_are_free.contains(&path.as_str()) {
                let mut more = list.clone();
                more.pointer_mut(&path).unwrap()["speed"] = json!(1);
                let name = vec!["speed".to_owned()];
                rows.push((format!("{kind}: {path}/speed"), name, more.to_string()));
            }
            for key in object.as_object().unwrap().keys() {
                let text = with_doubled(&list, &path, key);
                rows.push((format!("{kind}: {path}/{key} twice"), vec![key.clone()], text));
            }
        }
    }
    rows
}

/// Returns the last key of a path, or the list and the index in it.
fn names(path: &str) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for name in path.rsplit('/') {
        names.push(name.to_owned());
        if name.parse::<usize>().is_err() {
            break;
        }
    }
    names
}

/// Returns all objects in a value, by their JSON pointers.
fn objects(value: &Value, path: String) -> Vec<(String, Value)> {
    let inner: Vec<(String, &Value)> = match value {
        Value::Object(object) => object.iter().map(|(key, value)| (key.clone(), value)).collect(),
        Value::Array(list) => (0..).map(|i: usize| i.to_string()).zip(list).collect(),
        _ => Vec::new(),
    };
    let inner = inner.into_iter().flat_map(|(key, value)| objects(value, format!("{path}/{key}")));
    let inner: Vec<_> = inner.collect();
    let entry = value.is_object().then(|| (path, value.clone()));
    entry.into_iter().chain(inner).collect()
}

/// Returns the text of `good` in which the object at `path` has `key` twice.
pub(crate) fn with_doubled(good: &Value, path: &str, key: &str) -> String {
    const PLACE: &str = "the doubled key";
    let mut marked = good.clone();
    let object = marked.pointer_mut(path).unwrap();
    let value = object[key].clone();
    object[PLACE] = value.clone();
    marked.to_string().replace(&format!("\"{PLACE}\""), &format!("\"{key}\""))
}
