//! The controller's time: as it is published, and as set-points follow it.

use std::time::Instant;

use iiwa_fri::{Monitoring, ahead};

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
    /// The counter of the last message, and its time stamp in s.
    last: Option<(u32, Option<f64>)>,
    restarted: bool,
}

/// The time of a message.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tick {
    /// The stream's time, in s.
    pub(super) t_s: f64,
    /// Time since the message before, in s, as far as set-points may go on with it.
    pub(super) elapsed_s: f64,
}

impl Clock {
    /// The controller has started again, its clock with it.
    pub(super) fn restart(&mut self) {
        self.restarted = true;
    }

    /// The time of a message that comes at `now`.
    pub(super) fn tick(&mut self, message: &Monitoring, now: Instant) -> Tick {
        let silence_s = self.heard.map_or(0.0, |heard| now.duration_since(heard).as_secs_f64());
        let cycle_s = f64::from(message.send_period_ms.max(1)) * 1e-3;
        let stamp_s = message.time.map(|time| time.as_secs_f64());
        let elapsed_s = self.elapsed_s(message, stamp_s);
        // Without time stamps, messages come as they were sent: a cycle after the other.
        let controller_s =
            stamp_s.unwrap_or_else(|| self.ahead_s + self.last_s + cycle_s.max(silence_s.floor()));
        if self.heard.is_none() {
            self.ahead_s = controller_s;
        } else if self.restarted || controller_s <= self.ahead_s + self.last_s {
            self.ahead_s = controller_s - self.last_s - silence_s.max(cycle_s);
        }
        self.restarted = false;
        self.heard = Some(now);
        self.last = Some((message.sequence, stamp_s));
        self.last_s = controller_s - self.ahead_s;
        Tick { t_s: self.last_s, elapsed_s }
    }

    /// Time stamps may be set meanwhile, and a period may be wrong: what goes on by neither of them is not
    /// commanded. The stamps count, as long as the counter explains them to half a cycle; else the smaller
    /// one does.
    fn elapsed_s(&self, message: &Monitoring, stamp_s: Option<f64>) -> f64 {
        let cycle_s = f64::from(message.send_period_ms.max(1)) * 1e-3;
        let (sequence, before_s) = match self.last {
            Some(last) if !self.restarted => last,
            _ => return cycle_s,
        };
        let counted_s = f64::from(ahead(message.sequence, sequence).max(0)) * cycle_s;
        match stamp_s.zip(before_s).map(|(stamp_s, before_s)| stamp_s - before_s) {
            Some(stamped_s) if (stamped_s - counted_s).abs() <= 0.5 * cycle_s => stamped_s,
            Some(stamped_s) if stamped_s > 0.0 => stamped_s.min(counted_s),
            _ => counted_s,
        }
    }
}
