//! The threads of the robot program.

use std::time::{Duration, Instant};

use iiwa_kin::Robot;

use super::{AWAKE_MS, Shared, lock, simulation::plan};
use crate::{
    message::{Refusal, to_json},
    robot_program::{Acknowledgement, Instruction, STATE_EVERY_MS, StateChange},
};

/// Carries out iiwaDrive's instructions, and acknowledges them.
pub(super) fn take_instructions(shared: &Shared, socket: &zmq::Socket, robot: &Robot) {
    while !shared.is_over() {
        match socket.poll(zmq::POLLIN, AWAKE_MS) {
            Ok(0) | Err(zmq::Error::EINTR) => continue,
            Ok(_) => {}
            Err(_) => return,
        }
        let Ok(frames) = socket.recv_multipart(0) else { continue };
        let (seq, instruction) = match frames.as_slice() {
            [body] => Instruction::from_json(body),
            _ => (None, Err(Refusal::bad("an instruction is one frame"))),
        };
        let answer = instruction.and_then(|instruction| {
            let planned = match &instruction {
                Instruction::RunMotions { motions, .. } => {
                    let start_rad = {
                        let simulation = lock(&shared.simulation);
                        simulation.check_ready()?;
                        *simulation.position()
                    };
                    Some(plan(robot, start_rad, motions.clone())?)
                }
                _ => None,
            };
            lock(&shared.simulation).carry_out(instruction, planned)
        });
        let answer = answer
            .unwrap_or_else(|error| Acknowledgement { error: Some(error), ..Default::default() });
        let answer = to_json(&Acknowledgement { seq, ..answer });
        if let Err(error) = socket.send(&answer, 0) {
            tracing::warn!("cannot answer an instruction: {error}");
        }
    }
}

/// Tells the state when it changes, again until that is acknowledged, and now and then in any case. The
/// socket speaks as REQ does, but does not get stuck when the other side goes away.
pub(super) fn tell_state(shared: &Shared, socket: &zmq::Socket) {
    const LOOK_MS: i64 = 2;
    let every = Duration::from_millis(STATE_EVERY_MS);
    let again = Duration::from_millis(100);
    let mut told: Option<(StateChange, Instant)> = None;
    let mut acknowledged = false;
    while !shared.is_over() {
        let change = {
            let mut simulation = lock(&shared.simulation);
            let wait = if acknowledged { every } else { again };
            let due = told.as_ref().is_none_or(|(_, at)| at.elapsed() >= wait);
            simulation.take_change().or_else(|| due.then(|| simulation.state()))
        };
        if let Some(change) = change {
            let text = to_json(&change);
            // Without a peer it is not sent.
            let _ = socket.send_multipart([b"".as_slice(), text.as_bytes()], zmq::DONTWAIT);
            acknowledged = false;
            told = Some((change, Instant::now()));
        }
        if let Ok(1..) = socket.poll(zmq::POLLIN, LOOK_MS) {
            acknowledged |= socket.recv_multipart(zmq::DONTWAIT).is_ok();
        }
    }
}
