//! Valid messages, and versions of them with an invalid field.

use iiwa_link::TimedJoints;
use serde_json::{Value, json};

use crate::link::runs::{sampled, to_command};

/// Values that are wrong for nearly all fields.
pub(crate) fn wrong_values() -> [Value; 8] {
    [
        Value::Null,
        json!(true),
        json!(3),
        json!(-0.5),
        json!("x"),
        json!([]),
        json!({}),
        json!([[[]]]),
    ]
}

/// A message field: its JSON pointer, its requirement, and the values of [`wrong_values`] that are
/// valid for it.
pub(crate) struct Field<'a>(
    pub(crate) &'a str,
    pub(crate) Requirement,
    pub(crate) &'static [&'static str],
);

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Requirement {
    Optional,
    Required,
}

pub(crate) const NUMBER: &[&str] = &["3", "-0.5"];

/// A message with an invalid field.
pub(crate) struct Corrupted {
    pub(crate) message: Value,
    /// The name of the field.
    pub(crate) name: String,
    /// Description of the change.
    pub(crate) change: String,
}

/// Returns messages in which each of these fields in turn is invalid or missing.
pub(crate) fn corrupted(good: &Value, fields: &[Field<'_>]) -> Vec<Corrupted> {
    let mut messages = Vec::new();
    for Field(path, requirement, valid) in fields {
        let (parent, name) = path.rsplit_once('/').unwrap();
        for value in wrong_values() {
            if !valid.contains(&value.to_string().as_str()) {
                let (mut message, change) = (good.clone(), format!("{path} is {value}"));
                *message.pointer_mut(path).expect(path) = value;
                messages.push(Corrupted { message, name: name.to_owned(), change });
            }
        }
        if *requirement == Requirement::Required {
            let mut message = good.clone();
            match message.pointer_mut(parent).unwrap() {
                Value::Object(object) => drop(object.remove(name)),
                Value::Array(list) => drop(list.remove(name.parse().unwrap())),
                _ => unreachable!(),
            }
            let change = format!("{path} is missing");
            messages.push(Corrupted { message, name: name.to_owned(), change });
        }
    }
    messages
}

/// Returns a trajectory of joint 1 to `deg`.
pub(crate) fn trajectory_to(deg: f64) -> TimedJoints {
    let mut target = [0.0; 7];
    target[0] = deg.to_radians();
    let motion = iiwa_program::Motion::Ptp(iiwa_program::Ptp::to(target));
    sampled(&to_command(vec![motion]), 0.004)
}

/// Returns a valid request of each type.
pub(crate) fn good_requests() -> Vec<Value> {
    let trajectory = trajectory_to(0.1);
    vec![
        json!({"type": "run_motions", "motions": [
            {"type": "ptp", "joints_deg": [1, 0, 0, 0, 0, 0, 0], "velocity_rel": 0.5,
             "acceleration_rel": 0.5, "jerk_rel": 0.5, "blend": {"fraction": 0.1}},
            {"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0]},
            {"type": "wait", "seconds": 0.01},
            {"type": "ptp", "frame": "near"},
            {"type": "lin_rel", "offset": {"z_mm": -5}, "in": "near", "cart_velocity_mm_s": 200},
            {"type": "ptp", "joints_rad": [0, 0, 0, 0, 0, 0, 0]},
        ],
            "tools": {"gripper": {"tcp": {"z_mm": 120}}}, "tool": "gripper",
            "bases": {"table": {"x_mm": 500}}, "base": "table",
            "frames": {"near": {"base": "table", "x_mm": 0, "y_mm": 0, "z_mm": 400,
                "a_deg": 0, "b_deg": 180, "c_deg": 0, "status": 2, "e1_deg": 0}},
            "mode": "t1"}),
        json!({"type": "run_trajectory", "trajectory": trajectory}),
        json!({"type": "read_sensors"}),
        json!({"type": "list_io"}),
        json!({"type": "get_io", "name": "MediaFlange.UserButton"}),
        json!({"type": "set_io", "name": "MediaFlange.LEDBlue", "value": true}),
        json!({"type": "state"}),
        json!({"type": "last_run"}),
        json!({"type": "stop"}),
    ]
}

pub(crate) fn fields_of(name: &str) -> Vec<Field<'static>> {
    use Requirement::{Optional, Required};
    let fields = match name {
        "run_motions" => vec![
            Field("/motions", Required, &[]),
            Field("/motions/0", Optional, &[]),
            Field("/motions/0/type", Required, &[]),
            Field("/motions/0/joints_deg", Required, &[]),
            Field("/motions/0/joints_deg/3", Required, NUMBER),
            Field("/motions/0/velocity_rel", Optional, &[]),
            Field("/motions/0/acceleration_rel", Optional, &[]),
            Field("/motions/0/jerk_rel", Optional, &[]),
            Field("/motions/0/blend", Optional, &["null"]),
            Field("/motions/0/blend/fraction", Required, &[]),
            Field("/motions/1/joints_rad", Required, &[]),
            Field("/motions/2/type", Required, &[]),
            Field("/motions/2/seconds", Required, &["3"]),
            Field("/motions/3/frame", Required, &[]),
            Field("/motions/4/offset", Required, &["{}"]),
            Field("/motions/4/offset/z_mm", Optional, &["3", "-0.5", "null"]),
            Field("/motions/4/in", Optional, &["null"]),
            Field("/motions/4/cart_velocity_mm_s", Optional, &["3", "null"]),
            Field("/tools", Required, &[]),
            Field("/tools/gripper", Required, &[]),
            Field("/tools/gripper/tcp", Required, &["{}"]),
            Field("/tools/gripper/tcp/z_mm", Optional, &["3", "-0.5", "null"]),
            Field("/tool", Optional, &["null"]),
            Field("/bases", Required, &[]),
            Field("/bases/table", Required, &["{}"]),
            Field("/bases/table/x_mm", Optional, &["3", "-0.5", "null"]),
            Field("/base", Optional, &["null"]),
            Field("/frames", Required, &[]),
            Field("/frames/near", Required, &[]),
            Field("/frames/near/base", Optional, &["null"]),
            Field("/frames/near/x_mm", Required, NUMBER),
            Field("/frames/near/status", Optional, &["3", "null"]),
            Field("/mode", Optional, &["null"]),
        ],
        "run_trajectory" => vec![
            Field("/trajectory", Required, &[]),
            Field("/trajectory/t_s", Required, &[]),
            Field("/trajectory/t_s/2", Required, NUMBER),
            Field("/trajectory/joints_rad", Required, &[]),
            Field("/trajectory/joints_rad/2", Required, &[]),
            Field("/trajectory/joints_rad/2/6", Required, NUMBER),
        ],
        "get_io" => vec![Field("/name", Required, &[])],
        "set_io" => vec![Field("/name", Required, &[]), Field("/value", Required, &["true"])],
        _ => Vec::new(),
    };
    [Field("/type", Required, &[])].into_iter().chain(fields).collect()
}
