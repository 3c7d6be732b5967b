//! Data of the program that a path keeps beside its geometry: payloads, mounting, torque limit,
//! override, overlapping waits, and origins.

use iiwa_kin::{Load, Mount};
use iiwa_program::{Motion, MotionIndex, OverlappingWait, Program, Sources, Workcell};

/// The payload of each motion, the mount, the torque limit, the override, the waits that overlap
/// motions, and the origins of motions.
#[derive(Debug, Default)]
pub(crate) struct Carried {
    /// Empty if no motion has a payload, so that a long program without payloads needs no memory
    /// for them.
    loads: Vec<Option<Load>>,
    mount: Mount,
    torque_limit_rel: Option<f64>,
    speed_override: Option<f64>,
    waits: Vec<OverlappingWait>,
    sources: Sources,
}

impl Carried {
    pub(crate) fn new(program: &Program) -> Self {
        let of_tools = program.workcell.tools.values().any(|tool| tool.load.is_some());
        let is_step = |motion: &Motion| matches!(motion, Motion::Load(_));
        let any = of_tools || program.motions.iter().any(is_step);
        let loads = if any { program.loads() } else { Vec::new() };
        let Workcell { mount, torque_limit_rel, speed_override, .. } = program.workcell;
        let (waits, sources) = (program.overlapping_waits(), program.sources.clone());
        Self { loads, mount, torque_limit_rel, speed_override, waits, sources }
    }

    pub(crate) fn load(&self, motion: MotionIndex) -> Option<&Load> {
        self.loads.get(motion.index())?.as_ref()
    }

    pub(crate) fn sources(&self) -> &Sources {
        &self.sources
    }

    pub(crate) fn overlapping_waits(&self) -> &[OverlappingWait] {
        &self.waits
    }

    pub(crate) fn mount(&self) -> &Mount {
        &self.mount
    }

    pub(crate) fn torque_limit_rel(&self) -> Option<f64> {
        self.torque_limit_rel
    }

    pub(crate) fn speed_override(&self) -> f64 {
        self.speed_override.unwrap_or(1.0)
    }
}
