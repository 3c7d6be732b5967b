//! State at each motion of a program: joint positions at the target, TCP, payload, carried shapes,
//! overlapping waits.

use std::collections::VecDeque;

use iiwa_kin::{Joints, Load, Pose, Robot, Status};

use crate::{
    cartesian_fault::CartesianFault,
    fault::Fault,
    flange_load::{FlangeLoad, LoadShape},
    motion_index::MotionIndex,
    program::{MAX_OVERLAP, Motion, Program, Start},
    target::TargetRef,
    workcell::Workcell,
};

impl Program {
    /// Joint positions before the first motion, in rad.
    ///
    /// # Errors
    ///
    /// If the start is given as a frame that the robot cannot reach.
    pub fn start_rad(&self, robot: &Robot) -> Result<Joints, Fault> {
        match &self.start {
            Start::Joints(joints_rad) => Ok(*joints_rad),
            Start::Frame(target) => {
                self.joints_at(robot, None, target, [None, None]).map_err(|(key, fault)| {
                    Fault::Cartesian { motion: None, key, fault: Box::new(fault) }
                })
            }
        }
    }

    /// Joint positions at a target. E1 and status default to those of the joints `before`; `tool`
    /// and `base` are the motion's names, by default the program's.
    ///
    /// # Errors
    ///
    /// If a name is unknown or the robot cannot reach the frame; returns the fault with the key of
    /// the motion at which it is.
    pub fn joints_at(
        &self,
        robot: &Robot,
        before: Option<&Joints>,
        target: &TargetRef,
        [tool, base]: [Option<&str>; 2],
    ) -> Result<Joints, (&'static str, CartesianFault)> {
        let named = |key| move |fault| (key, CartesianFault::Name(fault));
        let tcp = self.workcell.tcp(tool).map_err(named("tool"))?;
        let (target, pose) = self.workcell.target(target, base).map_err(named("frame"))?;
        let e1_rad = target.e1_rad.or(before.map(|q| q[2])).unwrap_or(0.0);
        let status = target
            .status
            .or(before.map(|q| Status::of(robot, q)))
            .unwrap_or_else(|| Status::of(robot, &[0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0]));
        let at_frame = |fault| ("frame", fault);
        let flange = pose.then(&tcp.inverse());
        let joints = robot
            .inverse(&flange, e1_rad, status)
            .map_err(|fault| at_frame(CartesianFault::Unreachable(fault)))?;
        robot.limits().check(&joints).map_err(|outside| {
            at_frame(CartesianFault::outside(robot, &flange, e1_rad, status, outside))
        })?;
        Ok(joints)
    }
}

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

/// A wait, also for an input, whose time runs while the robot moves; or an output that is set while
/// the robot moves, as a wait of 0 s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverlappingWait {
    /// Motion index of the wait.
    pub motion: MotionIndex,
    /// Duration, in s.
    pub seconds: f64,
    /// Motion at whose start the time of the wait starts, at the earliest.
    pub since: MotionIndex,
}

impl Program {
    /// Waits, inputs and outputs that overlap motions, in order, of a checked program.
    ///
    /// ```
    /// use iiwa_program::{Blend, Motion, MotionIndex, Program};
    ///
    /// let mut program =
    ///     Program::from_deg([0.0; 7]).ptp_deg([30.0; 7]).blend(Blend::Fraction(0.2)).build();
    /// program.motions.push(Motion::Wait { seconds: 0.5, overlap: 1 });
    /// let [wait] = program.overlapping_waits().try_into().expect("there is one");
    /// assert_eq!((wait.motion, wait.since), (MotionIndex::new(1), MotionIndex::new(0)));
    /// ```
    #[must_use]
    pub fn overlapping_waits(&self) -> Vec<OverlappingWait> {
        let mut waits = Vec::new();
        // Preceding motions, as many as an entry may overlap.
        let mut moves = VecDeque::with_capacity(MAX_OVERLAP);
        for (motion, entry) in self.entries() {
            if entry.moves() {
                moves.truncate(MAX_OVERLAP - 1);
                moves.push_front(motion);
            }
            let overlapped = entry.overlap().checked_sub(1).and_then(|last| moves.get(last));
            if let (Some(since), Some(seconds)) = (overlapped, entry.wait_s()) {
                waits.push(OverlappingWait { motion, seconds, since: *since });
            }
        }
        waits
    }
}
