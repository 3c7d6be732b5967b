//! Builder of programs in code.

use iiwa_kin::Joints;

use crate::{
    blend::Blend,
    motion_label::MotionLabel,
    program::{Motion, Program, Ptp},
    repeat_block::RepeatBlock,
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

    /// Repeats the motions that `round` adds: `count` rounds, none with 0. `round` has to return
    /// the builder that it receives.
    ///
    /// ```
    /// use iiwa_program::Program;
    ///
    /// let program = Program::from_deg([0.0; 7])
    ///     .repeat(3, |round| round.ptp_deg([20.0; 7]).ptp_deg([0.0; 7]))
    ///     .build();
    /// assert_eq!(program.motions.len(), 6);
    /// assert!(program.to_json().contains("\"repeat\""));
    /// assert_eq!(Program::from_json(&program.to_json())?, program);
    /// # Ok::<(), iiwa_program::ProgramError>(())
    /// ```
    pub fn repeat(self, count: usize, round: impl FnOnce(Self) -> Self) -> Self {
        let outer = self.program.sources.repeats().to_vec();
        let first = self.program.motions.len();
        let Self { mut program } = round(self);
        let motions = program.motions.len().saturating_sub(first);
        let added: Vec<_> = program.motions.drain(first.min(program.motions.len())..).collect();
        let inner = program.sources.repeats().iter().skip(outer.len()).cloned();
        let inner = inner.filter_map(|block| {
            Some(RepeatBlock { first: block.first.checked_sub(first)?, ..block })
        });
        let label = MotionLabel::default();
        let block = RepeatBlock { first, motions, count, label, inner: inner.collect() };
        let is_block = motions > 0 && count > 0;
        program.sources.set_repeats(outer.into_iter().chain(is_block.then_some(block)).collect());
        for _ in 0..count {
            program.motions.extend_from_slice(&added);
        }
        Self { program }
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
