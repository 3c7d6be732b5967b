//! The instruction handler, without sockets: requests, acknowledgements, state changes and messages of
//! FRI go in; replies, instructions and orders come out.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

use iiwa_kin::Robot;
use iiwa_path::{Motion, Path, Program};

use super::{
    fri::{Event, Heard, Order},
    run::{Left, Running},
    setpoints::Over,
};
use crate::{
    fri::{Quality, Safety, SessionState},
    message::{
        Body, Code, DriveState, FriStatus, Id, Presence, Refusal, Reply, Request, Run, Status,
    },
    robot_program::{Acknowledgement, Instruction, RunId, StateChange},
    timed_joints::TimedJoints,
};

/// What comes out.
pub(super) enum Output<C> {
    /// To a client.
    Reply(C, String),
    /// To the robot program.
    Instruct(String),
    /// The robot program does not answer: what is on its way to it is not to arrive later.
    Reconnect,
    /// To the FRI thread.
    Order(Order),
}

/// Where a request came from, and its id.
struct Asked<C> {
    client: C,
    id: Option<Id>,
}

/// The instruction handler. `C` tells clients apart.
pub(super) struct Desk<C> {
    robot: Robot,
    state: State<C>,
    heard: Option<Heard>,
    /// The robot program's last word, and when it came.
    program: Option<(StateChange, Instant)>,
    /// Its silence has been told.
    program_lost: bool,
    seq: u64,
    first_run: RunId,
    next_run: RunId,
    /// Instructions that are still to be sent, and since when they are.
    waiting: VecDeque<(Instruction, Purpose<C>, Instant)>,
    /// The one that is not acknowledged yet.
    in_flight: Option<(u64, Instant, Purpose<C>)>,
    /// Who waits for the arm to stand.
    stoppers: Vec<Asked<C>>,
    last_run: Option<(Run, Option<Refusal>)>,
    outputs: Vec<Output<C>>,
}

enum State<C> {
    Idle,
    Running(Box<Running<Asked<C>>>),
}

/// What an instruction is for.
enum Purpose<C> {
    /// A client waits for what it brings.
    Ask(Asked<C>, Wanted),
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

/// Most instructions that wait for those before them.
const MOST_WAITING: usize = 100;

/// How long an instruction may take to be acknowledged.
const ACKNOWLEDGED_WITHIN: Duration = Duration::from_secs(2);

/// How long motions may take to be acknowledged: they are planned before.
const PLANNED_WITHIN: Duration = Duration::from_mins(1);

/// How long the robot program may keep silent, which says its state twice a second.
const PROGRAM_SILENT: Duration = Duration::from_secs(3);

/// How long FRI may keep silent before it counts as such.
const FRI_SILENT: Duration = Duration::from_millis(500);

impl<C> Desk<C> {
    /// `first_run` is to be another number each time a drive starts.
    pub(super) fn new(robot: Robot, first_run: RunId) -> Self {
        Self {
            robot,
            state: State::Idle,
            heard: None,
            program: None,
            program_lost: false,
            seq: 0,
            first_run,
            next_run: first_run,
            waiting: VecDeque::new(),
            in_flight: None,
            stoppers: Vec::new(),
            last_run: None,
            outputs: Vec::new(),
        }
    }

    /// What has come out since the last call.
    pub(super) fn take_outputs(&mut self) -> Vec<Output<C>> {
        std::mem::take(&mut self.outputs)
    }

    /// A client's request.
    pub(super) fn request(&mut self, client: C, body: &[u8], now: Instant) {
        let (id, request) = Request::from_json(body);
        let asked = Asked { client, id };
        match request {
            Ok(request) => self.serve(asked, request, now),
            Err(refusal) => self.reply(asked, Err(refusal)),
        }
    }

    fn serve(&mut self, asked: Asked<C>, request: Request, now: Instant) {
        match request {
            Request::State => {
                let status = Body::Status(self.status(now));
                self.reply(asked, Ok(Some(status)));
            }
            Request::LastRun => self.serve_last_run(asked),
            Request::Stop => self.serve_stop(asked, now),
            request => {
                if let Err(refusal) = self.check_idle(now) {
                    return self.reply(asked, Err(refusal));
                }
                match request {
                    Request::RunMotions { motions } => self.begin_motions(asked, motions, now),
                    Request::RunTrajectory { trajectory } => {
                        self.begin_trajectory(asked, trajectory, now);
                    }
                    Request::GetIo { name } => {
                        let purpose = Purpose::Ask(asked, Wanted::Value);
                        self.instruct(Instruction::GetIo { name }, purpose, now);
                    }
                    Request::SetIo { name, value } => {
                        let purpose = Purpose::Ask(asked, Wanted::Value);
                        self.instruct(Instruction::SetIo { name, value }, purpose, now);
                    }
                    _ => {
                        let purpose = Purpose::Ask(asked, Wanted::Sensors);
                        self.instruct(Instruction::ReadSensors, purpose, now);
                    }
                }
            }
        }
    }

    fn serve_last_run(&mut self, asked: Asked<C>) {
        match self.last_run.clone() {
            None => self.reply(asked, Err(Refusal::bad("there was no run yet"))),
            Some((run, error)) => {
                let reply = Reply { id: asked.id, error, body: Some(Body::Run(run)) };
                self.outputs.push(Output::Reply(asked.client, reply.to_json()));
            }
        }
    }

    fn serve_stop(&mut self, asked: Asked<C>, now: Instant) {
        match &self.state {
            State::Running(running) if running.kind == DriveState::RunningTrajectory => {
                // On its path, by set-points: the cabinet does not know the path.
                self.outputs.push(Output::Order(Order::Stop));
            }
            State::Running(_) => self.end_by(Instruction::Stop, now),
            // What was running before this drive was started, or is not known to stand still.
            State::Idle
                if self.program_at(now).is_none_or(|said| said.state != DriveState::Idle) =>
            {
                self.tell_end(Instruction::Stop, now);
            }
            State::Idle => {}
        }
        self.stoppers.push(asked);
        self.answer_stoppers(now);
    }

    /// Answers those who wait for the arm to stand, once that is known.
    fn answer_stoppers(&mut self, now: Instant) {
        if matches!(self.state, State::Running(_)) {
            return;
        }
        let stands = match self.program_at(now) {
            Some(said) if said.state == DriveState::Idle => Ok(None),
            Some(_) => return,
            None => Err(Refusal::robot(
                "the robot program does not answer: whether the robot stands is not known",
            )),
        };
        for asked in std::mem::take(&mut self.stoppers) {
            self.reply(asked, stands.clone());
        }
    }

    /// From now on the robot program is to end the run, unless it is told to already.
    fn end_by(&mut self, instruction: Instruction, now: Instant) {
        if let State::Running(running) = &mut self.state
            && running.ended_by.is_none()
        {
            running.ended_by = Some(instruction.clone());
            self.instruct(instruction, Purpose::End, now);
        }
    }

    /// Tells the robot program to end something, unless it is being told so.
    fn tell_end(&mut self, instruction: Instruction, now: Instant) {
        if !self.is_ending() {
            self.instruct(instruction, Purpose::End, now);
        }
    }

    /// What this drive, or a robot program that goes on without it, is doing.
    fn drive_state(&self, now: Instant) -> DriveState {
        match &self.state {
            State::Running(running) => running.kind,
            State::Idle => self.program_at(now).map_or(DriveState::Idle, |said| said.state),
        }
    }

    fn status(&self, now: Instant) -> Status {
        let fri = match &self.heard {
            None => FriStatus {
                session: FriStatus::SILENT.to_owned(),
                quality: Quality::Poor.name().to_owned(),
                ..FriStatus::default()
            },
            Some(heard) => {
                let silent = now.saturating_duration_since(heard.at) > FRI_SILENT;
                let quality = if silent { Quality::Poor } else { heard.quality };
                FriStatus {
                    session: if silent { FriStatus::SILENT } else { heard.session.name() }
                        .to_owned(),
                    quality: quality.name().to_owned(),
                    lost: heard.lost,
                    late: heard.late,
                }
            }
        };
        Status {
            state: self.drive_state(now),
            joints_rad: self.heard.map(|heard| heard.joints_rad),
            t_s: self.heard.map(|heard| heard.t_s),
            fri,
            robot_program: match self.program_at(now) {
                Some(_) => Presence::Connected,
                None => Presence::Silent,
            },
        }
    }

    /// What the robot program says, unless it has been silent for too long.
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

    fn begin_motions(&mut self, asked: Asked<C>, motions: Vec<Motion>, now: Instant) {
        match self.check_motions(&motions, now) {
            Ok(()) => {
                let run = self.begin(DriveState::RunningMotion, asked);
                self.instruct(Instruction::RunMotions { run, motions }, Purpose::Begin(run), now);
            }
            Err(refusal) => self.reply(asked, Err(refusal)),
        }
    }

    fn check_motions(&self, motions: &[Motion], now: Instant) -> Result<(), Refusal> {
        let heard = self.check_connected(now)?;
        let range = self.robot.limits().position_rad;
        let start_rad = std::array::from_fn(|j| heard.joints_rad[j].clamp(-range[j], range[j]));
        let program = Program { robot: None, start_rad, motions: motions.to_vec() };
        Path::new(&program, &self.robot)
            .map(drop)
            .map_err(|fault| Refusal::new(Code::Limit, fault.to_string()))
    }

    fn begin_trajectory(&mut self, asked: Asked<C>, trajectory: TimedJoints, now: Instant) {
        match self.check_trajectory(&trajectory, now) {
            Ok(()) => {
                let run = self.begin(DriveState::RunningTrajectory, asked);
                self.outputs.push(Output::Order(Order::Run(run, Box::new(trajectory))));
                self.instruct(Instruction::RunTrajectory { run }, Purpose::Begin(run), now);
            }
            Err(refusal) => self.reply(asked, Err(refusal)),
        }
    }

    fn check_trajectory(&self, trajectory: &TimedJoints, now: Instant) -> Result<(), Refusal> {
        let heard = self.check_connected(now)?;
        trajectory.check(self.robot.limits(), &heard.joints_rad)?;
        if heard.session < SessionState::MonitoringReady || heard.quality < Quality::Good {
            return Err(Refusal::robot(format!(
                "FRI is not good enough to command over it: session {}, quality {}",
                heard.session.name(),
                heard.quality.name()
            )));
        }
        Ok(())
    }

    fn begin(&mut self, kind: DriveState, asked: Asked<C>) -> RunId {
        let run = self.next_run;
        self.next_run = self.next_run.wrapping_add(1);
        let running = Running::new(kind, run, asked, self.heard.as_ref());
        self.state = State::Running(Box::new(running));
        tracing::info!("run {run}: {kind}");
        self.outputs.push(Output::Order(Order::Publish(kind)));
        run
    }

    fn instruct(&mut self, instruction: Instruction, purpose: Purpose<C>, now: Instant) {
        match purpose {
            Purpose::Ask(asked, _) if self.waiting.len() >= MOST_WAITING => {
                let error = "too many requests wait for the robot program";
                return self.reply(asked, Err(Refusal::robot(error)));
            }
            purpose => self.waiting.push_back((instruction, purpose, now)),
        }
        self.send_next(now);
    }

    fn send_next(&mut self, now: Instant) {
        if self.in_flight.is_some() {
            return;
        }
        let Some((instruction, purpose, _)) = self.waiting.pop_front() else { return };
        self.seq += 1;
        let within = match instruction {
            Instruction::RunMotions { .. } => PLANNED_WITHIN,
            _ => ACKNOWLEDGED_WITHIN,
        };
        self.outputs.push(Output::Instruct(instruction.to_json(self.seq)));
        self.in_flight = Some((self.seq, now + within, purpose));
    }

    /// The robot program has acknowledged an instruction.
    pub(super) fn acknowledged(&mut self, answer: Acknowledgement, now: Instant) {
        let waited_for = |(seq, ..): &mut (u64, _, _)| answer.seq == Some(*seq);
        let Some((_, _, purpose)) = self.in_flight.take_if(waited_for) else { return };
        match (purpose, answer.error) {
            (Purpose::Ask(asked, _), Some(error)) => self.reply(asked, Err(error)),
            (Purpose::Ask(asked, wanted), None) => {
                let brought = match (wanted, answer.sensors, answer.value) {
                    (Wanted::Sensors, Some(sensors), _) => Ok(Some(Body::Sensors { sensors })),
                    (Wanted::Value, _, Some(value)) => Ok(Some(Body::Value { value })),
                    _ => Err(Refusal::robot("the robot program's answer lacks what was asked for")),
                };
                self.reply(asked, brought);
            }
            (Purpose::Begin(run), Some(error)) => self.fail(run, error, now),
            (Purpose::Begin(run), None) => {
                if let State::Running(running) = &mut self.state
                    && running.run == run
                {
                    running.take(now);
                }
            }
            (Purpose::End, _) => {}
        }
        self.send_next(now);
    }

    /// The robot program has said its state.
    pub(super) fn changed(&mut self, change: StateChange, now: Instant) {
        let restarted = self.program.as_ref().is_some_and(|(before, _)| before.boot != change.boot);
        self.take_for_acknowledged(&change, now);
        if let State::Running(running) = &mut self.state {
            let run = running.run;
            match &change.outcome {
                Some(outcome) if outcome.run == run => {
                    let ahead_s = self.heard.map_or(0.0, |heard| heard.clock_ahead_s);
                    running.end(outcome, ahead_s, now);
                }
                _ if restarted => {
                    let error = "the robot program was started again in the middle of the run";
                    self.fail(run, Refusal::robot(error), now);
                }
                _ if change.run != Some(run) && running.is_forgotten(now) => {
                    let error = "the robot program does not know of the run any more";
                    self.fail(run, Refusal::robot(error), now);
                }
                _ => {}
            }
        }
        // At each word, so that nothing moves on because an instruction got lost.
        if let Some(end) = change.run.and_then(|run| self.end_of(run, change.state)) {
            self.tell_end(end, now);
        }
        if restarted || self.program_at(now).is_none() {
            tracing::info!("the robot program is there");
            self.program_lost = false;
        }
        self.program = Some((change, now));
        self.tick(now);
    }

    /// The robot program speaks of the run: it has the instruction that begins it, even if its
    /// acknowledgement got lost. What waits behind that, as a stop, must not wait any longer.
    fn take_for_acknowledged(&mut self, change: &StateChange, now: Instant) {
        let ended = change.outcome.as_ref().map(|outcome| outcome.run);
        let is_known = |run: &RunId| change.run == Some(*run) || ended == Some(*run);
        let begins = |purpose: &Purpose<C>| matches!(purpose, Purpose::Begin(run) if is_known(run));
        if let Some((_, _, Purpose::Begin(run))) =
            self.in_flight.take_if(|(.., purpose)| begins(purpose))
            && let State::Running(running) = &mut self.state
            && running.run == run
        {
            running.take(now);
        }
    }

    /// How a run that the robot program is busy with is to be ended, if it is.
    fn end_of(&self, run: RunId, state: DriveState) -> Option<Instruction> {
        match &self.state {
            State::Running(running) if running.run == run => running.ended_by.clone(),
            // Nobody feeds it any more.
            _ if state == DriveState::RunningTrajectory => Some(Instruction::EndTrajectory { run }),
            // It was given up, and has begun all the same.
            _ if self.is_own(run) => Some(Instruction::Stop),
            _ => (!self.stoppers.is_empty()).then_some(Instruction::Stop),
        }
    }

    /// Whether this drive has given a run that number.
    fn is_own(&self, run: RunId) -> bool {
        run.wrapping_sub(self.first_run) < self.next_run.wrapping_sub(self.first_run)
    }

    /// Whether the robot program is already being told to end something.
    fn is_ending(&self) -> bool {
        let waiting = self.waiting.iter().map(|(_, purpose, _)| purpose);
        let in_flight = self.in_flight.iter().map(|(.., purpose)| purpose);
        waiting.chain(in_flight).any(|purpose| matches!(purpose, Purpose::End))
    }

    /// The FRI thread has told something.
    pub(super) fn heard(&mut self, event: Event, now: Instant) {
        match event {
            Event::Heard(heard) => {
                let session = (heard.session, heard.quality);
                if self.heard.is_none_or(|before| (before.session, before.quality) != session) {
                    tracing::info!("FRI: {}, quality {}", session.0.name(), session.1.name());
                }
                self.heard = Some(heard);
                if let State::Running(running) = &mut self.state {
                    running.keep(&heard);
                }
            }
            Event::Over(over) => self.commanded(over, now),
            Event::Discarded => {
                // It was to be stopped before it began.
                if !self.stoppers.is_empty() {
                    self.end_by(Instruction::Stop, now);
                }
            }
            Event::Freed(_) => {}
        }
    }

    /// A trajectory is over on this side: the robot program is told, and says idle then.
    fn commanded(&mut self, over: Over, now: Instant) {
        if let State::Running(running) = &mut self.state
            && running.run == over.run
        {
            let run = over.run;
            running.commanded = Some(over);
            self.end_by(Instruction::EndTrajectory { run }, now);
        }
    }

    /// Time passes.
    pub(super) fn tick(&mut self, now: Instant) {
        if let Some((_, _, purpose)) = self.in_flight.take_if(|(_, until, _)| *until <= now) {
            self.outputs.push(Output::Reconnect);
            match purpose {
                Purpose::Ask(asked, _) => self.reply(asked, Err(unanswered())),
                Purpose::Begin(run) => self.fail(run, unanswered(), now),
                Purpose::End => {}
            }
        }
        let lost = self.program_at(now).is_none();
        if lost && self.program.is_some() && !self.program_lost {
            self.program_lost = true;
            tracing::warn!("the robot program is silent");
        }
        if let State::Running(running) = &self.state {
            if running.is_complete(self.heard.as_ref(), now) {
                self.finish();
            } else if lost && !running.has_ended() {
                let run = running.run;
                self.outputs.push(Output::Reconnect);
                if let Some((_, _, Purpose::Ask(asked, _))) = self.in_flight.take() {
                    self.reply(asked, Err(unanswered()));
                }
                let error = Refusal::robot("the robot program does not answer any more");
                self.fail(run, error, now);
            }
        }
        self.answer_stoppers(now);
        self.send_next(now);
        self.refuse_waiting(now);
    }

    /// Refuses what has waited for too long: clients give it up, and it is not to be done behind their
    /// backs.
    fn refuse_waiting(&mut self, now: Instant) {
        for (instruction, purpose, since) in std::mem::take(&mut self.waiting) {
            match purpose {
                Purpose::Ask(asked, _)
                    if now.saturating_duration_since(since) >= ACKNOWLEDGED_WITHIN =>
                {
                    self.reply(asked, Err(unanswered()));
                }
                purpose => self.waiting.push_back((instruction, purpose, since)),
            }
        }
    }

    /// A run has failed, or never begun.
    fn fail(&mut self, run: RunId, error: Refusal, now: Instant) {
        if let State::Running(running) = &mut self.state
            && running.run == run
        {
            running.fail(error, now);
            self.finish();
            // It is not to begin any more; if it does, or has, it is stopped by its number.
            self.waiting.retain(
                |(_, purpose, _)| !matches!(purpose, Purpose::Begin(other) if *other == run),
            );
        }
    }

    /// Replies with what was measured; then the state is idle again.
    fn finish(&mut self) {
        let State::Running(running) = std::mem::replace(&mut self.state, State::Idle) else {
            return;
        };
        if running.kind == DriveState::RunningTrajectory {
            self.outputs.push(Output::Order(Order::Release));
        }
        let number = running.run;
        let Left { run, error, was_taken, asked } = running.leave();
        match &error {
            None => tracing::info!("run {number}: done"),
            Some(error) => tracing::warn!("run {number}: {error}"),
        }
        if was_taken {
            self.last_run = Some((run.clone(), error.clone()));
        }
        let reply = Reply { id: asked.id, error, body: Some(Body::Run(run)) };
        self.outputs.push(Output::Reply(asked.client, reply.to_json()));
        self.outputs.push(Output::Order(Order::Publish(DriveState::Idle)));
    }

    fn reply(&mut self, asked: Asked<C>, result: Result<Option<Body>, Refusal>) {
        let (error, body) = match result {
            Ok(body) => (None, body),
            Err(error) => (Some(error), None),
        };
        let reply = Reply { id: asked.id, error, body };
        self.outputs.push(Output::Reply(asked.client, reply.to_json()));
    }
}

fn unanswered() -> Refusal {
    Refusal::new(Code::Timeout, "the robot program did not answer in time")
}

#[cfg(test)]
mod tests;
