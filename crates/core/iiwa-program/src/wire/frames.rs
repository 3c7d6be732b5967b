//! JSON form of frames, tools and bases.

use std::{collections::BTreeMap, fmt};

use iiwa_json::{excerpt, object, object_or_null};
use iiwa_kin::Status;
use schemars::JsonSchema;
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{MapAccess, Visitor, value::MapAccessDeserializer},
};
use serde_json::{Value, json};

use super::{by_name::by_name, shapes::LoadWire};
use crate::{
    target::{Frame, Target, TargetRef},
    workcell::{Base, FLANGE, ROBOT, Tool, Workcell},
};

/// Name of the TCP itself as the reference of an offset.
pub(super) const TCP: &str = "tcp";

/// Declares a type with the keys of a pose and further keys.
macro_rules! pose_wire {
    ($(#[$meta:meta])* $name:ident { $($(#[$field_meta:meta])* $field:ident: $type:ty,)* }) => {
        #[derive(Default, Deserialize, Serialize, JsonSchema)]
        $(#[$meta])*
        #[serde(deny_unknown_fields)]
        pub(super) struct $name {
            /// Origin, in mm.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            x_mm: Option<f64>,
            /// Origin, in mm.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            y_mm: Option<f64>,
            /// Origin, in mm.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            z_mm: Option<f64>,
            /// Angle about z, in degrees: R = Rz(a) Ry(b) Rx(c).
            #[serde(default, skip_serializing_if = "Option::is_none")]
            a_deg: Option<f64>,
            /// Angle about the new y, in degrees.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            b_deg: Option<f64>,
            /// Angle about the new x, in degrees.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            c_deg: Option<f64>,
            /// Angle about z, in rad.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            a_rad: Option<f64>,
            /// Angle about the new y, in rad.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            b_rad: Option<f64>,
            /// Angle about the new x, in rad.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            c_rad: Option<f64>,
            $($(#[$field_meta])* $field: $type,)*
        }

        impl $name {
            /// Converts to a frame; absent numbers are zero unless `needs_all`.
            fn given_frame(&self, needs_all: bool) -> Result<Frame, String> {
                let xyz_mm = [self.x_mm, self.y_mm, self.z_mm];
                let abc_deg = [self.a_deg, self.b_deg, self.c_deg];
                let abc_rad = [self.a_rad, self.b_rad, self.c_rad];
                frame_of(xyz_mm, abc_deg, abc_rad, needs_all)
            }
        }

        impl From<&Frame> for $name {
            fn from(frame: &Frame) -> Self {
                let [x, y, z] = frame.xyz_mm.map(Some);
                let [a, b, c] = frame.abc_rad.map(Some);
                Self { x_mm: x, y_mm: y, z_mm: z, a_rad: a, b_rad: b, c_rad: c, ..Self::default() }
            }
        }
    };
}

/// Frame of the given numbers of a pose; absent numbers are zero unless `needs_all`.
fn frame_of(
    xyz_mm: [Option<f64>; 3],
    abc_deg: [Option<f64>; 3],
    abc_rad: [Option<f64>; 3],
    needs_all: bool,
) -> Result<Frame, String> {
    let mut frame = Frame::default();
    let mut missing = Vec::new();
    for i in 0..3 {
        let length = ["x_mm", "y_mm", "z_mm"][i];
        frame.xyz_mm[i] = xyz_mm[i].unwrap_or_else(|| {
            missing.push(length);
            0.0
        });
    }
    for i in 0..3 {
        let angle = ["a", "b", "c"][i];
        frame.abc_rad[i] = match (abc_deg[i], abc_rad[i]) {
            (Some(_), Some(_)) => {
                return Err(format!("give either `{angle}_deg` or `{angle}_rad`, not both"));
            }
            (Some(deg), None) => deg.to_radians(),
            (None, Some(rad)) => rad,
            (None, None) => {
                missing.push(["a_deg", "b_deg", "c_deg"][i]);
                0.0
            }
        };
    }
    if needs_all && !missing.is_empty() { Err(missing_keys(&missing)) } else { Ok(frame) }
}

/// Message about missing keys, at least one.
fn missing_keys(keys: &[&str]) -> String {
    let quoted: Vec<String> = keys.iter().map(|key| format!("`{key}`")).collect();
    match quoted.as_slice() {
        [all @ .., last] if !all.is_empty() => {
            format!("{} and {last} are missing", all.join(", "))
        }
        keys => format!("{} is missing", keys.concat()),
    }
}

pose_wire! {
    /// A pose; absent numbers are 0.
    #[schemars(rename = "Pose", extend("not" = twice(&["a", "b", "c"])))]
    PoseWire {}
}

pose_wire! {
    /// A reference frame for other frames; absent numbers are 0.
    #[schemars(rename = "Base", extend("not" = twice(&["a", "b", "c"])))]
    BaseWire {
        /// Base in which this base is given; `robot`, the robot base, by default.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        base: Option<String>,
    }
}

pose_wire! {
    /// A target frame: all of x, y, z, a, b and c.
    #[schemars(
        rename = "Target",
        extend(
            "required" = ["x_mm", "y_mm", "z_mm"],
            "allOf" = once(&["a", "b", "c"]),
            "not" = twice(&["e1"])
        )
    )]
    TargetWire {
        /// Base in which the frame is given.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        base: Option<String>,
        /// Position of joint A3 at the target, in degrees; as at the start of the motion by
        /// default.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        e1_deg: Option<f64>,
        /// Position of joint A3 at the target, in rad.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        e1_rad: Option<f64>,
        /// Sunrise's status, 0 to 7: 1 if the wrist is behind A1, 2 if A4 and 4 if A6 is negative.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0, max = 7))]
        status: Option<u8>,
        /// Sunrise's turn, 0 to 127: signs of all joint positions, 1 for A1.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 0, max = 127))]
        turn: Option<u8>,
    }
}

/// Schema of objects that give one of some angles both in degrees and in rad.
fn twice(angles: &[&str]) -> Value {
    let both =
        |angle: &&str| json!({ "required": [format!("{angle}_deg"), format!("{angle}_rad")] });
    json!({ "anyOf": angles.iter().map(both).collect::<Vec<_>>() })
}

/// Schemas of objects that give each of some angles in degrees or in rad.
fn once(angles: &[&str]) -> Value {
    let one_unit = |angle: &&str| {
        let required =
            ["deg", "rad"].map(|unit| json!({ "required": [format!("{angle}_{unit}")] }));
        json!({ "oneOf": required })
    };
    angles.iter().map(one_unit).collect()
}

impl PoseWire {
    pub(super) fn frame(&self) -> Result<Frame, String> {
        self.given_frame(false)
    }
}

impl TargetWire {
    pub(super) fn target(self) -> Result<Target, String> {
        let frame = self.given_frame(true)?;
        let e1_rad = match (self.e1_deg, self.e1_rad) {
            (Some(_), Some(_)) => {
                return Err("give either `e1_deg` or `e1_rad`, not both".to_owned());
            }
            (deg, rad) => deg.map(f64::to_radians).or(rad),
        };
        let status = match self.status {
            Some(bits) => {
                Some(Status::new(bits).ok_or(format!("status is {bits}; it must be from 0 to 7"))?)
            }
            None => None,
        };
        match self.turn {
            Some(turn) if turn > 127 => Err(format!("turn is {turn}; it must be from 0 to 127")),
            turn => Ok(Target { frame, base: self.base, e1_rad, status, turn }),
        }
    }
}

impl From<&Target> for TargetWire {
    fn from(target: &Target) -> Self {
        Self {
            base: target.base.clone(),
            e1_rad: target.e1_rad,
            status: target.status.map(Status::bits),
            turn: target.turn,
            ..Self::from(&target.frame)
        }
    }
}

/// A target frame, or the name of one.
#[derive(Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "TargetOrName")]
pub(super) enum TargetRefWire {
    /// Name of one of `frames`.
    Named(String),
    Given(TargetWire),
}

impl Default for TargetRefWire {
    fn default() -> Self {
        Self::Named(String::new())
    }
}

impl<'de> Deserialize<'de> for TargetRefWire {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        struct NameOrObject;
        impl<'de> Visitor<'de> for NameOrObject {
            type Value = TargetRefWire;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a frame, or the name of one")
            }
            fn visit_str<E>(self, name: &str) -> Result<TargetRefWire, E> {
                Ok(TargetRefWire::Named(name.to_owned()))
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<TargetRefWire, A::Error> {
                TargetWire::deserialize(MapAccessDeserializer::new(map)).map(TargetRefWire::Given)
            }
        }
        reader.deserialize_any(NameOrObject)
    }
}

impl TargetRefWire {
    pub(super) fn target(self) -> Result<TargetRef, String> {
        match self {
            Self::Named(name) => Ok(TargetRef::Named(name)),
            Self::Given(target) => target.target().map(TargetRef::Given),
        }
    }
}

impl From<&TargetRef> for TargetRefWire {
    fn from(target: &TargetRef) -> Self {
        match target {
            TargetRef::Named(name) => Self::Named(name.clone()),
            TargetRef::Given(target) => Self::Given(target.into()),
        }
    }
}

/// An auxiliary frame, its position alone, or the name of a frame.
#[derive(Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "AuxFrame")]
pub(super) enum AuxRefWire {
    /// Name of one of `frames`.
    Named(String),
    Given(TargetWire),
    Point(PointWire),
}

/// The position of an auxiliary frame. Without an orientation, `aux_orientation` is `ignore`.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Point", deny_unknown_fields)]
pub(super) struct PointWire {
    /// Position, in mm.
    x_mm: f64,
    /// Position, in mm.
    y_mm: f64,
    /// Position, in mm.
    z_mm: f64,
    /// Base in which the position is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    base: Option<String>,
}

impl Default for AuxRefWire {
    fn default() -> Self {
        Self::Named(String::new())
    }
}

impl<'de> Deserialize<'de> for AuxRefWire {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        let target = match TargetRefWire::deserialize(reader)? {
            TargetRefWire::Named(name) => return Ok(Self::Named(name)),
            TargetRefWire::Given(target) => target,
        };
        let TargetWire { a_deg, b_deg, c_deg, a_rad, b_rad, c_rad, e1_deg, e1_rad, .. } = target;
        let angles = [a_deg, b_deg, c_deg, a_rad, b_rad, c_rad, e1_deg, e1_rad];
        let has_others =
            target.status.or(target.turn).is_some() || angles.iter().any(Option::is_some);
        match [target.x_mm, target.y_mm, target.z_mm] {
            [Some(x_mm), Some(y_mm), Some(z_mm)] if !has_others => {
                Ok(Self::Point(PointWire { x_mm, y_mm, z_mm, base: target.base }))
            }
            _ => Ok(Self::Given(target)),
        }
    }
}

impl AuxRefWire {
    /// Converts to a target, and tells if the target has an orientation.
    pub(super) fn target(self) -> Result<(TargetRef, bool), String> {
        match self {
            Self::Named(name) => Ok((TargetRef::Named(name), true)),
            Self::Given(target) => Ok((TargetRef::Given(target.target()?), true)),
            Self::Point(PointWire { x_mm, y_mm, z_mm, base }) => {
                let frame = Frame { xyz_mm: [x_mm, y_mm, z_mm], ..Frame::default() };
                Ok((TargetRef::Given(Target { base, ..Target::at(frame) }), false))
            }
        }
    }
}

impl From<&TargetRef> for AuxRefWire {
    fn from(target: &TargetRef) -> Self {
        match target {
            TargetRef::Named(name) => Self::Named(name.clone()),
            TargetRef::Given(target) => Self::Given(target.into()),
        }
    }
}

/// A tool at the flange.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Tool")]
pub(super) struct ToolWire {
    /// TCP in the flange frame.
    #[serde(deserialize_with = "object")]
    tcp: PoseWire,
    /// Further TCPs by name, in the flange frame.
    #[serde(default, deserialize_with = "by_name", skip_serializing_if = "BTreeMap::is_empty")]
    tips: BTreeMap<String, PoseWire>,
    /// Payload with this tool.
    #[serde(default, deserialize_with = "object_or_null", skip_serializing_if = "Option::is_none")]
    load: Option<LoadWire>,
}

impl ToolWire {
    fn tool(self) -> Result<Tool, String> {
        let tip = |(name, pose): (String, PoseWire)| match pose.frame() {
            Ok(frame) => Ok((name, frame)),
            Err(message) => Err(format!("`{}`: {message}", excerpt(&name))),
        };
        let load = self.load.map(|load| {
            let payload = load.payload().map_err(|fault| fault.to_string())?;
            payload.load.check().map_err(|error| error.to_string())?;
            Ok::<_, String>(payload)
        });
        Ok(Tool {
            tcp: self.tcp.frame()?,
            tips: self.tips.into_iter().map(tip).collect::<Result<_, _>>()?,
            load: load.transpose()?,
        })
    }
}

impl From<&Tool> for ToolWire {
    fn from(tool: &Tool) -> Self {
        let tip = |(name, frame): (&String, &Frame)| (name.clone(), frame.into());
        Self {
            tcp: (&tool.tcp).into(),
            tips: tool.tips.iter().map(tip).collect(),
            load: tool.load.as_ref().map(LoadWire::from),
        }
    }
}

impl From<&Base> for BaseWire {
    fn from(base: &Base) -> Self {
        Self { base: base.base.clone(), ..Self::from(&base.frame) }
    }
}

/// Checks that a name is valid and not reserved.
fn check_name(
    list: &'static str,
    name: &str,
    used_name: &str,
    meaning: &str,
) -> Result<(), (&'static str, String, String)> {
    let wrong = |message: String| Err((list, name.to_owned(), message));
    if name.is_empty() {
        wrong("a name has at least one character".to_owned())
    } else if name == used_name {
        wrong(format!("this name is that of {meaning}; choose another"))
    } else if list == "tools" && name.contains('/') {
        wrong("a tool's name has no `/`: it divides tool and tip".to_owned())
    } else {
        Ok(())
    }
}

/// Collects the named tools, bases and frames; an error gives the list, the name and a message.
pub(super) fn workcell(
    tools: BTreeMap<String, ToolWire>,
    bases: BTreeMap<String, BaseWire>,
    frames: BTreeMap<String, TargetWire>,
) -> Result<Workcell, (&'static str, String, String)> {
    let mut workcell = Workcell::default();
    for (name, wire) in tools {
        check_name("tools", &name, FLANGE, "the bare flange")?;
        if wire.tips.contains_key("") {
            return Err(("tools", name, "the name of a tip has at least one character".to_owned()));
        }
        let tool = wire.tool().map_err(|message| ("tools", name.clone(), message))?;
        workcell.tools.insert(name, tool);
    }
    for (name, wire) in bases {
        check_name("bases", &name, ROBOT, "the robot's foot")?;
        let frame = wire.given_frame(false).map_err(|message| ("bases", name.clone(), message))?;
        workcell.bases.insert(name, Base { frame, base: wire.base });
    }
    for (name, wire) in frames {
        check_name("frames", &name, TCP, "the TCP itself")?;
        let target = wire.target().map_err(|message| ("frames", name.clone(), message))?;
        workcell.frames.insert(name, target);
    }
    Ok(workcell)
}
