//! A session of KUKA's Fast Robot Interface, both sides in one thread: bytes in, bytes out.
//!
//! With a real controller, the datagrams go through a UDP socket at port 30200, and the client's half
//! stays as it is.

use std::error::Error;
use std::io::{Write, stdout};
use std::time::Duration;

use iiwa::fri::{Client, Controller, ControllerConfig, Reading};

fn main() -> Result<(), Box<dyn Error>> {
    let mut out = stdout();
    let mut controller = Controller::new(ControllerConfig::default());
    let mut client = Client::default();
    let (mut message, mut answer) = (Vec::new(), Vec::new());
    let mut state = None;

    for cycle in 0..200 {
        // The controller speaks first, once a cycle.
        let reading = Reading { time: Duration::from_millis(5 * cycle), ..Reading::default() };
        if controller.tick(&reading, &mut message) {
            client.receive(&message)?;
        }
        // The client answers when an answer is due. In monitoring there is no set-point to send.
        if client.answer(None, &mut answer) {
            controller.receive(&answer)?;
        }
        // The more answers arrive in time, the further the session goes.
        if state != Some(controller.state()) {
            state = Some(controller.state());
            writeln!(out, "cycle {cycle}: {:?}, {:?}", controller.state(), controller.quality())?;
        }
    }
    let counters = client.counters();
    writeln!(out, "{} messages, {} answers", counters.received, counters.answered)?;
    Ok(())
}
