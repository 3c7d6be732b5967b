//! Protocol with the robot program: version check, and acknowledgement of states.

use bytes::Bytes;
use iiwa_link::{
    message::{Hello, Refusal, from_json, shortened},
    robot_program::{PROTOCOL, RECEIVED, StateChange},
    transport::Frames,
};

/// Checks that the robot program uses this drive's protocol version.
pub(super) fn check_protocol(hello: &Hello) -> Result<(), Refusal> {
    let Hello { protocol, program, .. } = hello;
    if *protocol == PROTOCOL {
        return Ok(());
    }
    let older =
        if *protocol < PROTOCOL { "the robot program on the cabinet" } else { "iiwasim here" };
    Err(Refusal::robot(format!(
        "the robot program ({}) speaks version {protocol} of the protocol, this drive version \
         {PROTOCOL}: replace {older} by the version that belongs to the other one",
        shortened(program)
    )))
}

/// Returns the state in a robot program message, unless malformed, and the acknowledgement.
pub(super) fn acknowledge(mut frames: Frames) -> (Option<StateChange>, Frames) {
    let body = frames.pop().unwrap_or_default();
    frames.push(Bytes::from_static(RECEIVED.as_bytes()));
    // A malformed state is acknowledged as well, otherwise it would be repeated forever.
    (from_json(&body), frames)
}
