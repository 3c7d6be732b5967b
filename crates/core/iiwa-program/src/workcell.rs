//! What a program knows by name: tools, bases and frames.

use std::collections::BTreeMap;

use iiwa_json::{excerpt, meant};
use iiwa_kin::{Load, Mount, Pose};

use crate::{
    frame::Frame,
    target::{Target, TargetRef},
};

/// Tools, bases and frames of a program, and which of them its motions use unless they say otherwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Workcell {
    /// The tools by name.
    pub tools: BTreeMap<String, Tool>,
    /// The bases by name.
    pub bases: BTreeMap<String, Base>,
    /// The frames by name.
    pub frames: BTreeMap<String, Target>,
    /// The tool in use; the bare flange if absent.
    pub tool: Option<String>,
    /// The base in use; the robot's foot if absent.
    pub base: Option<String>,
    /// The controller's operating mode.
    pub mode: OperatingMode,
    /// How the robot's foot stands.
    pub mount: Mount,
    /// The length of the robot's flange, from the wrist to its face, in m, above 0 and at most [`MAX_FLANGE_M`]; that of the
    /// robot's model if absent.
    pub flange_m: Option<f64>,
    /// The largest torque of the joints, either way, as a share of the robot's limits; torques limit nothing if absent.
    /// From [`MIN_TORQUE_LIMIT`] to [`MAX_TORQUE_LIMIT`].
    pub torque_limit_rel: Option<f64>,
    /// The controller's override, as a share: the time of motions passes slower by it, not that of pauses and waits. 1 if
    /// absent. From [`MIN_OVERRIDE`] to 1.
    pub speed_override: Option<f64>,
}

/// The longest flange, in m.
pub const MAX_FLANGE_M: f64 = 10.0;

/// The least override.
pub const MIN_OVERRIDE: f64 = 0.001;

/// The least share of the robot's torques that may be a limit.
pub const MIN_TORQUE_LIMIT: f64 = 0.01;

/// The largest share of the robot's torques that may be a limit: catalogues state less than gears bear for moments.
pub const MAX_TORQUE_LIMIT: f64 = 10.0;

/// The operating mode of the robot's controller, as far as it changes motions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OperatingMode {
    /// As programmed.
    #[default]
    Automatic,
    /// Manual reduced speed: TCP and flange keep [`iiwa_kin::Robot::t1_speed_m_s`].
    T1,
}

/// A tool at the flange.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tool {
    /// Its TCP, in the flange's frame.
    pub tcp: Frame,
    /// Further TCPs by name, in the flange's frame.
    pub tips: BTreeMap<String, Frame>,
    /// What hangs on the flange with it, if that is known.
    pub load: Option<Load>,
}

/// A frame in which others are given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Base {
    /// Where it is in the base that it is given in.
    pub frame: Frame,
    /// That base; the robot's foot if absent.
    pub base: Option<String>,
}

/// A name that leads nowhere.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NameFault {
    /// There is no such tool, TCP, base or frame.
    #[error("there is no {kind} `{}`{}", excerpt(.name), instead(.name, .known))]
    Unknown {
        /// What it should have been: `tool`, `base` or `frame`.
        kind: &'static str,
        /// The name.
        name: String,
        /// Those that there are.
        known: Vec<String>,
    },
    /// A base is given in itself, by way of others or not.
    #[error("the base `{}` is given in itself, by way of its own base", excerpt(.name))]
    Cycle {
        /// The base.
        name: String,
    },
}

/// What may be meant in place of `name`: the one that is like it, or all.
fn instead(name: &str, names: &[String]) -> String {
    /// No slip of the pen lengthens a name by more.
    const MOST_LETTERS: usize = 100;
    let short = names.iter().map(String::as_str).filter(|name| name.len() <= MOST_LETTERS);
    match meant(name, short) {
        Some(meant) => format!("; did you mean `{}`?", excerpt(meant)),
        None => listed(names),
    }
}

fn listed(names: &[String]) -> String {
    /// More, or longer ones, would hide the message.
    const MOST: usize = 8;
    const MOST_BYTES: usize = 200;
    if names.is_empty() {
        return "; the program names none".to_owned();
    }
    let mut bytes = 0;
    let quoted = names.iter().take(MOST).map(|name| format!("`{}`", excerpt(name)));
    let shown = quoted.take_while(|name| {
        bytes += name.len();
        bytes <= MOST_BYTES
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

/// The name of the bare flange among tools.
pub(crate) const FLANGE: &str = "flange";
/// The name of the robot's foot among bases.
pub(crate) const ROBOT: &str = "robot";

impl Workcell {
    /// The TCP of a tool in the flange's frame, by its name `TOOL` or `TOOL/TIP`; of the tool in use if there is none.
    ///
    /// # Errors
    ///
    /// If there is no such tool.
    pub fn tcp(&self, name: Option<&str>) -> Result<Pose, NameFault> {
        let name = name.or(self.tool.as_deref()).unwrap_or(FLANGE);
        if name == FLANGE {
            return Ok(Pose::IDENTITY);
        }
        let found = match name.split_once('/') {
            Some((tool, tip)) => self.tools.get(tool).and_then(|tool| tool.tips.get(tip)),
            None => self.tools.get(name).map(|tool| &tool.tcp),
        };
        found.map(Frame::pose).ok_or_else(|| {
            let tips = |(tool, entry): (&String, &Tool)| {
                let tips = entry.tips.keys().map(|tip| format!("{tool}/{tip}")).collect::<Vec<_>>();
                std::iter::once(tool.clone()).chain(tips)
            };
            let known = self.tools.iter().flat_map(tips).collect();
            NameFault::Unknown { kind: "tool", name: name.to_owned(), known }
        })
    }

    /// A base in the robot's foot, by its name; the base in use if there is none.
    ///
    /// # Errors
    ///
    /// If there is no such base, or if it is given in itself.
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

    /// A target, and where it is in the robot's foot. A target that is given where it is used is in `base` unless it
    /// names another; one with a name is in the program's, so that it is the same place for all motions.
    ///
    /// # Errors
    ///
    /// If it, or a base, is not there.
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

    /// All of this, and of `own`, which wins where both have a name; `own` says which tool and base are in use, and how the
    /// robot stands.
    #[must_use]
    pub fn updated_with(mut self, own: Self) -> Self {
        self.tools.extend(own.tools);
        self.bases.extend(own.bases);
        self.frames.extend(own.frames);
        Self {
            tool: own.tool,
            base: own.base,
            mode: own.mode,
            mount: own.mount,
            flange_m: own.flange_m,
            torque_limit_rel: own.torque_limit_rel,
            speed_override: own.speed_override,
            ..self
        }
    }

    /// Whether nothing is named, and the mode is the usual one.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let Self { mount, flange_m, torque_limit_rel, speed_override, .. } = *self;
        let rest = Self { mount, flange_m, torque_limit_rel, speed_override, ..Self::default() };
        *self == rest
    }
}
