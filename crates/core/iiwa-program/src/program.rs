//! Motion programs.

use std::ops::Range;

use iiwa_kin::{Joint, Joints, Limits, Robot};

use crate::{
    blend::Blend,
    cartesian_motion::{CartesianMotion, PathBlend},
    fault::Fault,
    flange_load::FlangeLoad,
    io_entry::IoEntry,
    limit_kind::{LimitKind, MIN_SHARE, is_share},
    motion_index::MotionIndex,
    source::Sources,
    target::TargetRef,
    workcell::{MAX_FLANGE_M, MAX_TORQUE_LIMIT, MIN_OVERRIDE, MIN_TORQUE_LIMIT, Workcell},
};

/// Tolerance for equal flange lengths, in m, because a length in mm is not exact in m.
const FLANGE_TOLERANCE_M: f64 = 1e-9;

/// A motion program (version 1).
///
/// [`Program::from_json`] reads and checks a program; a program built in code is checked when its
/// path is planned.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// Name of a built-in model or of a robot profile file; the LBR iiwa 7 R800 by default.
    pub robot: Option<String>,
    /// Start pose before the first motion.
    pub start: Start,
    /// Motions in order.
    pub motions: Vec<Motion>,
    /// Tools, bases and frames named by the motions.
    pub workcell: Workcell,
    /// Known sources and labels of the motions.
    pub sources: Sources,
}

/// Start pose before the first motion.
#[derive(Clone, Debug, PartialEq)]
pub enum Start {
    /// Joint positions, in rad.
    Joints(Joints),
    /// TCP frame; E1 and status default to 0 and 2.
    Frame(TargetRef),
}

impl From<Joints> for Start {
    fn from(joints_rad: Joints) -> Self {
        Self::Joints(joints_rad)
    }
}

impl Start {
    /// Joint positions, in rad, unless the start is given by a frame.
    #[must_use]
    pub fn joints_rad(&self) -> Option<&Joints> {
        match self {
            Self::Joints(joints_rad) => Some(joints_rad),
            Self::Frame(_) => None,
        }
    }
}

/// An entry of a program's motion list.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// A point-to-point motion: a straight line in joint space.
    Ptp(Ptp),
    /// A motion to a frame: point to point, or along a TCP path.
    Cartesian(Box<CartesianMotion>),
    /// A wait of the program.
    Wait {
        /// Duration, in s.
        seconds: f64,
        /// Number of preceding motions that the wait overlaps. With 0, the robot rests for the
        /// duration. From 1 on, the time runs from the start of the motion that many motions
        /// before, counting only entries that move, or from the end of the preceding wait if that
        /// is later. The entries after the wait are not known before its end: until then they
        /// neither start nor are blended into.
        overlap: usize,
    },
    /// A payload change at rest: the total payload from here on, tool included, or `None` to return
    /// to the tool's payload. It takes no time.
    Load(Option<FlangeLoad>),
    /// An output that the program sets, or an input that it waits for.
    Io(IoEntry),
}

impl Motion {
    /// Returns true if the robot moves.
    #[must_use]
    pub fn moves(&self) -> bool {
        matches!(self, Self::Ptp(_) | Self::Cartesian(_))
    }

    /// Returns true if the program waits for the end of the motion before it sends the next one.
    #[must_use]
    pub fn is_blocking(&self) -> bool {
        match self {
            Self::Ptp(ptp) => ptp.blocking,
            Self::Cartesian(cartesian) => cartesian.blocking,
            Self::Wait { .. } | Self::Load(_) | Self::Io(_) => false,
        }
    }

    /// Blend at the target of a motion; `None` for other entries, and for a motion that ends in a
    /// stop.
    #[must_use]
    pub fn blend(&self) -> Option<PathBlend> {
        match self {
            Self::Ptp(ptp) => ptp.blend.map(PathBlend::from),
            Self::Cartesian(cartesian) => cartesian.blend,
            Self::Wait { .. } | Self::Load(_) | Self::Io(_) => None,
        }
    }

    /// Returns true for a motion with a blend that has an effect.
    fn has_blend(&self) -> bool {
        match self {
            Self::Ptp(ptp) => ptp.blend.is_some_and(Blend::has_effect),
            Self::Cartesian(cartesian) => cartesian.blend.is_some(),
            Self::Wait { .. } | Self::Load(_) | Self::Io(_) => false,
        }
    }

    /// Returns true for a wait, an input or an output during which the robot may move.
    #[must_use]
    pub fn is_overlapping_wait(&self) -> bool {
        self.overlap() > 0
    }

    /// Number of preceding motions that a wait, an input or an output overlaps; otherwise 0.
    #[must_use]
    pub fn overlap(&self) -> usize {
        match self {
            Self::Wait { overlap, .. } | Self::Io(IoEntry { overlap, .. }) => *overlap,
            Self::Ptp(_) | Self::Cartesian(_) | Self::Load(_) => 0,
        }
    }

    /// Duration of a wait, assumed duration of a wait for an input, or 0 for an output, in s;
    /// `None` for motions and payload changes.
    #[must_use]
    pub fn wait_s(&self) -> Option<f64> {
        match self {
            Self::Wait { seconds, .. } => Some(*seconds),
            Self::Io(entry) => Some(entry.seconds()),
            Self::Ptp(_) | Self::Cartesian(_) | Self::Load(_) => None,
        }
    }

    /// Input or output of the entry, if any.
    #[must_use]
    pub fn io(&self) -> Option<&IoEntry> {
        match self {
            Self::Io(entry) => Some(entry),
            _ => None,
        }
    }
}

/// A point-to-point motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Ptp {
    /// Target position, which the motion only passes near if it is blended, in rad.
    pub target_rad: Joints,
    /// Share of each joint's speed limit, in (0, 1] (Larsen 2019, Eq. 35).
    pub velocity_rel: Joints,
    /// Share of each joint's acceleration limit, in (0, 1].
    pub acceleration_rel: Joints,
    /// Share of each joint's jerk limit, in (0, 1].
    pub jerk_rel: Joints,
    /// Blend at the target; without a blend the robot stops there and settles.
    pub blend: Option<Blend>,
    /// `true` if the program waits for the end of the motion before it sends the next one, which
    /// lengthens the standstill. Not allowed together with a blend.
    pub blocking: bool,
}

impl Ptp {
    /// Motion to `target_rad` at full speed that ends in a stop.
    #[must_use]
    pub fn to(target_rad: Joints) -> Self {
        Self {
            target_rad,
            velocity_rel: [1.0; 7],
            acceleration_rel: [1.0; 7],
            jerk_rel: [1.0; 7],
            blend: None,
            blocking: false,
        }
    }

    /// Share of each joint's limit of a kind: `velocity_rel`, `acceleration_rel` or `jerk_rel`.
    #[must_use]
    pub fn share(&self, kind: LimitKind) -> &Joints {
        match kind {
            LimitKind::Velocity => &self.velocity_rel,
            LimitKind::Acceleration => &self.acceleration_rel,
            LimitKind::Jerk => &self.jerk_rel,
        }
    }

    /// Mutable share of each joint's limit of a kind.
    pub fn share_mut(&mut self, kind: LimitKind) -> &mut Joints {
        match kind {
            LimitKind::Velocity => &mut self.velocity_rel,
            LimitKind::Acceleration => &mut self.acceleration_rel,
            LimitKind::Jerk => &mut self.jerk_rel,
        }
    }

    /// Sets the share of every joint's speed limit, in (0, 1].
    #[must_use]
    pub fn velocity(self, velocity_rel: f64) -> Self {
        Self { velocity_rel: [velocity_rel; 7], ..self }
    }

    /// Sets the blend into the next motion.
    #[must_use]
    pub fn blend(self, blend: Blend) -> Self {
        Self { blend: Some(blend), ..self }
    }

    /// Makes the motion blocking: the program waits for its end.
    #[must_use]
    pub fn blocking(self) -> Self {
        Self { blocking: true, ..self }
    }
}

impl Program {
    /// Checks the program against joint `limits`.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_program::{Fault, Program};
    ///
    /// let program =
    ///     Program::from_deg([0.0; 7]).ptp_deg([0.0, 0.0, 0.0, -130.0, 0.0, 0.0, 0.0]).build();
    /// let fault = program.check(Robot::default().limits()).unwrap_err();
    /// assert!(matches!(fault, Fault::JointOutside { motion: Some(_), .. }));
    /// assert_eq!(
    ///     fault.to_string(),
    ///     "motion 1: joint A4 is at -130 deg; its range is -120 to 120 deg"
    /// );
    /// ```
    ///
    /// # Errors
    ///
    /// The first [`Fault`], with the motion that has it.
    pub fn check(&self, limits: &Limits) -> Result<(), Fault> {
        self.check_numbers()?;
        if let Start::Joints(start_rad) = &self.start {
            check_joints(None, start_rad, limits)?;
        }
        for (motion, entry) in self.entries() {
            if let Motion::Ptp(ptp) = entry {
                check_joints(Some(motion), &ptp.target_rad, limits)?;
            }
        }
        Ok(())
    }

    /// Sets the flange length that the program states; unchanged if the program states none.
    ///
    /// ```
    /// use iiwa_kin::Robot;
    /// use iiwa_program::Program;
    ///
    /// let program = Program::from_json(r#"{
    ///     "version": 1,
    ///     "flange_mm": 126,
    ///     "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
    ///     "motions": [{ "type": "wait", "seconds": 1 }]
    /// }"#)?;
    /// assert_eq!(program.with_flange(Robot::default()).lengths().flange_m, 0.126);
    /// # Ok::<(), iiwa_program::ProgramError>(())
    /// ```
    #[must_use]
    pub fn with_flange(&self, robot: Robot) -> Robot {
        let Some(flange_m) = self.workcell.flange_m else { return robot };
        // An out-of-range length is reported as a fault of the program.
        robot.clone().with_flange_m(flange_m).unwrap_or(robot)
    }

    /// Checks that a robot is the one that the program names, with the flange length that the
    /// program states. A named profile is not read: any robot that is not a built-in model is
    /// accepted for it.
    ///
    /// # Errors
    ///
    /// [`Fault::OtherRobot`] and [`Fault::OtherFlange`].
    pub fn check_robot(&self, robot: &Robot) -> Result<(), Fault> {
        let program_robot = robot.name();
        if let Some(named) = self.robot.as_deref().filter(|named| *named != program_robot) {
            let is_profile = Robot::built_in(named).is_none();
            if !is_profile || is_built_in(robot) {
                return Err(Fault::OtherRobot {
                    named: named.to_owned(),
                    given: program_robot.to_owned(),
                });
            }
        }
        let given_m = robot.lengths().flange_m;
        match self.workcell.flange_m {
            Some(stated_m) if (stated_m - given_m).abs() > FLANGE_TOLERANCE_M => {
                Err(Fault::OtherFlange { stated_m, given_m })
            }
            _ => Ok(()),
        }
    }

    /// Checks everything that can be checked without a robot.
    ///
    /// # Errors
    ///
    /// The first [`Fault`], with the motion that has it.
    pub fn check_numbers(&self) -> Result<(), Fault> {
        if self.motions.is_empty() {
            return Err(Fault::NoMotions);
        }
        if let Some(found) = self.workcell.torque_limit_rel
            && !(MIN_TORQUE_LIMIT..=MAX_TORQUE_LIMIT).contains(&found)
        {
            return Err(Fault::TorqueLimit { found });
        }
        if let Some(found) = self.workcell.speed_override
            && !(MIN_OVERRIDE..=1.0).contains(&found)
        {
            return Err(Fault::Override { found });
        }
        if let Some(found_m) = self.workcell.flange_m
            && !(found_m > 0.0 && found_m <= MAX_FLANGE_M)
        {
            return Err(Fault::Flange { found_m });
        }
        self.checked_entries(0..self.motions.len())
            .try_for_each(|entry| self.check_entry(&entry))?;
        self.tasks().map(drop).map_err(Fault::Task)
    }

    pub(crate) fn check_entry(&self, checked: &CheckedEntry<'_>) -> Result<(), Fault> {
        let CheckedEntry { motion, entry, moves } = *checked;
        match entry {
            Motion::Ptp(ptp) => self.check_ptp(motion, ptp),
            Motion::Cartesian(cartesian) => self.check_cartesian(motion, cartesian),
            Motion::Wait { seconds, .. } if !(0.0..=MAX_WAIT_S).contains(seconds) => {
                Err(Fault::Wait { motion, found: *seconds, max_s: MAX_WAIT_S })
            }
            Motion::Wait { overlap, .. } => check_overlap(motion, *overlap, moves),
            Motion::Load(Some(payload)) if payload.load.check().is_err() => {
                Err(Fault::Load { motion })
            }
            Motion::Load(payload) => match payload.as_ref().and_then(FlangeLoad::shape_fault) {
                Some(fault) => Err(Fault::Shape { motion, fault: Box::new(fault) }),
                None => Ok(()),
            },
            Motion::Io(io) => check_io(motion, io, moves),
        }
    }

    /// Entries in `range` with the motions that they may overlap.
    pub(crate) fn checked_entries(
        &self,
        range: Range<usize>,
    ) -> impl Iterator<Item = CheckedEntry<'_>> {
        let before = self.motions.iter().take(range.start).rev();
        let before = before.take_while(|entry| entry.moves() || entry.is_overlapping_wait());
        // No entry may overlap more motions.
        let mut moves = before.filter(|entry| entry.moves()).take(MAX_OVERLAP).count();
        self.entries().take(range.end).skip(range.start).map(move |(motion, entry)| {
            let checked = CheckedEntry { motion, entry, moves };
            if entry.moves() {
                moves += 1;
            } else if !entry.is_overlapping_wait() {
                moves = 0;
            }
            checked
        })
    }

    /// Checks the motions in `range` as [`check`](Self::check) does.
    ///
    /// # Errors
    ///
    /// The first [`Fault`], with the motion that has it.
    pub fn check_motions(&self, range: Range<usize>, limits: &Limits) -> Result<(), Fault> {
        for checked in self.checked_entries(range) {
            self.check_entry(&checked)?;
            if let Motion::Ptp(ptp) = checked.entry {
                check_joints(Some(checked.motion), &ptp.target_rad, limits)?;
            }
        }
        Ok(())
    }

    /// Returns true if the start or a motion is given by a frame, so that the joint positions
    /// depend on the robot.
    #[must_use]
    pub fn has_frames(&self) -> bool {
        self.start.joints_rad().is_none()
            || self.motions.iter().any(|motion| matches!(motion, Motion::Cartesian(_)))
    }

    /// Motions with their indices.
    pub fn entries(&self) -> impl Iterator<Item = (MotionIndex, &Motion)> {
        (0..).map(MotionIndex::new).zip(&self.motions)
    }

    fn check_ptp(&self, motion: MotionIndex, ptp: &Ptp) -> Result<(), Fault> {
        check_shares(motion, |kind| ptp.share(kind))?;
        if ptp.blocking && ptp.blend.is_some_and(Blend::has_effect) {
            return Err(Fault::BlockingBlend { motion });
        }
        ptp.blend.map_or(Ok(()), |blend| self.check_blend(motion, blend))
    }

    fn check_cartesian(
        &self,
        motion: MotionIndex,
        cartesian: &CartesianMotion,
    ) -> Result<(), Fault> {
        check_shares(motion, |kind| &cartesian.shares[kind])?;
        let fault =
            |key, fault| Fault::Cartesian { motion: Some(motion), key, fault: Box::new(fault) };
        cartesian.tool_limits.check().map_err(|(key, problem)| fault(key, problem))?;
        cartesian.check_segments().map_err(|(key, problem)| fault(key, problem))?;
        let Some(blend) = cartesian.blend else { return Ok(()) };
        if cartesian.blocking {
            return Err(Fault::BlockingBlend { motion });
        }
        blend.check(cartesian.is_ptp()).map_err(|problem| fault("blend", problem))?;
        match blend.in_joints() {
            Some(size) => self.check_blend(motion, size),
            // A blend given by orientation alone has no size to check.
            None => self.check_what_follows(motion),
        }
    }

    fn check_blend(&self, motion: MotionIndex, blend: Blend) -> Result<(), Fault> {
        let (size, max) = match blend {
            Blend::Fraction(b) => (b, 0.5),
            Blend::SunriseRel(x) => (x, 1.0),
            Blend::CartMm(r) => (r, f64::MAX),
        };
        if !(0.0..=max).contains(&size) {
            return Err(Fault::Blend { motion, blend });
        }
        if blend.has_effect() { self.check_what_follows(motion) } else { Ok(()) }
    }

    /// Checks that the next entry does not require a stop. Entries after the last motion are
    /// unknown: the robot stops there.
    fn check_what_follows(&self, motion: MotionIndex) -> Result<(), Fault> {
        // A wait that overlaps the motion does not require a stop.
        let mut next = self.motions.iter().skip(motion.index() + 1);
        match next.find(|entry| !entry.is_overlapping_wait()) {
            Some(Motion::Wait { .. }) => Err(Fault::BlendBeforeWait { motion }),
            Some(Motion::Load(_)) => Err(Fault::BlendBeforeLoad { motion }),
            Some(next @ Motion::Io(_)) => {
                Err(Fault::BlendBeforeIo { motion, next: next.motion_type().name() })
            }
            None | Some(Motion::Ptp(_) | Motion::Cartesian(_)) => Ok(()),
        }
    }

    /// Last motion, if it has a blend: with nothing to blend into, the robot stops there.
    #[must_use]
    pub fn blend_at_the_end(&self) -> Option<MotionIndex> {
        let last = self.motions.iter().rposition(|entry| !entry.is_overlapping_wait())?;
        self.motions[last].has_blend().then(|| MotionIndex::new(last))
    }

    /// Motion before `motion`, if it has a blend into it.
    #[must_use]
    pub fn blend_into(&self, motion: MotionIndex) -> Option<MotionIndex> {
        let before = self.motions.get(..motion.index())?;
        let previous = before.iter().rposition(|entry| !entry.is_overlapping_wait())?;
        self.motions[previous].has_blend().then(|| MotionIndex::new(previous))
    }
}

/// Entry of a program for its check.
#[derive(Clone, Copy)]
pub(crate) struct CheckedEntry<'a> {
    pub(crate) motion: MotionIndex,
    pub(crate) entry: &'a Motion,
    /// Number of preceding motions since the last stop.
    moves: usize,
}

fn check_io(motion: MotionIndex, entry: &IoEntry, moves: usize) -> Result<(), Fault> {
    if let Some((key, message)) = entry.fault() {
        return Err(Fault::Io { motion, key, message });
    }
    let found = entry.seconds();
    if !(0.0..=MAX_WAIT_S).contains(&found) {
        return Err(Fault::Wait { motion, found, max_s: MAX_WAIT_S });
    }
    check_overlap(motion, entry.overlap, moves)
}

/// Checks that enough motions precede a wait since the last stop.
fn check_overlap(motion: MotionIndex, found: usize, before: usize) -> Result<(), Fault> {
    if found > MAX_OVERLAP {
        return Err(Fault::Overlap { motion, found, max: MAX_OVERLAP });
    }
    if before < found {
        return Err(Fault::NothingToOverlap { motion, found, before });
    }
    Ok(())
}

/// Checks that all shares of limits are above 0 and at most 1.
fn check_shares<'a>(
    motion: MotionIndex,
    values_of: impl Fn(LimitKind) -> &'a Joints,
) -> Result<(), Fault> {
    for kind in LimitKind::ALL {
        let values = values_of(kind);
        let wrong = |(_, share): &(Joint, &f64)| !is_share(**share);
        if let Some((joint, &found)) = Joint::ALL.into_iter().zip(values).find(wrong) {
            let joint = values.iter().any(|v| v.to_bits() != found.to_bits()).then_some(joint);
            return Err(Fault::Share { motion, kind, joint, found, min: MIN_SHARE });
        }
    }
    Ok(())
}

/// Longest accepted wait: more than a day is assumed to be a typing error, and would fill a disk
/// with samples.
const MAX_WAIT_S: f64 = 24.0 * 3600.0;

/// Largest number of motions that a wait may overlap.
pub const MAX_OVERLAP: usize = 1000;

pub(crate) fn check_joints(
    motion: Option<MotionIndex>,
    joints: &Joints,
    limits: &Limits,
) -> Result<(), Fault> {
    limits.check(joints).map_err(|outside| Fault::JointOutside { motion, outside })
}

/// Returns true for a built-in model with any flange length.
fn is_built_in(robot: &Robot) -> bool {
    Robot::built_in(robot.name()).is_some_and(|model| {
        let flange_m = model.lengths().flange_m;
        robot.clone().with_flange_m(flange_m).is_ok_and(|robot| robot == model)
    })
}
