//! Targets whose turn contradicts the joints there.

use std::{fmt, sync::Arc};

use iiwa_kin::{Joints, Robot, Turn};

use crate::legs::Legs;
use iiwa_program::{
    CartesianMotion, Course, Fault, Motion, MotionIndex, OrientationType, Program, SegmentCourse,
    Start, TargetRef,
};

/// A target whose turn differs from that of the joints with which the robot arrives there: the
/// frame was moved after teaching, or taught with another robot, another tool or another status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TurnContradiction {
    /// The motion; `None` for the start pose.
    pub motion: Option<MotionIndex>,
    /// The turn that the target states.
    pub stated: Turn,
    /// The turn of the joints.
    pub found: Turn,
}

impl fmt::Display for TurnContradiction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.motion {
            Some(motion) => write!(f, "motion {motion}: ")?,
            None => f.write_str("the start pose: ")?,
        }
        let Self { stated, found, .. } = self;
        write!(f, "the frame states turn {stated}, and the joints there have turn {found}")
    }
}

impl TurnContradiction {
    /// Returns the targets of a program whose turn contradicts the joints with which the robot
    /// arrives, in order. The path does not depend on the turn: the other redundancy values
    /// determine the joints.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_path::TurnContradiction;
    /// use iiwa_program::Program;
    ///
    /// let program = Program::from_json(r#"{
    ///     "version": 1,
    ///     "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
    ///     "motions": [{ "type": "ptp", "frame": { "x_mm": 600, "y_mm": 0, "z_mm": 300,
    ///         "a_deg": 0, "b_deg": 180, "c_deg": 0, "e1_deg": 0, "status": 2, "turn": 0 } }]
    /// }"#)?;
    /// let found = TurnContradiction::all(&program, &Robot::default())?;
    /// assert_eq!(
    ///     found[0].to_string(),
    ///     "motion 1: the frame states turn 0, and the joints there have turn 8"
    /// );
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the program requires something that this robot cannot do.
    pub fn all(program: &Program, robot: &Robot) -> Result<Vec<Self>, Fault> {
        let at_start = match &program.start {
            Start::Frame(target) => stated_turn(program, target),
            Start::Joints(_) => None,
        };
        let at_ends: Vec<_> = program
            .motions
            .iter()
            .map(|motion| stated_turn(program, cartesian(motion).and_then(destination)?))
            .collect();
        if at_start.is_none() && at_ends.iter().all(Option::is_none) {
            return Ok(Vec::new());
        }
        let robot = Arc::new(robot.clone());
        let contradiction = |motion, stated: Turn, joints_rad: &Joints| {
            let found = Turn::of(joints_rad);
            let contradicts = !stated.agrees_with(joints_rad);
            contradicts.then_some(TurnContradiction { motion, stated, found })
        };
        let mut contradictions = Vec::new();
        if let Some(stated) = at_start {
            contradictions.extend(contradiction(None, stated, &program.start_rad(&robot)?));
        }
        let legs = Legs::new(program, &robot)?;
        for (index, stated) in at_ends.into_iter().enumerate() {
            let (Some(stated), Some(leg)) = (stated, legs.get(index)) else { continue };
            let motion = Some(MotionIndex::new(index));
            contradictions.extend(contradiction(motion, stated, &leg.ends_rad[1]));
        }
        Ok(contradictions)
    }
}

fn stated_turn(program: &Program, target: &TargetRef) -> Option<Turn> {
    let target = match target {
        TargetRef::Given(target) => target,
        TargetRef::Named(name) => program.workcell.frames.get(name)?,
    };
    target.turn.and_then(Turn::new)
}

fn cartesian(motion: &Motion) -> Option<&CartesianMotion> {
    match motion {
        Motion::Cartesian(cartesian) => Some(cartesian),
        _ => None,
    }
}

/// The target at which a motion ends.
fn destination(motion: &CartesianMotion) -> Option<&TargetRef> {
    match &motion.course {
        // A circle with an angle does not end at its frame.
        Course::Circ(circ) if circ.angle_rad.is_some() => None,
        Course::Spline(segments) => {
            let last = segments.last()?;
            let law = last.orientation.unwrap_or(motion.orientation);
            let (SegmentCourse::Spl { to } | SegmentCourse::Lin { to }) = &last.course else {
                return None;
            };
            (law == OrientationType::Variable).then_some(to)
        }
        // The TCP arrives with another orientation.
        _ if motion.orientation == OrientationType::Constant => None,
        _ => motion.target(),
    }
}
