//! What motions know by name, and what is in use: keys that programs and lists of motions have in common.

use std::collections::BTreeMap;

use iiwa_json::{Step, excerpt, locate};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{
    by_name::{by_name, word_or_null},
    error::ProgramError,
    frames::{BaseWire, TargetWire, ToolWire, workcell},
};
use crate::workcell::{OperatingMode, Workcell};

/// These keys as they are read. Programs declare them again, with what their schema says.
#[derive(Deserialize)]
pub(super) struct WorkcellWire {
    #[serde(default, deserialize_with = "by_name")]
    pub(super) tools: BTreeMap<String, ToolWire>,
    #[serde(default, deserialize_with = "by_name")]
    pub(super) bases: BTreeMap<String, BaseWire>,
    #[serde(default, deserialize_with = "by_name")]
    pub(super) frames: BTreeMap<String, TargetWire>,
    #[serde(default)]
    pub(super) tool: Option<String>,
    #[serde(default)]
    pub(super) base: Option<String>,
    #[serde(default, deserialize_with = "word_or_null")]
    pub(super) mode: Option<ModeWire>,
}

impl WorkcellWire {
    /// What the keys of `text` say.
    pub(super) fn workcell(self, text: &str) -> Result<Workcell, ProgramError> {
        let Self { tools, bases, frames, tool, base, mode } = self;
        let mode = mode.map_or_else(OperatingMode::default, OperatingMode::from);
        Ok(Workcell { tool, base, mode, ..named(text, tools, bases, frames)? })
    }
}

/// The tools, bases and frames of `text`.
pub(super) fn named(
    text: &str,
    tools: BTreeMap<String, ToolWire>,
    bases: BTreeMap<String, BaseWire>,
    frames: BTreeMap<String, TargetWire>,
) -> Result<Workcell, ProgramError> {
    workcell(tools, bases, frames).map_err(|(list, name, what)| ProgramError::Json {
        what: format!("`{}`: {what}", excerpt(&name)),
        motion: None,
        place: locate(text, &[Step::Key(list), Step::Key(&name)]),
    })
}

/// The keys as they are written.
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
        }
    }
}

/// An operating mode of the controller.
#[derive(Clone, Copy, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "OperatingMode")]
pub(super) enum ModeWire {
    /// For tests: TCP and flange go at 250 mm/s at most.
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

impl From<ModeWire> for OperatingMode {
    fn from(ModeWire::T1: ModeWire) -> Self {
        Self::T1
    }
}
