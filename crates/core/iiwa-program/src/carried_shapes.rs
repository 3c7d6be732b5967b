//! Shapes at the flange during each motion.

use crate::{
    flange_load::{FlangeLoad, LoadShape},
    program::{Motion, Program},
};

/// Shapes at the flange during a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CarriedShapes<'a> {
    /// Shapes of the tool.
    pub tool: ShapesFrom<'a>,
    /// Shapes of the payload that was picked up.
    pub workpiece: ShapesFrom<'a>,
}

/// Shapes, and the tool or the load change that they belong to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShapesFrom<'a> {
    /// Shapes, in the flange frame.
    pub shapes: &'a [LoadShape],
    /// Name of the tool.
    pub tool: Option<&'a str>,
    /// Index of the load change.
    pub motion: Option<usize>,
}

impl Program {
    /// Shapes at the flange during each motion, in order.
    ///
    /// The tool has the shapes of its load, chosen as in [`Self::loads`]. A load change adds the
    /// shapes of the workpiece, until the next load change.
    ///
    /// ```
    /// use iiwa_program::Program;
    ///
    /// let program = Program::from_json(r#"{
    ///     "version": 1,
    ///     "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
    ///     "motions": [
    ///         { "type": "load", "load": { "mass_kg": 2, "shapes":
    ///             [{ "type": "sphere", "center_mm": [0, 0, 80], "radius_mm": 40 }] } },
    ///         { "type": "ptp", "joints_deg": [0, 50, 0, -60, 0, 90, 0] },
    ///         { "type": "load", "load": null },
    ///         { "type": "wait", "seconds": 1 }
    ///     ]
    /// }"#)?;
    /// let shapes = program.carried_shapes();
    /// let counts: Vec<usize> = shapes.iter().map(|it| it.workpiece.shapes.len()).collect();
    /// assert_eq!(counts, [1, 1, 0, 0]);
    /// # Ok::<(), iiwa_program::ProgramError>(())
    /// ```
    #[must_use]
    pub fn carried_shapes(&self) -> Vec<CarriedShapes<'_>> {
        let of = |name: &str| {
            let name = name.split_once('/').map_or(name, |(tool, _)| tool);
            let (name, tool) = self.workcell.tools.get_key_value(name)?;
            let shapes = &tool.load.as_ref()?.shapes;
            Some(ShapesFrom { shapes, tool: Some(name), motion: None })
        };
        let in_use = self.workcell.tool.as_deref();
        let of_tool =
            |name: Option<&str>| name.and_then(of).or_else(|| of(in_use?)).unwrap_or_default();
        let mut now = CarriedShapes { tool: of_tool(None), workpiece: ShapesFrom::default() };
        let shapes = self.motions.iter().enumerate().map(|(index, entry)| {
            match entry {
                Motion::Load(payload) => {
                    let shapes = payload.as_ref().map_or(&[][..], |it: &FlangeLoad| &it.shapes);
                    let motion = (!shapes.is_empty()).then_some(index);
                    now.workpiece = ShapesFrom { shapes, tool: None, motion };
                    now.tool = of_tool(None);
                }
                Motion::Ptp(_) => now.tool = of_tool(None),
                Motion::Cartesian(cartesian) => now.tool = of_tool(cartesian.tool.as_deref()),
                Motion::Wait { .. } | Motion::Io(_) => {}
            }
            now
        });
        shapes.collect()
    }
}
