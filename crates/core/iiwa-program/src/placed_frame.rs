//! Poses of the frames of a program.

use iiwa_kin::Pose;

use crate::{
    cartesian_motion::{Course, SegmentCourse},
    program::{Motion, Program, Start},
    target::TargetRef,
    workcell::NameFault,
};

/// A frame of a program, with its pose.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedFrame {
    /// Name; `None` if the frame is given inline.
    pub name: Option<String>,
    /// Pose in the robot base.
    pub pose: Pose,
}

impl Program {
    /// Frames of the program: named frames first, then the inline frames of start and motions, in
    /// order.
    ///
    /// ```
    /// use iiwa_program::Program;
    ///
    /// let program = Program::from_json(r#"{
    ///     "version": 1,
    ///     "bases": { "table": { "x_mm": 500 } },
    ///     "frames": { "pick": { "base": "table", "x_mm": 20, "y_mm": 0, "z_mm": 300,
    ///                           "a_deg": 0, "b_deg": 180, "c_deg": 0 } },
    ///     "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
    ///     "motions": [{ "type": "ptp", "frame": "pick" }]
    /// }"#)?;
    /// let frames = program.placed_frames()?;
    /// assert_eq!(frames[0].name.as_deref(), Some("pick"));
    /// assert!((frames[0].pose.position_m[0] - 0.52).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If a base is unknown.
    pub fn placed_frames(&self) -> Result<Vec<PlacedFrame>, NameFault> {
        let placed = |name: Option<&String>, target: &TargetRef, base: Option<&str>| {
            let (_, pose) = self.workcell.target(target, base)?;
            Ok(PlacedFrame { name: name.cloned(), pose })
        };
        let named = self.workcell.frames.keys();
        let mut frames = named
            .map(|name| placed(Some(name), &TargetRef::Named(name.clone()), None))
            .collect::<Result<Vec<_>, _>>()?;
        let mut add = |target: &TargetRef, base: Option<&str>| {
            if matches!(target, TargetRef::Given(_)) {
                frames.push(placed(None, target, base)?);
            }
            Ok(())
        };
        if let Start::Frame(target) = &self.start {
            add(target, None)?;
        }
        for motion in &self.motions {
            let Motion::Cartesian(cartesian) = motion else { continue };
            let base = cartesian.base.as_deref();
            match &cartesian.course {
                Course::Ptp { to } | Course::Lin { to } => add(to, base)?,
                Course::Circ(circ) => {
                    add(&circ.aux, base)?;
                    add(&circ.to, base)?;
                }
                Course::Spline(segments) => {
                    for segment in segments {
                        if let SegmentCourse::Circ(circ) = &segment.course {
                            add(&circ.aux, base)?;
                        }
                        add(segment.course.target(), base)?;
                    }
                }
                Course::LinRel { .. } => {}
            }
        }
        Ok(frames)
    }
}
