//! Plausibility checks of controller messages.
//!
//! FRI is not authenticated: a message does not prove its sender. The drive can only check
//! consistency with previous messages:
//!
//! | message field | check |
//! |---|---|
//! | source | the cabinet's address, and the port of the previous messages |
//! | sequence counter | ahead by at most 1000 messages and twice the elapsed time; or behind like a reordered message |
//! | time stamp | consistent with the counter, to half of the difference and 0.1 s |
//! | send period and receive multiplier | unchanged |
//! | measured and commanded positions | within the reach of a joint at 1.5 of its velocity limit, plus 0.05 rad; within the joint range plus 0.1 rad, if the previous position was |
//!
//! Other messages are ignored and counted. If [`ROW`] ignored messages in a row are consistent with
//! each other, and no message consistent with the accepted ones has arrived for three periods,
//! these messages are accepted from then on, as those of a restarted controller unless their
//! counter continues plausibly. After five periods of silence, at least 0.1 s, and in an idle
//! session, any message from the cabinet's address is accepted.
//!
//! So stray datagrams do not end a run, nor do datagrams of a sender that does not know the
//! counters. A datagram from the cabinet's address and port that is consistent with the controller
//! messages cannot be distinguished from them.

use std::{
    net::{IpAddr, SocketAddr},
    time::{Duration, Instant},
};

use iiwa_fri::{FriClient, Monitoring, Received, SessionState, ahead};
use iiwa_kin::{Joints, Limits};

use super::events::UnexpectedSource;

/// Number of consecutive consistent messages of a restarted controller.
const ROW: u32 = 4;

/// Silence after which any message is accepted: a number of periods, and at least this time.
const SILENT_PERIODS: u32 = 5;
const SILENCE: Duration = Duration::from_millis(100);

/// Messages from another address are reported after this time without a message from the cabinet,
/// and at this interval.
const UNEXPECTED_AFTER: Duration = Duration::from_millis(500);
const UNEXPECTED_EVERY: Duration = Duration::from_millis(100);

/// Number of periods without a consistent message after which a row is accepted.
const ROW_PERIODS: u32 = 3;

/// Tolerance of counters, in messages.
const MAX_AHEAD: f64 = 1000.0;

/// Tolerance of time stamps, in s.
const STAMP_TOLERANCE_S: f64 = 0.1;

/// Tolerances of measured positions: velocity as a share of the limit, jump and range in rad.
const VELOCITY: f64 = 1.5;
const JUMP_RAD: f64 = 0.05;
const RANGE_RAD: f64 = 0.1;

/// Verdict on a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MessageVerdict {
    /// The message is implausible.
    Ignore,
    /// The message is consistent with the previous ones.
    Accept,
    /// The message comes from a restarted controller.
    Restart,
}

/// The record of accepted and ignored messages.
pub(super) struct Plausibility {
    cabinet: IpAddr,
    limits: Limits,
    /// Source of the accepted messages, and arrival time of the last one.
    accepted: Option<(SocketAddr, Instant)>,
    /// The last ignored message, its arrival time, and the length of the row of consistent
    /// messages.
    suspect: Option<(Monitoring, Instant, u32)>,
    ignored: u64,
    /// Time of the last report of a message from another address.
    unexpected: Option<Instant>,
}

impl Plausibility {
    pub(super) fn new(cabinet: IpAddr, limits: &Limits) -> Self {
        Self {
            cabinet,
            limits: *limits,
            accepted: None,
            suspect: None,
            ignored: 0,
            unexpected: None,
        }
    }

    /// Number of ignored messages.
    pub(super) fn ignored(&self) -> u64 {
        self.ignored
    }

    /// Returns the source of an ignored message that has arrived from `from` at `now`, if its
    /// address is not the cabinet's, no message arrives from the cabinet, and a report is due.
    pub(super) fn unexpected(
        &mut self,
        from: SocketAddr,
        now: Instant,
    ) -> Option<UnexpectedSource> {
        let is_past = |instant: Option<Instant>, after| {
            instant.is_none_or(|instant| now.duration_since(instant) >= after)
        };
        let is_due = from.ip() != self.cabinet
            && is_past(self.accepted.map(|(_, instant)| instant), UNEXPECTED_AFTER)
            && is_past(self.unexpected, UNEXPECTED_EVERY);
        is_due.then(|| {
            self.unexpected = Some(now);
            UnexpectedSource { from: from.ip(), expected: self.cabinet, at: now }
        })
    }

    /// Judges a message that has arrived from `from` at `now`, given the messages that `client` has
    /// accepted.
    pub(super) fn judge(
        &mut self,
        message: &Monitoring,
        from: SocketAddr,
        now: Instant,
        client: &FriClient,
    ) -> MessageVerdict {
        if from.ip() != self.cabinet {
            return self.ignore("its source address differs");
        }
        let latest = client.latest().zip(self.accepted).filter(|(latest, (_, received))| {
            let silence = SILENCE.max(period(latest) * SILENT_PERIODS);
            latest.session != SessionState::Idle && now.duration_since(*received) < silence
        });
        let Some((latest, (port, received))) = latest else {
            return self.accept(message, from, now, client);
        };
        if from != port {
            return self.ignore("its source port differs");
        }
        let Err(reason) =
            self.check_consistency(message, latest, now.duration_since(received), client)
        else {
            return self.accept(message, from, now, client);
        };
        let row = match self.suspect.take() {
            Some((before, instant, row))
                if ahead(message.sequence, before.sequence) > 0
                    && self
                        .check_successor(message, &before, now.duration_since(instant))
                        .is_ok() =>
            {
                row + 1
            }
            _ => 1,
        };
        // Not while consistent messages arrive: the row would be from another sender.
        if row >= ROW && now.duration_since(received) >= period(latest) * ROW_PERIODS {
            let is_ahead = ahead(message.sequence, latest.sequence) > 0;
            let is_successor =
                is_ahead && counted_time_s(message, latest, now.duration_since(received)).is_ok();
            self.accepted = Some((from, now));
            return if is_successor { MessageVerdict::Accept } else { MessageVerdict::Restart };
        }
        self.suspect = Some((message.clone(), now, row));
        self.ignore(reason)
    }

    fn accept(
        &mut self,
        message: &Monitoring,
        from: SocketAddr,
        now: Instant,
        client: &FriClient,
    ) -> MessageVerdict {
        let received = client.classify(message);
        // A repeated message does not show that the controller is still sending.
        if received.is_fresh() {
            self.suspect = None;
            self.accepted = Some((from, now));
        }
        if received == Received::Restarted {
            MessageVerdict::Restart
        } else {
            MessageVerdict::Accept
        }
    }

    fn ignore(&mut self, reason: &str) -> MessageVerdict {
        self.ignored += 1;
        // Not every message is logged, which would flood the log.
        if self.ignored.is_power_of_two() {
            tracing::warn!(
                "FRI: {} messages were ignored, the last one because {reason}",
                self.ignored
            );
        }
        MessageVerdict::Ignore
    }

    fn check_consistency(
        &self,
        message: &Monitoring,
        latest: &Monitoring,
        elapsed: Duration,
        client: &FriClient,
    ) -> Result<(), &'static str> {
        match client.classify(message) {
            Received::New => self.check_successor(message, latest, elapsed),
            Received::Late | Received::Repeated => Ok(()),
            Received::Restarted => Err("its counter decreases"),
        }
    }

    /// Checks that `message` can follow `before`, whose counter it exceeds, after the time
    /// `elapsed`.
    fn check_successor(
        &self,
        message: &Monitoring,
        before: &Monitoring,
        elapsed: Duration,
    ) -> Result<(), &'static str> {
        let counted_s = counted_time_s(message, before, elapsed)?;
        if (message.send_period_ms, message.receive_multiplier)
            != (before.send_period_ms, before.receive_multiplier)
        {
            return Err("its send period or receive multiplier has changed");
        }
        if let Some((stamp, before)) = message.time.zip(before.time) {
            let stamped_s = stamp.as_secs_f64() - before.as_secs_f64();
            if stamped_s <= 0.0
                || (stamped_s - counted_s).abs() > 0.5 * counted_s + STAMP_TOLERANCE_S
            {
                return Err("its time stamp does not match its counter");
            }
        }
        for (joints_rad, before) in [
            (&message.measured_rad, &before.measured_rad),
            (&message.commanded_rad, &before.commanded_rad),
        ] {
            if let (Some(joints_rad), Some(before)) = (joints_rad, before) {
                self.check_motion(joints_rad, before, counted_s)?;
            }
        }
        Ok(())
    }

    /// Checks that the robot can move from `before` to `joints_rad` within `by_s`.
    fn check_motion(
        &self,
        joints_rad: &Joints,
        before: &Joints,
        by_s: f64,
    ) -> Result<(), &'static str> {
        let Limits { velocity_rad_s, lower_rad, upper_rad, .. } = &self.limits;
        for j in 0..7 {
            let range = lower_rad[j] - RANGE_RAD..=upper_rad[j] + RANGE_RAD;
            // A joint that is already outside its range must be able to return.
            if !range.contains(&joints_rad[j]) && range.contains(&before[j]) {
                return Err("a joint is outside its range");
            }
            let max_step = VELOCITY * velocity_rad_s[j] * by_s + JUMP_RAD;
            if (joints_rad[j] - before[j]).abs() > max_step {
                return Err("a joint moved faster than it can");
            }
        }
        Ok(())
    }
}

/// Returns the send period of a message.
fn period(message: &Monitoring) -> Duration {
    Duration::from_millis(u64::from(message.send_period_ms.clamp(1, 1000)))
}

/// Returns the time from `before` to `message` by their counters, in s, if plausible.
fn counted_time_s(
    message: &Monitoring,
    before: &Monitoring,
    elapsed: Duration,
) -> Result<f64, &'static str> {
    let by = f64::from(ahead(message.sequence, before.sequence));
    let period_s = f64::from(before.send_period_ms.max(1)) * 1e-3;
    if by > MAX_AHEAD + 2.0 * elapsed.as_secs_f64() / period_s {
        return Err("its counter jumps ahead");
    }
    Ok(by * period_s)
}
