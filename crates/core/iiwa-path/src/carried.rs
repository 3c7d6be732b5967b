//! Data of the program that a path keeps in addition to its geometry: types and TCPs of the
//! motions, payloads, mounting, torque limit, override, overlapping waits, inputs and outputs, and
//! origins.

use std::collections::BTreeMap;

use iiwa_kin::{Load, Mount, Pose};
use iiwa_program::{
    Fault, IoEntry, Motion, MotionIndex, MotionType, OverlappingWait, Program, Sources,
};

/// The type, the TCP and the payload of each motion, the mount, the torque limit, the override, the
/// waits that overlap motions, the inputs and outputs, and the origins of motions.
///
/// A list of motions is empty if the program does not need it, so that a long program of joint
/// motions needs no memory for them.
#[derive(Debug, Default)]
pub(crate) struct Carried {
    /// Empty if the program has neither tools nor frames.
    pub(crate) types: Vec<MotionType>,
    /// TCPs in the flange frame; empty if the program has neither tools nor frames.
    pub(crate) tcps: Vec<Pose>,
    /// `true` if any motion moves a TCP other than the flange.
    pub(crate) has_tools: bool,
    /// Empty if no motion has a payload.
    pub(crate) loads: Vec<Option<Load>>,
    pub(crate) mount: Mount,
    pub(crate) torque_limit_rel: Option<f64>,
    pub(crate) speed_override: Option<f64>,
    pub(crate) waits: Vec<OverlappingWait>,
    pub(crate) io: BTreeMap<MotionIndex, IoEntry>,
    pub(crate) sources: Sources,
}

impl Carried {
    pub(crate) fn new(program: &Program) -> Result<Self, Fault> {
        let workcell = &program.workcell;
        let (mut types, mut tcps, mut loads) = (Vec::new(), Vec::new(), Vec::new());
        if workcell.tool.is_some() || program.has_frames() {
            types = program.motions.iter().map(Motion::motion_type).collect();
            tcps = program.tcps()?;
        }
        let is_load = |motion: &Motion| matches!(motion, Motion::Load(_));
        if workcell.tools.values().any(|tool| tool.load.is_some())
            || program.motions.iter().any(is_load)
        {
            loads = program.loads();
        }
        Ok(Self {
            has_tools: tcps.iter().any(|tcp| *tcp != Pose::IDENTITY),
            types,
            tcps,
            loads,
            mount: workcell.mount,
            torque_limit_rel: workcell.torque_limit_rel,
            speed_override: workcell.speed_override,
            waits: program.overlapping_waits(),
            io: program
                .entries()
                .filter_map(|(motion, entry)| Some((motion, entry.io()?.clone())))
                .collect(),
            sources: program.sources.clone(),
        })
    }

    /// TCP of the motion at `index`, in the flange frame.
    pub(crate) fn tcp(&self, index: usize) -> &Pose {
        self.tcps.get(index).unwrap_or(&Pose::IDENTITY)
    }
}
