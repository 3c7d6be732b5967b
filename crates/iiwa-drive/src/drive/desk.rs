//! The instruction handler, without sockets: requests, acknowledgements, state changes and messages of
//! FRI go in; replies, instructions and orders come out.
//!
//! Nothing here takes long, so that a stop is served at once: what is long to read or to check goes to
//! another thread and comes back ([`checks`](super::checks)), and so do long replies
//! ([`answers`](super::answers)).
//!
//! A run goes through these stages. A stop, or a client that goes away, withdraws it before the last one,
//! and stops it from there on:
//!
//! | stage | what is waited for |
//! |---|---|
//! | checking | it is read, and held against the robot |
//! | planning | the robot program has planned its motions |
//! | beginning | the robot program has acknowledged that it begins |
//! | begun | the robot program says that it has ended |

mod progress;
mod stop;

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use bytes::Bytes;
use iiwa_fri::{Quality, Safety, SessionState};
use iiwa_link::{
    message::{
        Body, Code, DriveState, FriStatus, Id, MAX_SHORT_REQUEST_BYTES, Presence, Refusal, Reply,
        Request, Status,
    },
    transport::Permit,
};

use super::{
    answers::{Answer, Measured},
    checks::{Check, Checked, Job, Task},
    fri::{Event, Heard, Order},
    instructions::Instructions,
    run::{Left, Phase, Running},
    setpoints::Over,
};
use crate::robot_program::{Instruction, RunId, StateChange};

/// What comes out.
pub(super) enum Output<C> {
    /// To a client.
    Reply(C, String),
    /// To a client, by another thread: it may be long.
    Answer(Answer<C>),
    /// To be read and checked by another thread.
    Check(Job<C>),
    /// To the robot program.
    Instruct(String),
    /// The robot program does not answer: what is on its way to it is not to arrive later.
    Reconnect,
    /// To the FRI thread.
    Order(Order),
}

/// A request as it came in.
pub(super) struct Asking {
    pub(super) body: Bytes,
    /// Of a long one.
    pub(super) permit: Option<Permit>,
    /// When its first bytes came.
    pub(super) began: Instant,
}

/// Where a request came from, and its id.
pub(super) struct Asked<C> {
    client: C,
    id: Option<Id>,
}

/// The instruction handler. `C` tells clients apart.
pub(super) struct Desk<C> {
    state: State<C>,
    heard: Option<Heard>,
    /// The robot program's last word, and when it came.
    program: Option<(StateChange, Instant)>,
    /// Its silence has been told.
    program_lost: bool,
    first_run: RunId,
    next_run: RunId,
    instructions: Instructions<Purpose<C>>,
    /// Runs that were withdrawn while they were checked, and why.
    withdrawn: Vec<(RunId, Asked<C>, Refusal)>,
    /// When the last stop came.
    stopped: Option<Instant>,
    /// Who waits for the arm to stand, and since when.
    stoppers: Vec<(Asked<C>, Instant)>,
    /// When a run was given up that the robot program may have begun.
    given_up: Option<Instant>,
    last_run: Option<Arc<Measured>>,
    outputs: Vec<Output<C>>,
}

enum State<C> {
    Idle,
    /// A run is read and checked.
    Checking(RunId, Asked<C>),
    Running(Box<Running<Asked<C>>>),
}

/// What an instruction is for.
enum Purpose<C> {
    /// A client waits for what it brings.
    Ask(Asked<C>, Wanted),
    /// It has the motions of a run planned.
    Plan(RunId),
    /// It begins the run.
    Begin(RunId),
    /// It stops or ends a run.
    End,
}

/// What an acknowledgement is to bring.
#[derive(Clone, Copy)]
enum Wanted {
    Value,
    Sensors,
}

/// How long the robot program may keep silent, which says its state twice a second.
const PROGRAM_SILENT: Duration = Duration::from_secs(3);

/// How long FRI may keep silent before it counts as such.
const FRI_SILENT: Duration = Duration::from_millis(500);

impl<C> Desk<C> {
    /// `first_run` is to be another number each time a drive starts.
    pub(super) fn new(first_run: RunId) -> Self {
        Self {
            state: State::Idle,
            heard: None,
            program: None,
            program_lost: false,
            first_run,
            next_run: first_run,
            instructions: Instructions::new(),
            withdrawn: Vec::new(),
            stopped: None,
            stoppers: Vec::new(),
            given_up: None,
            last_run: None,
            outputs: Vec::new(),
        }
    }

    /// What has come out since the last call.
    pub(super) fn take_outputs(&mut self) -> Vec<Output<C>> {
        std::mem::take(&mut self.outputs)
    }

    /// A client's request.
    pub(super) fn request(&mut self, client: C, asking: Asking, now: Instant) {
        if asking.body.len() > MAX_SHORT_REQUEST_BYTES {
            // It can only be a run; its id is not worth the time here.
            return self.check_run(Asked { client, id: None }, asking, now);
        }
        let (id, name) = Request::head(&asking.body);
        if let Some("run_motions" | "run_trajectory") = name.as_deref() {
            return self.check_run(Asked { client, id }, asking, now);
        }
        let (id, request) = Request::from_json(&asking.body);
        let asked = Asked { client, id };
        match request {
            Ok(request) => self.serve(asked, request, now),
            Err(refusal) => self.reply(asked, Err(refusal)),
        }
    }

    fn serve(&mut self, asked: Asked<C>, request: Request, now: Instant) {
        let (instruction, wanted) = match request {
            Request::State => {
                let status = Body::Status(self.status(now));
                return self.reply(asked, Ok(Some(status)));
            }
            Request::LastRun => return self.serve_last_run(asked),
            Request::Stop => return self.serve_stop(asked, now),
            Request::GetIo { name } => (Instruction::GetIo { name }, Wanted::Value),
            Request::SetIo { name, value } => (Instruction::SetIo { name, value }, Wanted::Value),
            _ => (Instruction::ReadSensors, Wanted::Sensors),
        };
        let refusal = match self.check_idle(now) {
            Err(refusal) => refusal,
            Ok(()) if self.instructions.is_full() => {
                Refusal::robot("too many requests wait for the robot program")
            }
            Ok(()) => return self.instruct(instruction, Purpose::Ask(asked, wanted), now),
        };
        self.reply(asked, Err(refusal));
    }

    fn serve_last_run(&mut self, asked: Asked<C>) {
        match self.last_run.clone() {
            None => self.reply(asked, Err(Refusal::bad("there was no run yet"))),
            Some(measured) => self.answer(asked, measured),
        }
    }

    /// What this drive, or a robot program that goes on without it, is doing.
    fn drive_state(&self, now: Instant) -> DriveState {
        match &self.state {
            State::Running(running) => running.kind,
            _ => self.program_at(now).map_or(DriveState::Idle, |said| said.state),
        }
    }

    fn status(&self, now: Instant) -> Status {
        let state = self.drive_state(now);
        let fresh =
            self.heard.filter(|heard| now.saturating_duration_since(heard.at) <= FRI_SILENT);
        let fri = FriStatus {
            session: fresh.map_or(FriStatus::SILENT, |heard| heard.session.name()).to_owned(),
            quality: fresh.map_or(Quality::Poor, |heard| heard.quality).name().to_owned(),
            lost: self.heard.map_or(0, |heard| heard.lost),
            late: self.heard.map_or(0, |heard| heard.late),
        };
        let robot_program = match self.program_at(now) {
            Some(_) => Presence::Connected,
            None => Presence::Silent,
        };
        Status {
            state,
            joints_rad: self.heard.map(|heard| heard.joints_rad),
            t_s: self.heard.map(|heard| heard.t_s),
            fri,
            robot_program,
        }
    }

    /// What the robot program said last, unless it has been silent for too long.
    fn program_at(&self, now: Instant) -> Option<&StateChange> {
        let (said, at) = self.program.as_ref()?;
        (now.saturating_duration_since(*at) <= PROGRAM_SILENT).then_some(said)
    }

    fn check_idle(&self, now: Instant) -> Result<(), Refusal> {
        match self.drive_state(now) {
            DriveState::Idle => Ok(()),
            state => Err(Refusal::new(
                Code::NotIdle,
                format!("the robot is busy: {state}; wait for the end, or ask for `stop`"),
            )),
        }
    }

    /// The robot program can be told, and the robot be seen.
    fn check_connected(&self, now: Instant) -> Result<Heard, Refusal> {
        if self.program_at(now).is_none() {
            return Err(Refusal::robot(
                "the robot program does not answer; is the cabinet running?",
            ));
        }
        match self.heard {
            Some(heard) if now.saturating_duration_since(heard.at) <= FRI_SILENT => {
                if heard.safety == Safety::Normal {
                    Ok(heard)
                } else {
                    Err(Refusal::robot("the robot's safety stop is on"))
                }
            }
            _ => Err(Refusal::robot("FRI is silent: the robot cannot be seen")),
        }
    }

    /// Whether a run may begin now; then, where the arm is.
    fn check_free(&self, began: Instant, now: Instant) -> Result<Heard, Refusal> {
        self.check_idle(now)?;
        if matches!(self.state, State::Checking(..)) {
            let busy = "the robot is busy: another run is about to begin";
            return Err(Refusal::new(Code::NotIdle, busy));
        }
        if !self.stoppers.is_empty() || self.stopped.is_some_and(|stopped| began < stopped) {
            return Err(Refusal::robot("stopped on request, before the run was begun"));
        }
        self.check_connected(now)
    }

    /// The first stage of a run. State comes first: what would be refused is not read.
    fn check_run(&mut self, asked: Asked<C>, asking: Asking, now: Instant) {
        let Asking { body, permit, began } = asking;
        let is_short = body.len() <= MAX_SHORT_REQUEST_BYTES;
        match self.check_free(began, now) {
            Ok(heard) => {
                let run = self.next_run;
                self.next_run = self.next_run.wrapping_add(1);
                self.state = State::Checking(run, asked);
                let check = Check { run, body, permit, at_rad: heard.joints_rad };
                self.outputs.push(Output::Check(Job::Check(check)));
            }
            Err(refusal) if is_short => self.reply(asked, Err(refusal)),
            // Its id is to come back.
            Err(refusal) => {
                let Asked { client, .. } = asked;
                self.outputs.push(Output::Check(Job::Refuse { client, body, permit, refusal }));
            }
        }
    }

    /// A run has been checked.
    pub(super) fn checked(&mut self, checked: Checked, now: Instant) {
        let Checked { run, id, task } = checked;
        if let Some(i) = self.withdrawn.iter().position(|(withdrawn, ..)| *withdrawn == run) {
            let (_, asked, refusal) = self.withdrawn.swap_remove(i);
            return self.reply(Asked { id, ..asked }, Err(refusal));
        }
        let asked = match std::mem::replace(&mut self.state, State::Idle) {
            State::Checking(checking, asked) if checking == run => Asked { id, ..asked },
            state => {
                self.state = state;
                return;
            }
        };
        // Meanwhile the robot may have become busy, or lost.
        let ready = task.and_then(|task| {
            self.check_idle(now)?;
            let heard = self.check_connected(now)?;
            if matches!(task, Task::Trajectory(_)) {
                check_session(&heard)?;
            }
            Ok(task)
        });
        match ready {
            Ok(task) => self.begin(run, asked, task, now),
            Err(refusal) => self.reply(asked, Err(refusal)),
        }
    }

    fn begin(&mut self, run: RunId, asked: Asked<C>, task: Task, now: Instant) {
        let (kind, phase) = match task {
            Task::Motions(_) => (DriveState::RunningMotion, Phase::Planning),
            Task::Trajectory(_) => (DriveState::RunningTrajectory, Phase::Beginning),
        };
        let running = Running::new(kind, phase, run, asked, self.heard.as_ref());
        self.state = State::Running(Box::new(running));
        tracing::info!("run {run}: {kind}");
        self.outputs.push(Output::Order(Order::Publish(kind)));
        match task {
            Task::Motions(motions) => {
                self.instruct(Instruction::RunMotions { run, motions }, Purpose::Plan(run), now);
            }
            Task::Trajectory(trajectory) => {
                self.outputs.push(Output::Order(Order::Run(run, trajectory)));
                self.instruct(Instruction::RunTrajectory { run }, Purpose::Begin(run), now);
            }
        }
    }

    fn instruct(&mut self, instruction: Instruction, purpose: Purpose<C>, now: Instant) {
        self.instructions.add(instruction, purpose, now);
        self.send_next(now);
    }

    fn send_next(&mut self, now: Instant) {
        if let Some(instruction) = self.instructions.next(now) {
            self.outputs.push(Output::Instruct(instruction));
        }
    }

    fn reply(&mut self, asked: Asked<C>, result: Result<Option<Body>, Refusal>) {
        let (error, body) = match result {
            Ok(body) => (None, body),
            Err(error) => (Some(error), None),
        };
        let Asked { client, id } = asked;
        let reply = Reply { id: id.as_ref(), error: error.as_ref(), body: body.as_ref() };
        let text = reply.to_json();
        self.outputs.push(Output::Reply(client, text));
    }

    fn answer(&mut self, asked: Asked<C>, measured: Arc<Measured>) {
        let Asked { client, id } = asked;
        self.outputs.push(Output::Answer(Answer { client, id, measured }));
    }
}

/// Whether the session of FRI is good enough to command over it.
fn check_session(heard: &Heard) -> Result<(), Refusal> {
    if heard.session < SessionState::MonitoringReady || heard.quality < Quality::Good {
        return Err(Refusal::robot(format!(
            "FRI is not good enough to command over it: session {}, quality {}",
            heard.session.name(),
            heard.quality.name()
        )));
    }
    Ok(())
}

fn unanswered() -> Refusal {
    Refusal::new(Code::Timeout, "the robot program did not answer in time")
}

#[cfg(test)]
mod tests;
