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
        Body, Code, DriveState, FriStatus, Id, Presence, Refusal, Reply, RobotIdentity, RunEnd,
        RunEvent, RunLabel, Status,
    },
    robot_program::{Instruction, RunId, StateChange},
    transport::Permit,
};

use crate::drive::{
    checks::CheckJob,
    events::{FriCommand, Observation, UnexpectedSource},
    instruction_queue::InstructionQueue,
    protocol::check_protocol,
    run::Running,
    run_replies::{RunRecord, RunReply},
};

/// An output of the dispatcher.
pub(in crate::drive) enum Output<C> {
    /// A reply to a client.
    Reply(C, String),
    /// A reply to a client that another thread writes, as it may be long.
    RunReply(RunReply<C>),
    /// A request that another thread parses and checks.
    Check(CheckJob<C>),
    /// An instruction to the robot program.
    Instruct(String),
    /// The robot program does not answer: instructions in transit must not arrive later.
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
    /// When its first bytes arrived.
    pub(in crate::drive) began: Instant,
}

/// The client that a reply goes to, and the id of its request.
pub(in crate::drive) struct Requester<C> {
    pub(super) client: C,
    pub(super) id: Option<Id>,
}

/// The dispatcher. `C` identifies clients.
pub(in crate::drive) struct Dispatcher<C> {
    /// The robot that the drive is set up for.
    pub(super) robot: RobotIdentity,
    pub(super) stage: RunStage<C>,
    /// The latest FRI message.
    pub(super) observation: Option<Observation>,
    /// The address that FRI messages come from instead of the controller's.
    pub(super) unexpected: Option<UnexpectedSource>,
    /// The latest state of the robot program, and when it was received.
    pub(super) program: Option<(StateChange, Instant)>,
    /// The silence of the robot program is logged.
    pub(super) program_lost: bool,
    pub(super) first_run: RunId,
    pub(super) next_run: RunId,
    pub(super) instructions: InstructionQueue<Purpose<C>>,
    /// Runs that were withdrawn while they were checked, and why.
    pub(super) withdrawn: Vec<(RunId, Requester<C>, Refusal)>,
    /// When the last stop was received.
    pub(super) stopped: Option<Instant>,
    /// Clients that wait for the arm to come to rest, and since when.
    pub(super) stoppers: Vec<(Requester<C>, Instant)>,
    /// When a run was abandoned that the robot program may have begun.
    pub(super) abandoned: Option<Instant>,
    pub(super) last_run: Option<Arc<RunRecord>>,
    pub(super) outputs: Vec<Output<C>>,
}

pub(super) enum RunStage<C> {
    Idle,
    /// A run is parsed and checked.
    Checking(RunId, Requester<C>),
    Running(Box<Running<Requester<C>>>),
}

/// The purpose of an instruction.
pub(super) enum Purpose<C> {
    /// To query a value for a client.
    Query(Requester<C>, QueryKind),
    /// To plan the motions of a run.
    Plan(RunId),
    /// To begin a run.
    Begin(RunId),
    /// To stop or end a run.
    End,
}

/// The value that an acknowledgement has to contain.
#[derive(Clone, Copy)]
pub(super) enum QueryKind {
    Value,
    Sensors,
    Signals,
}

/// The robot program counts as disconnected after so much silence; it sends its state twice a second.
const PROGRAM_TIMEOUT: Duration = Duration::from_secs(3);

/// FRI counts as silent after so long without a message.
const FRI_TIMEOUT: Duration = Duration::from_millis(500);

impl<C> Dispatcher<C> {
    /// `first_run` has to differ with each start of a drive.
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

    /// Takes the outputs since the last call.
    pub(in crate::drive) fn take_outputs(&mut self) -> Vec<Output<C>> {
        std::mem::take(&mut self.outputs)
    }

    /// The state of this drive, or that of a robot program that still runs without it.
    pub(super) fn drive_state(&self, now: Instant) -> DriveState {
        match &self.stage {
            RunStage::Running(running) => running.kind,
            _ => self.program_at(now).map_or(DriveState::Idle, |program| program.state),
        }
    }

    pub(super) fn status(&self, now: Instant) -> Status {
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
        let mut status = Status::new(state, fri);
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

    /// The latest state of the robot program, unless it is disconnected.
    pub(super) fn program_at(&self, now: Instant) -> Option<&StateChange> {
        let (state, at) = self.program.as_ref()?;
        (now.saturating_duration_since(*at) <= PROGRAM_TIMEOUT).then_some(state)
    }

    /// The address that FRI messages come from while none come from the controller's.
    fn unexpected_source(&self, now: Instant) -> Option<UnexpectedSource> {
        let is_recent = |at: Instant| now.saturating_duration_since(at) <= FRI_TIMEOUT;
        let is_silent = self.observation.is_none_or(|it| !is_recent(it.at));
        self.unexpected.filter(|it| is_silent && is_recent(it.at))
    }

    /// Checks that the robot program speaks this drive's version of the protocol.
    pub(super) fn check_protocol(&self, now: Instant) -> Result<(), Refusal> {
        let hello = self.program_at(now).and_then(|program| program.hello.as_ref());
        hello.map_or(Ok(()), check_protocol)
    }

    /// Checks that the robot at the cabinet is the one that the drive is set up for, if the robot program knows it.
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
                let why = "no FRI messages arrive: the robot's position is unknown";
                let why = format!("{why}{}", source.unwrap_or_default());
                Err(Refusal::robot(why))
            }
        }
    }

    pub(super) fn instruct(&mut self, instruction: Instruction, purpose: Purpose<C>, now: Instant) {
        self.instructions.add(instruction, purpose, now);
        self.send_next(now);
    }

    pub(super) fn send_next(&mut self, now: Instant) {
        if let Some(instruction) = self.instructions.next(now) {
            self.outputs.push(Output::Instruct(instruction));
        }
    }

    pub(super) fn reply(&mut self, requester: Requester<C>, result: Result<Option<Body>, Refusal>) {
        let (error, body) = match result {
            Ok(body) => (None, body),
            Err(error) => (Some(error), None),
        };
        let Requester { client, id } = requester;
        let reply = Reply { id: id.as_ref(), error: error.as_ref(), body: body.as_ref() };
        let text = reply.to_json();
        self.outputs.push(Output::Reply(client, text));
    }

    /// Publishes the beginning of a run, or its end.
    pub(super) fn publish_run(
        &mut self,
        run: RunId,
        kind: DriveState,
        label: &RunLabel,
        end: Option<RunEnd>,
    ) {
        let t_s = self.observation.map_or(0.0, |it| it.t_s);
        let event = RunEvent { t_s, run, kind, label: label.clone(), end };
        self.outputs.push(Output::Publish(Published::Run(Box::new(event))));
    }

    pub(super) fn reply_run(&mut self, requester: Requester<C>, record: Arc<RunRecord>) {
        let Requester { client, id } = requester;
        self.outputs.push(Output::RunReply(RunReply { client, id, record }));
    }
}
