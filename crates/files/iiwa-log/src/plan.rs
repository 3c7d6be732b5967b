//! Writing a planned trajectory, section by section.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::Write;
use std::time::Duration;

use iiwa_kin::{Joints, Pose, Robot};
use iiwa_plan::{Plan, PlanFigures};
use iiwa_traj::{MotionDynamics, Section, State};
use serde_json::Value;

use crate::arm::Arm;
use crate::{Config, MotionEntry, TrajectoryMessage, TrajectoryPoint, WriteError, Writer};

/// Options of a plan file.
#[derive(Clone, Debug)]
pub struct PlanConfig {
    /// Joint states per second.
    pub rate_hz: f64,
    /// Options of the file.
    pub file: Config,
}

impl Default for PlanConfig {
    /// Returns 250 joint states per second and chunks of 128 KiB.
    fn default() -> Self {
        let file = Config { chunk_bytes: 128 * 1024, ..Config::default() };
        Self { rate_hz: 250.0, file }
    }
}

/// Writes a trajectory into an MCAP file while it is planned: memory use does not grow with the
/// program.
///
/// ```
/// use std::io::Cursor;
///
/// use iiwa_log::{PlanConfig, PlanRecord, PlanWriter};
/// use iiwa_plan::{PlanRequest, ProgramSource};
///
/// # let text = r#"{ "version": 1, "start": { "joints_deg": [-20, 0, 0, 0, 0, 0, 0] },
/// #     "motions": [{ "type": "ptp", "joints_deg": [20, 0, 0, 0, 0, 0, 0] }] }"#;
/// let mut planning = PlanRequest::default().begin(&ProgramSource::from_json(text)?)?;
/// let stream = Cursor::new(Vec::new());
/// let mut writer = PlanWriter::new(stream, planning.robot(), PlanConfig::default())?;
/// while let Some(section) = planning.next() {
///     writer.section(&section?)?;
/// }
/// let file = writer.finish(planning.figures(), Some(planning.text().complete()))?.into_inner();
///
/// let record = PlanRecord::read(&*file)?;
/// assert_eq!(record.figures().as_ref(), Some(planning.figures()));
/// assert_eq!(record.robot()?.as_ref(), Some(planning.robot()));
/// assert_eq!(record.program.as_deref(), Some(text));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// The trajectory is one message on `/joint_trajectory`. Above a hundred thousand points, some
/// twenty megabytes, it continues in further messages, each stamped with its own start and
/// beginning with the last point of the message before.
#[derive(Debug)]
pub struct PlanWriter<W: Write> {
    writer: Writer<W>,
    arm: Arm,
    dynamics: MotionDynamics,
    rate_hz: f64,
    /// Number of joint states written so far.
    ticks: u64,
    part: TrajectoryMessage,
    part_start: Duration,
    /// End of the last section.
    last: Option<ArmInstant>,
}

/// State of the arm at one time.
#[derive(Debug)]
struct ArmInstant {
    state: State,
    /// Torques that the joints exert, in Nm.
    torque_nm: Joints,
    /// Moving TCP in the flange frame, if the program has tools.
    tcp: Option<Pose>,
}

impl ArmInstant {
    fn of(section: &Section, t_s: f64, dynamics: &mut MotionDynamics) -> Self {
        let state = section.at(t_s);
        let path = section.path();
        let tcp = path.has_tools().then(|| *path.tcp(state.motion));
        Self { state, torque_nm: dynamics.torque_nm(section, &state), tcp }
    }
}

/// Maximum number of trajectory points per message.
const POINTS: usize = 100_000;

impl<W: Write> PlanWriter<W> {
    /// Begins a file for `robot` in an empty stream.
    ///
    /// # Errors
    ///
    /// Any [`WriteError`].
    pub fn new(stream: W, robot: &Robot, config: PlanConfig) -> Result<Self, WriteError> {
        let arm = Arm::with_names(robot, &config.file.names);
        let mut writer = Writer::new(stream, config.file)?;
        arm.description(&mut writer)?;
        Ok(Self {
            writer,
            arm,
            dynamics: MotionDynamics::default(),
            rate_hz: config.rate_hz,
            ticks: 0,
            part: TrajectoryMessage::new()?,
            part_start: Duration::ZERO,
            last: None,
        })
    }

    /// Writes a section; sections must come in order.
    ///
    /// # Errors
    ///
    /// Any [`WriteError`].
    pub fn section(&mut self, section: &Section) -> Result<(), WriteError> {
        let mut pieces = section
            .pieces()
            .iter()
            .filter(|piece| duration(piece.end_s) > duration(piece.start_s))
            .peekable();
        loop {
            // Pieces and samples in the order of time: viewers read such files fastest.
            let t_s = self.ticks as f64 / self.rate_hz;
            if let Some(piece) =
                pieces.next_if(|piece| piece.start_s <= t_s || t_s >= section.end_s())
            {
                let label = section.path().sources().label(piece.motion);
                let motion = MotionEntry {
                    index: u32::try_from(piece.motion.number()).unwrap_or(u32::MAX),
                    kind: Cow::Borrowed(piece.kind.name()),
                    limiting_joint: piece
                        .limited_by
                        .and_then(|l| u8::try_from(l.joint()?.number()).ok()),
                    limiting_kind: Cow::Borrowed(piece.limited_by.map_or("", |l| l.name())),
                    name: label.and_then(|label| label.name.as_deref()).map(Cow::Borrowed),
                    group: label.and_then(|label| label.group.as_deref()).map(Cow::Borrowed),
                };
                self.writer.motion(duration(piece.start_s), &motion)?;
            } else if t_s < section.end_s() {
                let instant = ArmInstant::of(section, t_s, &mut self.dynamics);
                self.sample(&instant)?;
                self.ticks += 1;
            } else {
                break;
            }
        }
        let nodes: usize = section.pieces().iter().map(|piece| section.nodes(piece).len()).sum();
        self.part.reserve(nodes.min(POINTS - self.part.len()));
        for state in section.states() {
            self.node(&state)?;
        }
        self.last = Some(ArmInstant::of(section, section.end_s(), &mut self.dynamics));
        Ok(())
    }

    /// Writes the end, the figures, the robot's profile and URDF, and the text of the program if
    /// given; completes the file and returns the stream.
    ///
    /// # Errors
    ///
    /// Any [`WriteError`].
    pub fn finish(mut self, figures: &PlanFigures, program: Option<&str>) -> Result<W, WriteError> {
        if let Some(end) = self.last.take() {
            // The last tick may already be the end, up to rounding.
            let last_tick = self.ticks.checked_sub(1).map(|k| k as f64 / self.rate_hz);
            if last_tick.is_none_or(|t_s| duration(t_s) < duration(end.state.t_s)) {
                self.sample(&end)?;
            }
            self.node(&end.state)?;
        }
        self.writer.joint_trajectory(self.part_start, self.part)?;
        let program = program.map(|text| ("program.json", "application/json", text.as_bytes()));
        self.arm.finish(self.writer, &metadata(figures), program.as_slice())
    }

    /// Writes one instant on `/joint_states`, `/tf` and `/tcp_pose`; with a tool, on `/flange_pose`
    /// as well.
    fn sample(&mut self, instant: &ArmInstant) -> Result<(), WriteError> {
        let ArmInstant { state, torque_nm, tcp } = instant;
        let t = duration(state.t_s);
        self.writer.joint_state(t, &state.q, &state.dq, Some(torque_nm))?;
        match tcp {
            None => self.arm.poses(&mut self.writer, t, &state.q),
            Some(tcp) => self.arm.poses_with_tool(&mut self.writer, t, &state.q, tcp),
        }
    }

    /// Writes one point of `/joint_trajectory`.
    fn node(&mut self, state: &State) -> Result<(), WriteError> {
        let t = duration(state.t_s);
        let point = |start: Duration| TrajectoryPoint {
            time_from_start: t.saturating_sub(start),
            positions: state.q,
            velocities: state.dq,
            accelerations: state.ddq,
        };
        let next = point(self.part_start);
        if self.part.last().is_some_and(|last| next.time_from_start <= last) {
            // Less than a nanosecond after the previous point.
            return Ok(());
        }
        self.part.push(&next)?;
        if self.part.len() >= POINTS {
            let full = std::mem::replace(&mut self.part, TrajectoryMessage::new()?);
            self.writer.joint_trajectory(self.part_start, full)?;
            self.part_start = t;
            self.part.push(&point(t))?;
        }
        Ok(())
    }
}

/// Converts a time in s to the nearest nanosecond.
fn duration(t_s: f64) -> Duration {
    Duration::try_from_secs_f64(t_s).unwrap_or_default()
}

/// Converts the figures to entries of a metadata record, one per key: texts unchanged, all other
/// values as JSON. [`PlanRecord`](crate::PlanRecord) reads them back.
fn metadata(figures: &PlanFigures) -> BTreeMap<String, String> {
    let Ok(Value::Object(object)) = serde_json::to_value(figures) else {
        return BTreeMap::new();
    };
    let text = |value| match value {
        Value::String(text) => text,
        other => other.to_string(),
    };
    object.into_iter().map(|(key, value)| (key, text(value))).collect()
}

/// Writes a plan with the text of its program, and returns the stream.
///
/// # Errors
///
/// Any [`WriteError`].
pub fn write_plan<W: Write>(
    stream: W,
    plan: &Plan,
    config: PlanConfig,
    program: &str,
) -> Result<W, WriteError> {
    let mut writer = PlanWriter::new(stream, plan.robot(), config)?;
    for section in plan.trajectory.sections() {
        writer.section(section)?;
    }
    writer.finish(&plan.figures(), Some(program))
}
