//! The state of the dispatcher.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use bytes::Bytes;
use iiwa_fri::{Quality, Safety};
use iiwa_link::{
    Published,
    message::{
        Code, DriveState, DriveStatus, FriStatus, Id, Presence, Refusal, Reply, ReplyBody,
        RobotIdentity, RunEnd, RunEvent, RunLabel,
    },
    robot_program::{Instruction, RunId, StateChange},
    transport::Permit,
};

use crate::drive::{
    checks::CheckJob,
    events::{FriCommand, Observation, UnexpectedSource},
    instruction_queue::InstructionQueue,
    protocol::check_protocol,
    run::ActiveRun,
    run_replies::{RunRecord, RunReply},
};

/// An output of the dispatcher.
pub(in crate::drive) enum DispatcherOutput<C> {
    /// A reply to a client.
    Reply(C, String),
    /// A reply that another thread writes, because it may be long.
    RunReply(RunReply<C>),
    /// A request that another thread parses and checks.
    Check(CheckJob<C>),
    /// An instruction to the robot program.
    Instruct(String),
    /// A reconnection to the robot program, which does not answer: instructions in transit must not
    /// arrive later.
    Reconnect,
    /// A command to the FRI thread.
    Fri(FriCommand),
    /// A message of the stream.
    Publish(Published),
}

/// A request as received.
pub(in crate::drive) struct IncomingRequest {
    pub(in crate::drive) body: Bytes,
    /// The permit of a long request.
    pub(in crate::drive) permit: Option<Permit>,
    /// Arrival time of the first bytes.
    pub(in crate::drive) began: Instant,
}

/// Destination of a reply: a client, and the id of its request.
pub(in crate::drive) struct Requester<C> {
    pub(super) client: C,
    pub(super) id: Option<Id>,
}

/// The dispatcher. `C` identifies clients.
pub(in crate::drive) struct Dispatcher<C> {
    /// The robot that the drive is configured for.
    pub(super) robot: RobotIdentity,
    pub(super) stage: RunStage<C>,
    /// The latest FRI message.
    pub(super) observation: Option<Observation>,
    /// The source address of FRI messages, if it differs from the controller address.
    pub(super) unexpected: Option<UnexpectedSource>,
    /// The latest state of the robot program, and its arrival time.
    pub(super) program: Option<(StateChange, Instant)>,
    /// `true` if the silence of the robot program has been logged.
    pub(super) program_lost: bool,
    pub(super) first_run: RunId,
    pub(super) next_run: RunId,
    pub(super) instructions: InstructionQueue<Purpose<C>>,
    /// Runs withdrawn during the check, with the reason.
    pub(super) withdrawn: Vec<(RunId, Requester<C>, Refusal)>,
    /// Arrival time of the last stop request.
    pub(super) stopped: Option<Instant>,
    /// Clients that wait for standstill, with the arrival times of their requests.
    pub(super) stoppers: Vec<(Requester<C>, Instant)>,
    /// Time at which a run was abandoned that the robot program may have begun.
    pub(super) abandoned: Option<Instant>,
    pub(super) last_run: Option<Arc<RunRecord>>,
    pub(super) outputs: Vec<DispatcherOutput<C>>,
}

pub(super) enum RunStage<C> {
    Idle,
    /// A run is being parsed and checked.
    Checking(RunId, Requester<C>),
    Running(Box<ActiveRun<Requester<C>>>),
}

/// The purpose of an instruction.
pub(super) enum Purpose<C> {
    /// Query a value for a client.
    Query(Requester<C>, QueryKind),
    /// Plan the motions of a run.
    Plan(RunId),
    /// Begin a run.
    Begin(RunId),
    /// Stop or end a run.
    End,
}

/// The value that an acknowledgement must contain.
#[derive(Clone, Copy)]
pub(super) enum QueryKind {
    Value,
    Sensors,
    Signals,
}

/// Silence after which the robot program counts as disconnected; it sends its state twice per
/// second.
const PROGRAM_TIMEOUT: Duration = Duration::from_secs(3);

/// Silence after which FRI counts as silent.
const FRI_TIMEOUT: Duration = Duration::from_millis(500);

impl<C> Dispatcher<C> {
    /// Creates a dispatcher. `first_run` must differ with each start of a drive.
    pub(in crate::drive) fn new(first_run: RunId, robot: RobotIdentity) -> Self {
        Self {
            robot,
            stage: RunStage::Idle,
            observation: None,
            unexpected: None,
            program: None,
            program_lost: false,
            first_run,
            next_run: first_run,
            instructions: InstructionQueue::new(),
            withdrawn: Vec::new(),
            stopped: None,
            stoppers: Vec::new(),
            abandoned: None,
            last_run: None,
            outputs: Vec::new(),
        }
    }

    /// Returns the outputs since the last call.
    pub(in crate::drive) fn take_outputs(&mut self) -> Vec<DispatcherOutput<C>> {
        std::mem::take(&mut self.outputs)
    }

    /// Returns the kind of the current run; without a current run, the state of the robot program,
    /// which may still execute a run that this drive does not track.
    pub(super) fn drive_state(&self, now: Instant) -> DriveState {
        match &self.stage {
            RunStage::Running(running) => running.kind,
            _ => self.program_at(now).map_or(DriveState::Idle, |program| program.state),
        }
    }

    pub(super) fn status(&self, now: Instant) -> DriveStatus {
        let state = self.drive_state(now);
        let fresh =
            self.observation.filter(|it| now.saturating_duration_since(it.at) <= FRI_TIMEOUT);
        let mut fri = FriStatus::new(
            fresh.map_or(FriStatus::SILENT, |it| it.session.name()),
            fresh.map_or(Quality::Poor, |it| it.quality).name(),
        );
        fri.lost = self.observation.map_or(0, |it| it.lost);
        fri.late = self.observation.map_or(0, |it| it.late);
        fri.unexpected_source = self.unexpected_source(now).map(|it| it.from);
        fri.safety_stop = fresh.is_some_and(|it| it.safety != Safety::Normal);
        let mut status = DriveStatus::new(state, fri);
        status.robot = Some(self.robot.clone());
        status.joints_rad = self.observation.map(|it| it.joints_rad);
        status.t_s = self.observation.map(|it| it.t_s);
        if let Some(program) = self.program_at(now) {
            status.robot_program = Presence::Connected;
            status.simulated = program.simulated;
            status.hello.clone_from(&program.hello);
            status.conditions.clone_from(&program.conditions);
        }
        status
    }

    /// Returns the latest state of the robot program, unless it is disconnected.
    pub(super) fn program_at(&self, now: Instant) -> Option<&StateChange> {
        let (state, instant) = self.program.as_ref()?;
        (now.saturating_duration_since(*instant) <= PROGRAM_TIMEOUT).then_some(state)
    }

    /// Returns the source address of FRI messages while none arrive from the controller address.
    fn unexpected_source(&self, now: Instant) -> Option<UnexpectedSource> {
        let is_recent = |instant: Instant| now.saturating_duration_since(instant) <= FRI_TIMEOUT;
        let is_silent = self.observation.is_none_or(|it| !is_recent(it.at));
        self.unexpected.filter(|it| is_silent && is_recent(it.at))
    }

    /// Checks that the robot program uses this drive's protocol version.
    pub(super) fn check_protocol(&self, now: Instant) -> Result<(), Refusal> {
        let hello = self.program_at(now).and_then(|program| program.hello.as_ref());
        hello.map_or(Ok(()), check_protocol)
    }

    /// Checks that the robot at the cabinet matches the configured robot, if the robot program
    /// reports it.
    fn check_robot(&self, program: &StateChange) -> Result<(), Refusal> {
        let at_cabinet = program.hello.as_ref().and_then(|hello| hello.robot.as_ref());
        at_cabinet.map_or(Ok(()), |it| self.robot.check_cabinet(it))
    }

    pub(super) fn check_idle(&self, now: Instant) -> Result<(), Refusal> {
        match self.drive_state(now) {
            DriveState::Idle => Ok(()),
            state => Err(Refusal::new(
                Code::NotIdle,
                format!("the robot is busy: {state}; wait for its end, or send `stop`"),
            )),
        }
    }

    /// Checks that the robot program and FRI are connected and no safety stop is active.
    pub(super) fn check_connected(&self, now: Instant) -> Result<Observation, Refusal> {
        let Some(program) = self.program_at(now) else {
            return Err(Refusal::robot(
                "the robot program does not answer; is the cabinet running?",
            ));
        };
        self.check_protocol(now)?;
        self.check_robot(program)?;
        let stopped = program.conditions.as_ref().and_then(|it| it.safety_stop) == Some(true);
        match self.observation {
            Some(it) if now.saturating_duration_since(it.at) <= FRI_TIMEOUT => {
                if it.safety == Safety::Normal && !stopped {
                    Ok(it)
                } else {
                    Err(Refusal::robot("a safety stop of the robot is active"))
                }
            }
            _ => {
                let source = self.unexpected_source(now).map(|it| format!("; they come {it}"));
                let reason = "no FRI messages arrive: the robot's position is unknown";
                let reason = format!("{reason}{}", source.unwrap_or_default());
                Err(Refusal::robot(reason))
            }
        }
    }

    pub(super) fn instruct(&mut self, instruction: Instruction, purpose: Purpose<C>, now: Instant) {
        self.instructions.add(instruction, purpose, now);
        self.send_next(now);
    }

    pub(super) fn send_next(&mut self, now: Instant) {
        if let Some(instruction) = self.instructions.next(now) {
            self.outputs.push(DispatcherOutput::Instruct(instruction));
        }
    }

    pub(super) fn reply(
        &mut self,
        requester: Requester<C>,
        result: Result<Option<ReplyBody>, Refusal>,
    ) {
        let (error, body) = match result {
            Ok(body) => (None, body),
            Err(error) => (Some(error), None),
        };
        let Requester { client, id } = requester;
        let reply = Reply { id: id.as_ref(), error: error.as_ref(), body: body.as_ref() };
        let text = reply.to_json();
        self.outputs.push(DispatcherOutput::Reply(client, text));
    }

    /// Publishes the beginning or the end of a run.
    pub(super) fn publish_run(
        &mut self,
        run: RunId,
        kind: DriveState,
        label: &RunLabel,
        end: Option<RunEnd>,
    ) {
        let t_s = self.observation.map_or(0.0, |it| it.t_s);
        let event = RunEvent { t_s, run, kind, label: label.clone(), end };
        self.outputs.push(DispatcherOutput::Publish(Published::Run(Box::new(event))));
    }

    pub(super) fn reply_run(&mut self, requester: Requester<C>, record: Arc<RunRecord>) {
        let Requester { client, id } = requester;
        self.outputs.push(DispatcherOutput::RunReply(RunReply { client, id, record }));
    }
}
