//! Session of KUKA's Fast Robot Interface, both sides in one thread, exchanging bytes.
//!
//! With a real controller, the datagrams go through a UDP socket at port 30200; the client code is
//! the same.

use std::error::Error;
use std::io::{Write, stdout};
use std::time::Duration;

use iiwa::fri::{Controller, ControllerConfig, FriClient, Reading};

fn main() -> Result<(), Box<dyn Error>> {
    let mut out = stdout();
    let mut controller = Controller::new(ControllerConfig::default());
    let mut client = FriClient::default();
    let (mut message, mut answer) = (Vec::new(), Vec::new());
    let mut state = None;

    for cycle in 0..200 {
        // The controller sends first, once per cycle.
        let reading = Reading { time: Duration::from_millis(5 * cycle), ..Reading::default() };
        if controller.tick(&reading, &mut message) {
            client.receive(&message)?;
        }
        // The client answers when an answer is due. In monitoring mode there are no set-points to
        // send.
        if client.answer(None, &mut answer) {
            controller.receive(&answer)?;
        }
        // The session advances through its states as answers arrive in time.
        if state != Some(controller.state()) {
            state = Some(controller.state());
            writeln!(out, "cycle {cycle}: {:?}, {:?}", controller.state(), controller.quality())?;
        }
    }
    let counters = client.counters();
    writeln!(out, "{} messages, {} answers", counters.received, counters.answered)?;
    Ok(())
}
