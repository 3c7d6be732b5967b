//! Controller time: time stamps of the stream, and the time base of set-points.

use std::time::Instant;

use iiwa_fri::{Monitoring, ahead};

/// The stream time: controller time since the first message. It continues when the controller
/// restarts.
#[derive(Default)]
pub(super) struct Clock {
    /// Lead of the controller clock over the stream time, in s.
    pub(super) ahead_s: f64,
    /// Stream time of the last message, in s.
    pub(super) last_s: f64,
    /// Arrival time of the last message.
    received: Option<Instant>,
    /// Sequence counter and time stamp, in s, of the last message.
    last: Option<(u32, Option<f64>)>,
    restarted: bool,
}

/// The time of a message.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tick {
    /// Stream time, in s.
    pub(super) t_s: f64,
    /// Time since the previous message, in s, by which set-points may advance.
    pub(super) elapsed_s: f64,
}

impl Clock {
    /// Records a restart of the controller, and thus of its clock.
    pub(super) fn restart(&mut self) {
        self.restarted = true;
    }

    /// Returns the time of a message that arrives at `now`.
    pub(super) fn tick(&mut self, message: &Monitoring, now: Instant) -> Tick {
        let silence_s =
            self.received.map_or(0.0, |instant| now.duration_since(instant).as_secs_f64());
        let cycle_s = f64::from(message.send_period_ms.max(1)) * 1e-3;
        let stamp_s = message.time.map(|time| time.as_secs_f64());
        let elapsed_s = self.elapsed_s(message, stamp_s);
        // Without time stamps, messages are assumed to be one cycle apart.
        let controller_s =
            // Silence counts from one second on: shorter delays are jitter.
            stamp_s.unwrap_or_else(|| self.ahead_s + self.last_s + cycle_s.max(silence_s.floor()));
        if self.received.is_none() {
            self.ahead_s = controller_s;
        } else if self.restarted || controller_s <= self.ahead_s + self.last_s {
            // The stream time continues: its stamps increase even if the clock was set back.
            self.ahead_s = controller_s - self.last_s - silence_s.max(cycle_s);
        }
        self.restarted = false;
        self.received = Some(now);
        self.last = Some((message.sequence, stamp_s));
        self.last_s = controller_s - self.ahead_s;
        Tick { t_s: self.last_s, elapsed_s }
    }

    /// Returns the time since the previous message. Set-points advance by neither the time stamps
    /// nor the counter alone, because clocks may be set meanwhile and a period may be wrong. The
    /// time stamps are used if they agree with the counter within half a cycle, otherwise the
    /// smaller difference.
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
