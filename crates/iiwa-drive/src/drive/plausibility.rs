//! Whether a message can be the controller's.
//!
//! FRI has no keys: nothing in a message shows who sent it. What can be checked is whether it goes on with
//! what was heard before:
//!
//! | of a message | is to be |
//! |---|---|
//! | its source | the cabinet's address, and the port of the messages before |
//! | its counter | ahead of the one before by no more than 1000 messages and what the time passed explains; or behind as messages are that were overtaken |
//! | its time stamp | ahead as its counter is, to half of that and 0.1 s |
//! | send period and receive multiplier | as before |
//! | measured and commanded positions | no further away than a joint at 1.5 of its speed limit gets meanwhile, and 0.05 rad; within the range and 0.1 rad, if they were before |
//!
//! What is not is ignored, and counted. If [`ROW`] messages in a row are ignored that go on with each other,
//! and for three periods none comes that goes on with those before, it was the controller after all, which
//! has started again, or was opened anew: from then on it counts. After five periods of silence, at least
//! 0.1 s, and in an idle session, whatever comes from the cabinet's address counts.
//!
//! So one datagram, or some that do not know the counters, do not end a run. One that is sent from the
//! cabinet's address and port, and goes on with the controller's messages, cannot be told from them.

use std::{
    net::{IpAddr, SocketAddr},
    time::{Duration, Instant},
};

use iiwa_fri::{Client, Monitoring, Received, SessionState, ahead};
use iiwa_kin::{Joints, Limits};

/// So many messages in a row that go on with each other are the controller's.
const ROW: u32 = 4;

/// After so much silence, everything counts: so many periods, and at least so long.
const SILENT_PERIODS: u32 = 5;
const SILENCE: Duration = Duration::from_millis(100);

/// A row counts after so many periods without a message that goes on with those before.
const ROW_PERIODS: u32 = 3;

/// How far ahead a counter may be, in messages, whatever the time.
const AHEAD: f64 = 1000.0;

/// How far a time stamp may be off, in s, whatever the counter.
const STAMP_S: f64 = 0.1;

/// How much faster than its limit a joint may seem, and how far off its position, in rad: positions are
/// measured.
const VELOCITY: f64 = 1.5;
const LEAP_RAD: f64 = 0.05;
const RANGE_RAD: f64 = 0.1;

/// What to do with a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Nothing.
    Ignore,
    /// It goes on with the ones before.
    Take,
    /// It is of a controller that has started again.
    Restart,
}

/// What was heard, and what was ignored.
pub(super) struct Plausibility {
    cabinet: IpAddr,
    limits: Limits,
    /// Where the session's messages come from, and when the last one came.
    heard: Option<(SocketAddr, Instant)>,
    /// The last message that was ignored, when it came, and how many go on with each other up to there.
    suspect: Option<(Monitoring, Instant, u32)>,
    ignored: u64,
}

impl Plausibility {
    pub(super) fn new(cabinet: IpAddr, limits: &Limits) -> Self {
        Self { cabinet, limits: *limits, heard: None, suspect: None, ignored: 0 }
    }

    /// How many messages were ignored.
    pub(super) fn ignored(&self) -> u64 {
        self.ignored
    }

    /// What to do with a message that has come from `from` at `now`, after those that `client` has taken.
    pub(super) fn judge(
        &mut self,
        message: &Monitoring,
        from: SocketAddr,
        now: Instant,
        client: &Client,
    ) -> Verdict {
        if from.ip() != self.cabinet {
            return self.ignore("it comes from another address");
        }
        let latest = client.latest().zip(self.heard).filter(|(latest, (_, heard))| {
            let silence = SILENCE.max(period(latest) * SILENT_PERIODS);
            latest.session != SessionState::Idle && now.duration_since(*heard) < silence
        });
        let Some((latest, (port, heard))) = latest else {
            return self.take(message, from, now, client);
        };
        if from != port {
            return self.ignore("it comes from another port");
        }
        let Err(why) = self.goes_on(message, latest, now.duration_since(heard), client) else {
            return self.take(message, from, now, client);
        };
        let row = match self.suspect.take() {
            Some((before, at, row))
                if ahead(message.sequence, before.sequence) > 0
                    && self.follows(message, &before, now.duration_since(at)).is_ok() =>
            {
                row + 1
            }
            _ => 1,
        };
        if row >= ROW && now.duration_since(heard) >= period(latest) * ROW_PERIODS {
            let is_ahead = ahead(message.sequence, latest.sequence) > 0;
            let follows = is_ahead && counter(message, latest, now.duration_since(heard)).is_ok();
            self.heard = Some((from, now));
            return if follows { Verdict::Take } else { Verdict::Restart };
        }
        self.suspect = Some((message.clone(), now, row));
        self.ignore(why)
    }

    fn take(
        &mut self,
        message: &Monitoring,
        from: SocketAddr,
        now: Instant,
        client: &Client,
    ) -> Verdict {
        let received = client.judge(message);
        if received.is_fresh() {
            self.suspect = None;
            self.heard = Some((from, now));
        }
        if received == Received::Restarted { Verdict::Restart } else { Verdict::Take }
    }

    fn ignore(&mut self, why: &str) -> Verdict {
        self.ignored += 1;
        // Not each of them: whoever sends them would fill the log.
        if self.ignored.is_power_of_two() {
            tracing::warn!(
                "FRI: {} messages were ignored, the last one because {why}",
                self.ignored
            );
        }
        Verdict::Ignore
    }

    fn goes_on(
        &self,
        message: &Monitoring,
        latest: &Monitoring,
        elapsed: Duration,
        client: &Client,
    ) -> Result<(), &'static str> {
        match client.judge(message) {
            Received::New => self.follows(message, latest, elapsed),
            Received::Late | Received::Repeated => Ok(()),
            Received::Restarted => Err("its counter goes back"),
        }
    }

    /// Whether `message` can come `elapsed` after `before`, whose counter it is ahead of.
    fn follows(
        &self,
        message: &Monitoring,
        before: &Monitoring,
        elapsed: Duration,
    ) -> Result<(), &'static str> {
        let counted_s = counter(message, before, elapsed)?;
        if (message.send_period_ms, message.receive_multiplier)
            != (before.send_period_ms, before.receive_multiplier)
        {
            return Err("its send period or receive multiplier is another one");
        }
        if let Some((stamp, before)) = message.time.zip(before.time) {
            let stamped_s = stamp.as_secs_f64() - before.as_secs_f64();
            if stamped_s <= 0.0 || (stamped_s - counted_s).abs() > 0.5 * counted_s + STAMP_S {
                return Err("its time stamp does not go with its counter");
            }
        }
        for (joints_rad, before) in [
            (&message.measured_rad, &before.measured_rad),
            (&message.commanded_rad, &before.commanded_rad),
        ] {
            if let (Some(joints_rad), Some(before)) = (joints_rad, before) {
                self.moves(joints_rad, before, counted_s)?;
            }
        }
        Ok(())
    }

    /// Whether the arm can get from `before` to `joints_rad` in so long.
    fn moves(&self, joints_rad: &Joints, before: &Joints, by_s: f64) -> Result<(), &'static str> {
        let Limits { velocity_rad_s, position_rad, .. } = &self.limits;
        for j in 0..7 {
            let range = position_rad[j] + RANGE_RAD;
            if joints_rad[j].abs() > range && before[j].abs() <= range {
                return Err("a joint is outside its range");
            }
            let most = VELOCITY * velocity_rad_s[j] * by_s + LEAP_RAD;
            if (joints_rad[j] - before[j]).abs() > most {
                return Err("a joint moved faster than it can");
            }
        }
        Ok(())
    }
}

/// Time from one message to the next, as they say.
fn period(message: &Monitoring) -> Duration {
    Duration::from_millis(u64::from(message.send_period_ms.clamp(1, 1000)))
}

/// By how much `message` is later than `before` by its counter, in s, if that can be.
fn counter(
    message: &Monitoring,
    before: &Monitoring,
    elapsed: Duration,
) -> Result<f64, &'static str> {
    let by = f64::from(ahead(message.sequence, before.sequence));
    let period_s = f64::from(before.send_period_ms.max(1)) * 1e-3;
    if by > AHEAD + 2.0 * elapsed.as_secs_f64() / period_s {
        return Err("its counter leaps ahead");
    }
    Ok(by * period_s)
}
