//! TCPs of the motions.

use iiwa_kin::Pose;

use crate::{
    cartesian_fault::CartesianFault,
    fault::Fault,
    program::{Motion, Program},
};

impl Program {
    /// TCP that each motion moves, in the flange frame: that of the motion's tool, by default of
    /// the program's tool; for a wait or a payload change, the TCP of the entry before.
    ///
    /// # Errors
    ///
    /// [`Fault::Cartesian`] if a tool is unknown.
    pub fn tcps(&self) -> Result<Vec<Pose>, Fault> {
        let mut before = None;
        let tcps = self.entries().map(|(motion, entry)| {
            let tool = match entry {
                Motion::Cartesian(cartesian) => cartesian.tool.as_deref(),
                Motion::Ptp(_) | Motion::Wait { .. } | Motion::Load(_) => None,
            };
            let tcp = match (entry, before) {
                (Motion::Wait { .. } | Motion::Load(_), Some(tcp)) => tcp,
                _ => self.workcell.tcp(tool).map_err(|fault| Fault::Cartesian {
                    motion: Some(motion),
                    key: "tool",
                    fault: Box::new(CartesianFault::Name(fault)),
                })?,
            };
            before = Some(tcp);
            Ok(tcp)
        });
        tcps.collect()
    }
}
