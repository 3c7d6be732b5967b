//! The time of the stream.

use std::time::Instant;

use crate::fri::Monitoring;

/// The stream's time: that of the controller since it was first heard of. It goes on when the controller
/// starts again.
#[derive(Default)]
pub(super) struct Clock {
    /// What the controller's clock says more, in s.
    pub(super) ahead_s: f64,
    /// The time of the last message, in s.
    pub(super) last_s: f64,
    /// When the last message came; none before the first one of a controller.
    heard: Option<Instant>,
    restarted: bool,
}

impl Clock {
    /// The controller has started again, its clock with it.
    pub(super) fn restart(&mut self) {
        self.restarted = true;
    }

    /// The stream's time of a message, in s.
    pub(super) fn stream_s(&mut self, message: &Monitoring) -> f64 {
        let now = Instant::now();
        let silence_s = self.heard.map_or(0.0, |heard| now.duration_since(heard).as_secs_f64());
        let cycle_s = f64::from(message.send_period_ms.max(1)) * 1e-3;
        // Without time stamps, messages come as they were sent: a cycle after the other.
        let controller_s = message.time.map_or_else(
            || self.ahead_s + self.last_s + cycle_s.max(silence_s.floor()),
            |t| t.as_secs_f64(),
        );
        if self.heard.is_none() {
            self.ahead_s = controller_s;
        } else if self.restarted || controller_s <= self.ahead_s + self.last_s {
            self.ahead_s = controller_s - self.last_s - silence_s.max(cycle_s);
        }
        self.restarted = false;
        self.heard = Some(now);
        self.last_s = controller_s - self.ahead_s;
        self.last_s
    }
}
