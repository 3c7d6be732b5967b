//! Threads of the robot program.

use std::{
    sync::{
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, RecvTimeoutError, Sender},
    },
    thread,
    time::{Duration, Instant},
};

use bytes::Bytes;
use iiwa_kin::{Joints, Robot};
use iiwa_link::{
    message::{Code, Refusal, to_json},
    robot_program::{
        Acknowledgement, BEGIN_WITHIN, Instruction, RunId, STATE_EVERY_MS, StateChange,
    },
    transport::{Event, Frames, Listener, PeerId},
};
use iiwa_program::MotionList;
use iiwa_traj::Trajectory;

use crate::{
    shared::{CabinetState, POLL_INTERVAL, lock},
    simulation::plan,
};

/// Input of the robot program.
pub(crate) enum ProgramInput {
    Socket(Event),
    Planned(PlanningResult),
}

/// Motions to be planned.
pub(crate) struct PlanningJob {
    run: RunId,
    start_rad: Joints,
    motions: MotionList,
}

/// Result of planning.
pub(crate) struct PlanningResult {
    run: RunId,
    result: Result<Trajectory, Refusal>,
}

/// Plans motions until the job sender is dropped.
pub(crate) fn plan_motions(
    robot: &Robot,
    jobs: &Receiver<PlanningJob>,
    done: impl Fn(PlanningResult),
) {
    for PlanningJob { run, start_rad, motions } in jobs {
        done(PlanningResult { run, result: plan(robot, start_rad, motions) });
    }
}

/// Carries out iiwaDrive instructions and acknowledges them. Motions are planned first and begin
/// with another instruction, so that they do not begin if they were withdrawn meanwhile.
pub(crate) struct RobotProgram<'a> {
    shared: &'a CabinetState,
    socket: Listener,
    planner: Sender<PlanningJob>,
    /// The instruction that is acknowledged once its motions are planned.
    planning: Option<PendingPlan>,
    /// Planned motions that wait to begin.
    planned: Option<PlannedMotions>,
}

struct PendingPlan {
    run: RunId,
    source: InstructionSource,
    is_withdrawn: bool,
}

struct PlannedMotions {
    run: RunId,
    trajectory: Trajectory,
    since: Instant,
}

/// The sender of an instruction, and its number.
struct InstructionSource {
    peer: PeerId,
    /// The frames before the instruction.
    envelope: Frames,
    seq: Option<u64>,
}

impl<'a> RobotProgram<'a> {
    pub(crate) fn new(
        shared: &'a CabinetState,
        socket: Listener,
        planner: Sender<PlanningJob>,
    ) -> Self {
        Self { shared, socket, planner, planning: None, planned: None }
    }

    /// Serves instructions until `shutdown`.
    pub(crate) fn run(mut self, inputs: &Receiver<ProgramInput>, shutdown: &AtomicBool) {
        while !shutdown.load(Ordering::Relaxed) {
            match inputs.recv_timeout(POLL_INTERVAL) {
                Ok(ProgramInput::Socket(Event::Message(peer, received))) => {
                    self.receive(peer, received.frames);
                }
                // Motions planned for a disconnected drive expire: another drive does not begin
                // them.
                Ok(ProgramInput::Socket(Event::Disconnected(_)))
                | Err(RecvTimeoutError::Timeout) => {}
                Ok(ProgramInput::Planned(result)) => self.planned(result),
                Err(RecvTimeoutError::Disconnected) => return,
            }
            self.planned.take_if(|waiting| waiting.since.elapsed() > BEGIN_WITHIN);
        }
    }

    fn receive(&mut self, peer: PeerId, mut envelope: Frames) {
        // An empty frame and the instruction, as sent by REQ.
        let body = envelope.pop().unwrap_or_default();
        let (seq, instruction) = if envelope.len() <= 1 && envelope.iter().all(Bytes::is_empty) {
            Instruction::from_json(&body)
        } else {
            envelope.truncate(1);
            (None, Err(Refusal::bad("an instruction has to consist of one frame")))
        };
        let source = InstructionSource { peer, envelope, seq };
        match instruction.and_then(|instruction| self.carry_out(instruction)) {
            Ok(AcknowledgeWhen::Now(answer)) => self.acknowledge(source, answer),
            Ok(AcknowledgeWhen::Planned(run)) => {
                self.planning = Some(PendingPlan { run, source, is_withdrawn: false });
            }
            Err(refusal) => self.reject(source, refusal),
        }
    }

    fn carry_out(&mut self, instruction: Instruction) -> Result<AcknowledgeWhen, Refusal> {
        let mut simulation = lock(&self.shared.simulation);
        match instruction {
            Instruction::RunMotions { run, motions } => {
                simulation.check_ready()?;
                if self.planning.is_some() {
                    return Err(Refusal::new(Code::NotIdle, "other motions are being planned"));
                }
                self.planned = None;
                let start_rad = *simulation.position();
                // The planner outlives this thread.
                let _ = self.planner.send(PlanningJob { run, start_rad, motions });
                Ok(AcknowledgeWhen::Planned(run))
            }
            Instruction::Begin { run } => {
                let waiting = self.planned.take_if(|waiting| waiting.run == run);
                let Some(PlannedMotions { trajectory, .. }) = waiting else {
                    return Err(Refusal::robot(
                        "these motions are not planned, or their plan has expired",
                    ));
                };
                simulation
                    .begin(run, trajectory)
                    .map(|()| AcknowledgeWhen::Now(Acknowledgement::default()))
            }
            Instruction::Stop => {
                self.planned = None;
                if let Some(planning) = &mut self.planning {
                    planning.is_withdrawn = true;
                }
                simulation.carry_out(Instruction::Stop).map(AcknowledgeWhen::Now)
            }
            instruction => simulation.carry_out(instruction).map(AcknowledgeWhen::Now),
        }
    }

    /// Handles the result of planning.
    fn planned(&mut self, PlanningResult { run, result }: PlanningResult) {
        let Some(PendingPlan { source, is_withdrawn, .. }) =
            self.planning.take_if(|planning| planning.run == run)
        else {
            return;
        };
        match result {
            Ok(_) if is_withdrawn => {
                self.reject(
                    source,
                    Refusal::robot("stopped on request, before the motions were planned"),
                );
            }
            Ok(trajectory) => {
                self.planned = Some(PlannedMotions { run, trajectory, since: Instant::now() });
                self.acknowledge(source, Acknowledgement::default());
            }
            Err(refusal) => self.reject(source, refusal),
        }
    }

    fn reject(&self, source: InstructionSource, refusal: Refusal) {
        let error = Some(refusal);
        self.acknowledge(source, Acknowledgement { error, ..Acknowledgement::default() });
    }

    fn acknowledge(&self, source: InstructionSource, answer: Acknowledgement) {
        let InstructionSource { peer, envelope: mut frames, seq } = source;
        frames.push(to_json(&Acknowledgement { seq, ..answer }).into());
        self.socket.send(peer, frames, None);
    }
}

/// Time of the acknowledgement of an instruction.
enum AcknowledgeWhen {
    Now(Acknowledgement),
    Planned(RunId),
}

/// Sends the state on every change, repeatedly until acknowledged, and periodically in any case.
pub(crate) fn send_states(
    shared: &CabinetState,
    socket: &Listener,
    acknowledged: &AtomicBool,
    shutdown: &AtomicBool,
) {
    const POLL_INTERVAL: Duration = Duration::from_millis(2);
    let every = Duration::from_millis(STATE_EVERY_MS);
    let again = Duration::from_millis(100);
    let mut last_sent: Option<(StateChange, Instant)> = None;
    while !shutdown.load(Ordering::Relaxed) {
        let change = {
            let mut simulation = lock(&shared.simulation);
            let wait = if acknowledged.load(Ordering::Relaxed) { every } else { again };
            let due = last_sent.as_ref().is_none_or(|(_, instant)| instant.elapsed() >= wait);
            simulation.take_change().or_else(|| due.then(|| simulation.state()))
        };
        if let Some(change) = change {
            acknowledged.store(false, Ordering::Relaxed);
            socket.publish(&vec![Bytes::new(), to_json(&change).into()]);
            last_sent = Some((change, Instant::now()));
        }
        thread::sleep(POLL_INTERVAL);
    }
}
