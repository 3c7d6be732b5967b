//! Frames as people write them: a pose and what tells apart the joints that reach it.

use iiwa_json::{Object, Place, Step, locate, problem};
use iiwa_kin::{Joints, Pose, Redundancy, Robot, Status, Turn};
use serde::{Deserialize, Serialize};

use crate::failure::Failure;

/// Farther away, in mm, there is no robot.
const MAX_MM: f64 = 100_000.0;

/// A frame to be reached.
#[derive(Debug)]
pub(crate) struct TargetFrame {
    /// The flange in the robot's base.
    pub(crate) pose: Pose,
    pub(crate) e1_rad: Option<f64>,
    pub(crate) status: Option<Status>,
    pub(crate) turn: Option<Turn>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FrameWire {
    x_mm: f64,
    y_mm: f64,
    z_mm: f64,
    a_deg: Option<f64>,
    a_rad: Option<f64>,
    b_deg: Option<f64>,
    b_rad: Option<f64>,
    c_deg: Option<f64>,
    c_rad: Option<f64>,
    e1_deg: Option<f64>,
    e1_rad: Option<f64>,
    status: Option<u64>,
    turn: Option<u64>,
}

/// Part of a text, and what is wrong with it.
type Wrong<'a> = (Vec<Step<'a>>, String);

impl TargetFrame {
    /// Reads a frame; `name` is what the text is called in errors.
    pub(crate) fn read(text: &str, name: &str) -> Result<Self, Failure> {
        let Object(wire) = serde_json::from_str::<Object<FrameWire>>(text).map_err(|error| {
            Failure::in_text(&problem(&error), &Place::of_error(text, text, &error), name, text)
        })?;
        Self::new(&wire)
            .map_err(|(steps, what)| Failure::in_text(&what, &locate(text, &steps), name, text))
    }

    fn new(wire: &FrameWire) -> Result<Self, Wrong<'static>> {
        let position_mm = [("x_mm", wire.x_mm), ("y_mm", wire.y_mm), ("z_mm", wire.z_mm)];
        if let Some((key, _)) = position_mm.iter().find(|(_, value)| value.abs() > MAX_MM) {
            return Err((vec![Step::Key(key)], format!("the range is -{MAX_MM} to {MAX_MM} mm")));
        }
        let required = |keys: [&'static str; 2], deg, rad| {
            let missing = || (vec![], format!("the key `{}` is missing", keys[0]));
            angle(keys, deg, rad)?.ok_or_else(missing)
        };
        let abc_rad = [
            required(["a_deg", "a_rad"], wire.a_deg, wire.a_rad)?,
            required(["b_deg", "b_rad"], wire.b_deg, wire.b_rad)?,
            required(["c_deg", "c_rad"], wire.c_deg, wire.c_rad)?,
        ];
        let position_m = position_mm.map(|(_, value)| 1e-3 * value);
        Ok(Self {
            pose: Pose::from_xyz_abc(position_m, abc_rad),
            e1_rad: angle(["e1_deg", "e1_rad"], wire.e1_deg, wire.e1_rad)?,
            status: bits("status", 7, wire.status, Status::new)?,
            turn: bits("turn", 127, wire.turn, Turn::new)?,
        })
    }
}

/// An angle in rad, given in one unit or the other.
fn angle(
    keys: [&'static str; 2],
    deg: Option<f64>,
    rad: Option<f64>,
) -> Result<Option<f64>, Wrong<'static>> {
    if deg.is_some() && rad.is_some() {
        let what = format!("there are both `{}` and `{}`; one is enough", keys[0], keys[1]);
        return Err((vec![Step::Key(keys[1])], what));
    }
    Ok(deg.map(f64::to_radians).or(rad))
}

fn bits<T>(
    key: &'static str,
    most: u8,
    found: Option<u64>,
    new: fn(u8) -> Option<T>,
) -> Result<Option<T>, Wrong<'static>> {
    let Some(found) = found else { return Ok(None) };
    let read = u8::try_from(found).ok().and_then(new);
    let wrong = || (vec![Step::Key(key)], format!("the range of the {key} is 0 to {most}"));
    read.map(Some).ok_or_else(wrong)
}

/// The frame that the flange is at, in the robot's base: what [`TargetFrame::read`] reads.
#[derive(Serialize)]
pub(crate) struct ReachedFrame {
    pub(crate) x_mm: f64,
    pub(crate) y_mm: f64,
    pub(crate) z_mm: f64,
    pub(crate) a_deg: f64,
    pub(crate) b_deg: f64,
    pub(crate) c_deg: f64,
    pub(crate) e1_deg: f64,
    pub(crate) status: u8,
    pub(crate) turn: u8,
}

impl ReachedFrame {
    /// The frame at `joints_rad`.
    pub(crate) fn new(robot: &Robot, joints_rad: &Joints) -> Self {
        let pose = robot.flange_pose(joints_rad);
        let [x_mm, y_mm, z_mm] = pose.position_m.map(|v| 1e3 * v);
        let [a_deg, b_deg, c_deg] = pose.abc_rad().map(f64::to_degrees);
        let Redundancy { e1_rad, status, turn } = robot.redundancy(joints_rad);
        Self {
            x_mm,
            y_mm,
            z_mm,
            a_deg,
            b_deg,
            c_deg,
            e1_deg: e1_rad.to_degrees(),
            status: status.bits(),
            turn: turn.bits(),
        }
    }
}
