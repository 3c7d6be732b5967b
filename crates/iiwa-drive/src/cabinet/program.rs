//! The threads of the robot program.

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
    transport::{Event, Frames, Listener, PeerId},
};
use iiwa_path::Motion;
use iiwa_traj::Trajectory;

use super::{AWAKE, Shared, lock, simulation::plan};
use crate::robot_program::{
    Acknowledgement, BEGIN_WITHIN, Instruction, RunId, STATE_EVERY_MS, StateChange,
};

/// What the robot program hears of.
pub(super) enum Input {
    Socket(Event),
    Planned(Planned),
}

/// Motions that are to be planned.
pub(super) struct ToPlan {
    run: RunId,
    start_rad: Joints,
    motions: Vec<Motion>,
}

/// What came of them.
pub(super) struct Planned {
    run: RunId,
    result: Result<Trajectory, Refusal>,
}

/// Plans until nobody asks any more.
pub(super) fn plan_motions(robot: &Robot, jobs: &Receiver<ToPlan>, done: impl Fn(Planned)) {
    for ToPlan { run, start_rad, motions } in jobs {
        done(Planned { run, result: plan(robot, start_rad, motions) });
    }
}

/// Carries out iiwaDrive's instructions, and acknowledges them. Motions are planned first, and begin when
/// the drive says so: what nobody wants any more by then does not begin.
pub(super) struct Program<'a> {
    shared: &'a Shared,
    socket: Listener,
    planner: Sender<ToPlan>,
    /// Who is to hear that motions are planned.
    planning: Option<Planning>,
    /// Motions that wait to be begun.
    planned: Option<Waiting>,
}

struct Planning {
    run: RunId,
    asked: Asked,
    is_withdrawn: bool,
}

struct Waiting {
    run: RunId,
    trajectory: Trajectory,
    since: Instant,
}

/// Where an instruction came from.
struct Asked {
    peer: PeerId,
    /// The frames before the instruction.
    envelope: Frames,
    seq: Option<u64>,
}

impl<'a> Program<'a> {
    pub(super) fn new(shared: &'a Shared, socket: Listener, planner: Sender<ToPlan>) -> Self {
        Self { shared, socket, planner, planning: None, planned: None }
    }

    pub(super) fn run(mut self, inputs: &Receiver<Input>) {
        while !self.shared.is_over() {
            match inputs.recv_timeout(AWAKE) {
                Ok(Input::Socket(Event::Message(peer, received))) => {
                    self.take(peer, received.frames);
                }
                // What was planned for a drive that has gone is not begun by another one.
                Ok(Input::Socket(Event::Gone(_))) | Err(RecvTimeoutError::Timeout) => {}
                Ok(Input::Planned(planned)) => self.keep(planned),
                Err(RecvTimeoutError::Disconnected) => return,
            }
            self.planned.take_if(|waiting| waiting.since.elapsed() > BEGIN_WITHIN);
        }
    }

    fn take(&mut self, peer: PeerId, mut envelope: Frames) {
        // As REQ sends it: an empty frame and the instruction.
        let body = envelope.pop().unwrap_or_default();
        let (seq, instruction) = if envelope.len() <= 1 && envelope.iter().all(Bytes::is_empty) {
            Instruction::from_json(&body)
        } else {
            envelope.truncate(1);
            (None, Err(Refusal::bad("an instruction is one frame")))
        };
        let asked = Asked { peer, envelope, seq };
        match instruction.and_then(|instruction| self.carry_out(instruction)) {
            Ok(Done::Now(answer)) => self.acknowledge(asked, answer),
            Ok(Done::WhenPlanned(run)) => {
                self.planning = Some(Planning { run, asked, is_withdrawn: false });
            }
            Err(refusal) => self.refuse(asked, refusal),
        }
    }

    fn carry_out(&mut self, instruction: Instruction) -> Result<Done, Refusal> {
        let mut simulation = lock(&self.shared.simulation);
        match instruction {
            Instruction::RunMotions { run, motions } => {
                simulation.check_ready()?;
                if self.planning.is_some() {
                    return Err(Refusal::new(Code::NotIdle, "other motions are being planned"));
                }
                self.planned = None;
                let start_rad = *simulation.position();
                // Its thread ends later.
                let _ = self.planner.send(ToPlan { run, start_rad, motions });
                Ok(Done::WhenPlanned(run))
            }
            Instruction::Begin { run } => {
                let waiting = self.planned.take_if(|waiting| waiting.run == run);
                let Some(Waiting { trajectory, .. }) = waiting else {
                    return Err(Refusal::robot("these motions are not planned, or not any more"));
                };
                simulation.begin(run, trajectory).map(|()| Done::Now(Acknowledgement::default()))
            }
            Instruction::Stop => {
                self.planned = None;
                if let Some(planning) = &mut self.planning {
                    planning.is_withdrawn = true;
                }
                simulation.carry_out(Instruction::Stop).map(Done::Now)
            }
            instruction => simulation.carry_out(instruction).map(Done::Now),
        }
    }

    /// Motions are planned.
    fn keep(&mut self, Planned { run, result }: Planned) {
        let Some(Planning { asked, is_withdrawn, .. }) =
            self.planning.take_if(|planning| planning.run == run)
        else {
            return;
        };
        match result {
            Ok(_) if is_withdrawn => {
                self.refuse(asked, Refusal::robot("stopped on request, before it was planned"));
            }
            Ok(trajectory) => {
                self.planned = Some(Waiting { run, trajectory, since: Instant::now() });
                self.acknowledge(asked, Acknowledgement::default());
            }
            Err(refusal) => self.refuse(asked, refusal),
        }
    }

    fn refuse(&self, asked: Asked, refusal: Refusal) {
        let error = Some(refusal);
        self.acknowledge(asked, Acknowledgement { error, ..Acknowledgement::default() });
    }

    fn acknowledge(&self, asked: Asked, answer: Acknowledgement) {
        let Asked { peer, envelope: mut frames, seq } = asked;
        frames.push(to_json(&Acknowledgement { seq, ..answer }).into());
        self.socket.send(peer, frames, None);
    }
}

/// When an instruction is acknowledged.
enum Done {
    Now(Acknowledgement),
    WhenPlanned(RunId),
}

/// Tells the state when it changes, again until that is acknowledged, and now and then in any case.
pub(super) fn tell_state(shared: &Shared, socket: &Listener, acknowledged: &AtomicBool) {
    const LOOK: Duration = Duration::from_millis(2);
    let every = Duration::from_millis(STATE_EVERY_MS);
    let again = Duration::from_millis(100);
    let mut told: Option<(StateChange, Instant)> = None;
    while !shared.is_over() {
        let change = {
            let mut simulation = lock(&shared.simulation);
            let wait = if acknowledged.load(Ordering::Relaxed) { every } else { again };
            let due = told.as_ref().is_none_or(|(_, at)| at.elapsed() >= wait);
            simulation.take_change().or_else(|| due.then(|| simulation.state()))
        };
        if let Some(change) = change {
            acknowledged.store(false, Ordering::Relaxed);
            socket.publish(&vec![Bytes::new(), to_json(&change).into()]);
            told = Some((change, Instant::now()));
        }
        thread::sleep(LOOK);
    }
}
