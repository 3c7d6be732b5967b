//! TCP and payload of each motion.

use iiwa_kin::{Load, Pose};

use crate::{
    cartesian_fault::CartesianFault,
    fault::Fault,
    program::{Motion, Program},
    workcell::Workcell,
};

impl Workcell {
    /// Payload of a tool, by its name `TOOL` or `TOOL/TIP`. Falls back to the tool in use if no
    /// name is given or the named tool has no payload.
    #[must_use]
    pub fn load(&self, name: Option<&str>) -> Option<&Load> {
        let of = |name: &str| {
            let tool = name.split_once('/').map_or(name, |(tool, _)| tool);
            self.tools.get(tool)?.load.as_ref().map(|payload| &payload.load)
        };
        name.and_then(of).or_else(|| of(self.tool.as_deref()?))
    }
}

impl Program {
    /// TCP that each motion moves, in the flange frame: that of the motion's tool, by default of
    /// the program's tool; for an entry that does not move the robot, the TCP of the entry before.
    ///
    /// # Errors
    ///
    /// [`Fault::Cartesian`] if a tool is unknown.
    pub fn tcps(&self) -> Result<Vec<Pose>, Fault> {
        let mut before = None;
        let tcps = self.entries().map(|(motion, entry)| {
            let tool = match entry {
                Motion::Cartesian(cartesian) => cartesian.tool.as_deref(),
                Motion::Ptp(_) | Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_) => None,
            };
            let tcp = match (entry, before) {
                (Motion::Wait { .. } | Motion::Load(_) | Motion::Io(_), Some(tcp)) => tcp,
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

    /// Total payload during each motion, in order.
    ///
    /// After a payload change, the payload picked up applies; otherwise the payload of the motion's
    /// tool or, by default, of the tool in use. Waits, inputs and outputs keep the payload of the
    /// entry before.
    ///
    /// ```
    /// use iiwa_program::Program;
    ///
    /// let program = Program::from_json(r#"{
    ///     "version": 1,
    ///     "tools": { "gripper": { "tcp": { "z_mm": 120 }, "load": { "mass_kg": 1.2 } } },
    ///     "tool": "gripper",
    ///     "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
    ///     "motions": [
    ///         { "type": "lin_rel", "offset": { "z_mm": -50 } },
    ///         { "type": "load", "load": { "mass_kg": 4.2, "center_mm": [0, 0, 90] } },
    ///         { "type": "lin_rel", "offset": { "z_mm": 50 } },
    ///         { "type": "load", "load": null },
    ///         { "type": "wait", "seconds": 1 }
    ///     ]
    /// }"#)?;
    /// let masses: Vec<f64> = program.loads().iter().flatten().map(|load| load.mass_kg).collect();
    /// assert_eq!(masses, [1.2, 4.2, 4.2, 1.2, 1.2]);
    /// # Ok::<(), iiwa_program::ProgramError>(())
    /// ```
    #[must_use]
    pub fn loads(&self) -> Vec<Option<Load>> {
        let of_tool = |name| self.workcell.load(name).copied();
        let (mut picked_up, mut carried) = (None, of_tool(None));
        let loads = self.motions.iter().map(|motion| {
            let tool = match motion {
                Motion::Wait { .. } | Motion::Io(_) => return carried,
                Motion::Load(payload) => {
                    picked_up = payload.as_ref().map(|payload| payload.load);
                    None
                }
                Motion::Ptp(_) => None,
                Motion::Cartesian(cartesian) => cartesian.tool.as_deref(),
            };
            carried = picked_up.or_else(|| of_tool(tool));
            carried
        });
        loads.collect()
    }
}
