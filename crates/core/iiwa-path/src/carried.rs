//! What a path keeps of loads, of how the robot stands, of what its joints may exert, of waits that overlap its
//! motions, and of where these come from.

use iiwa_kin::{Load, Mount};
use iiwa_program::{Motion, MotionIndex, OverlappingWait, Program, Sources, Workcell};

/// The load of each motion, the mount, the limit of torques, the waits that overlap motions, and
/// where motions come from.
#[derive(Debug, Default)]
pub(crate) struct Carried {
    /// None at all if no motion has one, so that a long program without loads takes no room.
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
