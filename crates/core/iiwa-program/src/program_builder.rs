//! Builder of programs in code.

use iiwa_kin::Joints;

use crate::{
    blend::Blend,
    program::{Motion, Program, Ptp},
    source::Sources,
    workcell::Workcell,
};

/// Builder of a program, with angles in degrees as on the robot's panel.
///
/// ```
/// use iiwa_kin::Robot;
/// use iiwa_program::{Blend, Program};
///
/// let program = Program::from_deg([0.0; 7])
///     .ptp_deg([0.0, 30.0, 0.0, -60.0, 0.0, 90.0, 0.0])
///     .velocity(0.5)
///     .blend(Blend::CartMm(50.0))
///     .ptp_deg([40.0, 30.0, 0.0, -60.0, 0.0, 90.0, 0.0])
///     .wait_s(0.5)
///     .build();
/// assert_eq!(program.motions.len(), 3);
/// program.check(Robot::default().limits())?;
/// # Ok::<(), iiwa_program::Fault>(())
/// ```
#[derive(Clone, Debug)]
#[must_use]
pub struct ProgramBuilder {
    program: Program,
}

impl Program {
    /// Starts a program at these joint angles, in degrees, without motions.
    pub fn from_deg(start_deg: Joints) -> ProgramBuilder {
        Self::from_rad(start_deg.map(f64::to_radians))
    }

    /// Starts a program at these joint angles, in rad, without motions.
    pub fn from_rad(start_rad: Joints) -> ProgramBuilder {
        ProgramBuilder {
            program: Self {
                robot: None,
                start: start_rad.into(),
                motions: Vec::new(),
                workcell: Workcell::default(),
                sources: Sources::default(),
            },
        }
    }
}

impl ProgramBuilder {
    /// Sets the robot: a built-in model or a profile file.
    pub fn robot(mut self, name: impl Into<String>) -> Self {
        self.program.robot = Some(name.into());
        self
    }

    /// Adds a point-to-point motion with its target in degrees.
    pub fn ptp_deg(self, target_deg: Joints) -> Self {
        self.ptp_rad(target_deg.map(f64::to_radians))
    }

    /// Adds a point-to-point motion with its target in rad.
    pub fn ptp_rad(self, target_rad: Joints) -> Self {
        self.motion(Motion::Ptp(Ptp::to(target_rad)))
    }

    /// Adds a wait, in s.
    pub fn wait_s(self, seconds: f64) -> Self {
        self.motion(Motion::Wait { seconds, overlap: 0 })
    }

    /// Adds any motion.
    pub fn motion(mut self, motion: Motion) -> Self {
        self.program.motions.push(motion);
        self
    }

    /// Limits the last motion to this share of every joint's velocity limit, in (0, 1].
    pub fn velocity(self, share: f64) -> Self {
        self.last_ptp(|ptp| ptp.velocity_rel = [share; 7])
    }

    /// Limits the last motion to this share of every joint's acceleration limit, in (0, 1].
    pub fn acceleration(self, share: f64) -> Self {
        self.last_ptp(|ptp| ptp.acceleration_rel = [share; 7])
    }

    /// Limits the last motion to this share of every joint's jerk limit, in (0, 1].
    pub fn jerk(self, share: f64) -> Self {
        self.last_ptp(|ptp| ptp.jerk_rel = [share; 7])
    }

    /// Blends the last motion into the next one.
    pub fn blend(self, blend: Blend) -> Self {
        self.last_ptp(|ptp| ptp.blend = Some(blend))
    }

    /// Finished program, which is checked when its path is planned.
    #[must_use]
    pub fn build(self) -> Program {
        self.program
    }

    /// Changes the last motion if it is a point-to-point motion.
    fn last_ptp(mut self, change: impl FnOnce(&mut Ptp)) -> Self {
        if let Some(Motion::Ptp(ptp)) = self.program.motions.last_mut() {
            change(ptp);
        }
        self
    }
}
