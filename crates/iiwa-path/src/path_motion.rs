//! What a path keeps of the motions that it was made of.

use iiwa_kin::Pose;

use crate::{
    cartesian::CartesianFault,
    cartesian_motion::Course,
    fault::Fault,
    program::{Motion, Program},
};

/// The types of motions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum MotionType {
    /// Point to point, to joint positions.
    #[default]
    Ptp,
    /// Point to point, to a frame.
    PtpToFrame,
    /// The TCP goes straight to a frame.
    Lin,
    /// The TCP goes straight, by an offset.
    LinRel,
    /// The TCP goes on a circle.
    Circ,
    /// The TCP goes through frames on segments of a spline.
    Spline,
    /// A wait.
    Wait,
}

impl MotionType {
    /// Its name in programs: `ptp`, `lin`, `lin_rel`, `circ`, `spline` or `wait`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ptp | Self::PtpToFrame => "ptp",
            Self::Lin => "lin",
            Self::LinRel => "lin_rel",
            Self::Circ => "circ",
            Self::Spline => "spline",
            Self::Wait => "wait",
        }
    }

    /// Whether its target is a frame of the TCP.
    #[must_use]
    pub fn is_cartesian(self) -> bool {
        !matches!(self, Self::Ptp | Self::Wait)
    }
}

impl Motion {
    /// Its type.
    #[must_use]
    pub fn motion_type(&self) -> MotionType {
        match self {
            Self::Ptp(_) => MotionType::Ptp,
            Self::Wait { .. } => MotionType::Wait,
            Self::Cartesian(own) => match own.course {
                Course::Ptp { .. } => MotionType::PtpToFrame,
                Course::Lin { .. } => MotionType::Lin,
                Course::LinRel { .. } => MotionType::LinRel,
                Course::Circ(_) => MotionType::Circ,
                Course::Spline(_) => MotionType::Spline,
            },
        }
    }
}

/// A motion as the path knows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PathMotion {
    pub(crate) motion_type: MotionType,
    /// The TCP that it moves, in the flange's frame.
    pub(crate) tcp: Pose,
}

impl Program {
    /// The TCP that each motion moves, in the flange's frame: that of its tool, and the program's where it has none of
    /// its own; of a wait that of the motion before.
    ///
    /// # Errors
    ///
    /// [`Fault::Cartesian`] if there is no such tool.
    pub fn tcps(&self) -> Result<Vec<Pose>, Fault> {
        let mut before = None;
        let tcps = self.entries().map(|(motion, entry)| {
            let tool = match entry {
                Motion::Cartesian(own) => own.tool.as_deref(),
                Motion::Ptp(_) | Motion::Wait { .. } => None,
            };
            let tcp = match (entry, before) {
                (Motion::Wait { .. }, Some(tcp)) => tcp,
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

/// The motions of a program in order; none at all if it has neither tools nor frames, so that the many joint motions of
/// a long program take no room.
pub(crate) fn path_motions(program: &Program) -> Result<Vec<PathMotion>, Fault> {
    if program.workcell.tool.is_none() && !program.has_frames() {
        return Ok(Vec::new());
    }
    let types = program.motions.iter().map(Motion::motion_type);
    let tcps = program.tcps()?;
    Ok(types.zip(tcps).map(|(motion_type, tcp)| PathMotion { motion_type, tcp }).collect())
}

/// Whether any motion moves another TCP than the flange.
pub(crate) fn has_tools(motions: &[PathMotion]) -> bool {
    motions.iter().any(|motion| motion.tcp != Pose::IDENTITY)
}
