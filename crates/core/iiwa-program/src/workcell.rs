//! Named tools, bases and frames of a program.

use std::collections::BTreeMap;

use iiwa_json::{excerpt, meant};
use iiwa_kin::{Mount, Pose};

use crate::{
    flange_load::FlangeLoad,
    target::{Frame, Target, TargetRef},
};

/// Tools, bases and frames of a program, with the tool and base that motions use by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Workcell {
    /// Tools by name.
    pub tools: BTreeMap<String, Tool>,
    /// Bases by name.
    pub bases: BTreeMap<String, Base>,
    /// Frames by name.
    pub frames: BTreeMap<String, Target>,
    /// Tool in use; the bare flange by default.
    pub tool: Option<String>,
    /// Base in use; the robot base by default.
    pub base: Option<String>,
    /// Operating mode of the controller.
    pub mode: OperatingMode,
    /// Mounting of the robot.
    pub mount: Mount,
    /// Flange length, from the wrist to the flange face, in m, above 0 and at most
    /// [`MAX_FLANGE_M`]; the model's by default.
    pub flange_m: Option<f64>,
    /// Joint torque limit in either direction, as a share of the robot's torque limits; unlimited
    /// by default. From [`MIN_TORQUE_LIMIT`] to [`MAX_TORQUE_LIMIT`].
    pub torque_limit_rel: Option<f64>,
    /// Override of the controller, as a share: slows down motions, but neither the standstill after
    /// stops nor waits. 1 by default. From [`MIN_OVERRIDE`] to 1.
    pub speed_override: Option<f64>,
}

/// Largest flange length, in m.
pub const MAX_FLANGE_M: f64 = 10.0;

/// Smallest override.
pub const MIN_OVERRIDE: f64 = 0.001;

/// Smallest torque limit, as a share of the robot's torque limits.
pub const MIN_TORQUE_LIMIT: f64 = 0.01;

/// Largest torque limit, as a share of the robot's torque limits: catalogues state less than gears
/// bear for moments.
pub const MAX_TORQUE_LIMIT: f64 = 10.0;

/// Operating mode of the robot controller, as far as it affects motions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OperatingMode {
    /// Automatic mode: motions run as programmed.
    #[default]
    Automatic,
    /// Manual reduced speed: TCP and flange stay below [`iiwa_kin::Robot::t1_speed_m_s`].
    T1,
}

/// A tool at the flange.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tool {
    /// TCP, in the flange frame.
    pub tcp: Frame,
    /// Further TCPs by name, in the flange frame.
    pub tips: BTreeMap<String, Frame>,
    /// Payload with this tool, if known.
    pub load: Option<FlangeLoad>,
}

/// A reference frame for other frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Base {
    /// Frame in the base in which it is given.
    pub frame: Frame,
    /// Base of the frame; the robot base by default.
    pub base: Option<String>,
}

/// Error: a name cannot be resolved.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NameFault {
    /// The tool, TCP, base or frame is unknown.
    #[error("unknown {kind} `{}`{}", excerpt(.name), suggestion(.name, .known))]
    Unknown {
        /// Kind of the name: `tool`, `base`, `frame`, or `frame or base`.
        kind: &'static str,
        /// Name found.
        name: String,
        /// Known names.
        known: Vec<String>,
    },
    /// A base refers to itself, directly or through other bases.
    #[error("the base `{}` refers to itself through its own base", excerpt(.name))]
    Cycle {
        /// Name of the base.
        name: String,
    },
}

/// Suggestion for `name`: the most similar name, or all names.
fn suggestion(name: &str, names: &[String]) -> String {
    /// Longest name compared: a typing error does not lengthen a name by more.
    const MAX_LETTERS: usize = 100;
    let short = names.iter().map(String::as_str).filter(|name| name.len() <= MAX_LETTERS);
    match meant(name, short) {
        Some(meant) => format!("; did you mean `{}`?", excerpt(meant)),
        None => listed(names),
    }
}

fn listed(names: &[String]) -> String {
    /// Largest number of listed names; more, or longer ones, would hide the message.
    const MOST: usize = 8;
    const MAX_BYTES: usize = 200;
    if names.is_empty() {
        return "; the program names none".to_owned();
    }
    let mut bytes = 0;
    let quoted = names.iter().take(MOST).map(|name| format!("`{}`", excerpt(name)));
    let shown = quoted.take_while(|name| {
        bytes += name.len();
        bytes <= MAX_BYTES
    });
    let shown = shown.collect::<Vec<_>>();
    let more = match shown.len() {
        0 => return String::new(),
        count if count < names.len() => ", ...",
        _ => "",
    };
    let verb = if names.len() == 1 { "is" } else { "are" };
    format!("; there {verb} {}{more}", shown.join(", "))
}

/// Name of the bare flange among tools.
pub(crate) const FLANGE: &str = "flange";
/// Name of the robot base among bases.
pub const ROBOT: &str = "robot";

impl Workcell {
    /// TCP of a tool in the flange frame, by its name `TOOL` or `TOOL/TIP`; of the tool in use by
    /// default.
    ///
    /// # Errors
    ///
    /// If the tool is unknown.
    pub fn tcp(&self, name: Option<&str>) -> Result<Pose, NameFault> {
        let name = name.or(self.tool.as_deref()).unwrap_or(FLANGE);
        if name == FLANGE {
            return Ok(Pose::IDENTITY);
        }
        let frame = match name.split_once('/') {
            Some((tool, tip)) => self.tools.get(tool).and_then(|tool| tool.tips.get(tip)),
            None => self.tools.get(name).map(|tool| &tool.tcp),
        };
        frame.map(Frame::pose).ok_or_else(|| {
            let tips = |(tool, entry): (&String, &Tool)| {
                let tips = entry.tips.keys().map(|tip| format!("{tool}/{tip}")).collect::<Vec<_>>();
                std::iter::once(tool.clone()).chain(tips)
            };
            let names = self.tools.iter().flat_map(tips).collect();
            NameFault::Unknown { kind: "tool", name: name.to_owned(), known: names }
        })
    }

    /// Pose of a base in the robot base, by its name; the base in use by default.
    ///
    /// # Errors
    ///
    /// If the base is unknown, or refers to itself.
    pub fn base(&self, name: Option<&str>) -> Result<Pose, NameFault> {
        let mut name = name.or(self.base.as_deref()).unwrap_or(ROBOT);
        let mut pose = Pose::IDENTITY;
        for _ in 0..=self.bases.len() {
            if name == ROBOT {
                return Ok(pose);
            }
            let base = self.bases.get(name).ok_or_else(|| NameFault::Unknown {
                kind: "base",
                name: name.to_owned(),
                known: self.bases.keys().cloned().collect(),
            })?;
            pose = base.frame.pose().then(&pose);
            name = base.base.as_deref().unwrap_or(ROBOT);
        }
        Err(NameFault::Cycle { name: name.to_owned() })
    }

    /// A target, with its pose in the robot base. An inline target is in `base` unless it names
    /// another base; a named target is in the program's base, so that it is the same pose for all
    /// motions.
    ///
    /// # Errors
    ///
    /// If the target or a base is unknown.
    pub fn target<'a>(
        &'a self,
        target: &'a TargetRef,
        base: Option<&str>,
    ) -> Result<(&'a Target, Pose), NameFault> {
        let (target, base) = match target {
            TargetRef::Given(target) => (target, base),
            TargetRef::Named(name) => {
                let target = self.frames.get(name).ok_or_else(|| NameFault::Unknown {
                    kind: "frame",
                    name: name.clone(),
                    known: self.frames.keys().cloned().collect(),
                })?;
                (target, None)
            }
        };
        let base = self.base(target.base.as_deref().or(base))?;
        Ok((target, base.then(&target.frame.pose())))
    }

    /// Pose in the robot base of a frame or a base in whose orientation an offset is given. A named
    /// frame takes precedence over a base of the same name.
    ///
    /// # Errors
    ///
    /// If the frame or a base is unknown.
    pub fn reference(&self, target: &TargetRef, base: Option<&str>) -> Result<Pose, NameFault> {
        match target {
            TargetRef::Named(name) if !self.frames.contains_key(name) => {
                if name == ROBOT || self.bases.contains_key(name) {
                    return self.base(Some(name));
                }
                let bases = self.bases.keys().filter(|name| !self.frames.contains_key(*name));
                Err(NameFault::Unknown {
                    kind: "frame or base",
                    name: name.clone(),
                    known: self.frames.keys().chain(bases).cloned().collect(),
                })
            }
            target => self.target(target, base).map(|(_, pose)| pose),
        }
    }

    /// Merges `overrides` into these tools, bases and frames. Names of `overrides` take precedence;
    /// tool and base in use, mode, mounting and the other settings are those of `overrides`.
    #[must_use]
    pub fn updated_with(mut self, overrides: Self) -> Self {
        self.tools.extend(overrides.tools);
        self.bases.extend(overrides.bases);
        self.frames.extend(overrides.frames);
        Self {
            tool: overrides.tool,
            base: overrides.base,
            mode: overrides.mode,
            mount: overrides.mount,
            flange_m: overrides.flange_m,
            torque_limit_rel: overrides.torque_limit_rel,
            speed_override: overrides.speed_override,
            ..self
        }
    }

    /// Returns true if nothing is named and the operating mode is the default; mounting, flange,
    /// torque limit and override are ignored.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let Self { mount, flange_m, torque_limit_rel, speed_override, .. } = *self;
        let rest = Self { mount, flange_m, torque_limit_rel, speed_override, ..Self::default() };
        *self == rest
    }
}
