//! JSON form of the named tools, bases and frames and of those in use: common keys of programs and
//! motion lists.

use std::collections::BTreeMap;

use iiwa_json::{JsonStep, excerpt, locate, numbers};
use iiwa_kin::Mount;
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};

use super::{
    error::ProgramError,
    exact::exact_deg,
    frames::{BaseWire, TargetWire, ToolWire, workcell},
};
use crate::{
    source::Sources,
    workcell::{OperatingMode, Workcell},
};

/// Tools, bases and frames of `text`.
pub(super) fn named(
    text: &str,
    tools: BTreeMap<String, ToolWire>,
    bases: BTreeMap<String, BaseWire>,
    frames: BTreeMap<String, TargetWire>,
) -> Result<Workcell, ProgramError> {
    workcell(tools, bases, frames).map_err(|(list, name, message)| ProgramError::Json {
        message: format!("`{}`: {message}", excerpt(&name)),
        motion: None,
        sources: Sources::default(),
        place: locate(text, &[JsonStep::Key(list), JsonStep::Key(&name)]),
    })
}

/// Common keys when written.
#[derive(Serialize)]
pub(super) struct WorkcellOut<'a> {
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    tools: BTreeMap<&'a str, ToolWire>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    bases: BTreeMap<&'a str, BaseWire>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    frames: BTreeMap<&'a str, TargetWire>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tool: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    base: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mode: Option<ModeWire>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mount: Option<MountWire>,
}

impl<'a> From<&'a Workcell> for WorkcellOut<'a> {
    fn from(workcell: &'a Workcell) -> Self {
        fn written<'a, T, W: From<&'a T>>(all: &'a BTreeMap<String, T>) -> BTreeMap<&'a str, W> {
            all.iter().map(|(name, entry)| (name.as_str(), entry.into())).collect()
        }
        Self {
            tools: written(&workcell.tools),
            bases: written(&workcell.bases),
            frames: written(&workcell.frames),
            tool: workcell.tool.as_deref(),
            base: workcell.base.as_deref(),
            mode: ModeWire::of(workcell.mode),
            mount: (workcell.mount != Mount::default()).then(|| workcell.mount.into()),
        }
    }
}

/// Operating mode of the controller.
#[derive(Clone, Copy, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "OperatingMode")]
pub(super) enum ModeWire {
    /// Manual reduced speed: 225 mm/s for TCP and flange, or the profile's `t1_speed_mm_s`.
    T1,
}

impl ModeWire {
    fn of(mode: OperatingMode) -> Option<Self> {
        match mode {
            OperatingMode::Automatic => None,
            OperatingMode::T1 => Some(Self::T1),
        }
    }
}

/// Operating mode of the key `mode`: automatic by default.
pub(super) fn mode_of(mode: Option<ModeWire>) -> OperatingMode {
    match mode {
        None => OperatingMode::Automatic,
        Some(ModeWire::T1) => OperatingMode::T1,
    }
}

/// Orientation of the robot base in the world, whose z axis points up; on the floor by default.
#[derive(Clone, Copy, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Mount")]
pub(super) struct MountWire {
    /// Roll, pitch and yaw, in degrees, R = Rz(yaw) Ry(pitch) Rx(roll): 180, 0, 0 is on the
    /// ceiling.
    #[serde(deserialize_with = "three")]
    rpy_deg: [f64; 3],
}

fn three<'de, D: Deserializer<'de>>(reader: D) -> Result<[f64; 3], D::Error> {
    numbers(reader, "three angles, roll, pitch and yaw")
}

/// Mounting of the key `mount`: on the floor by default.
pub(super) fn mount_of(mount: Option<MountWire>) -> Mount {
    mount.map_or_else(Mount::default, |mount| Mount::from_rpy_deg(mount.rpy_deg))
}

impl From<Mount> for MountWire {
    fn from(mount: Mount) -> Self {
        Self { rpy_deg: mount.rpy_rad.map(exact_deg) }
    }
}
