//! The joint positions of the arm, from the stream of the drive.

use std::{
    sync::Mutex,
    thread,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use iiwa_kin::Joints;
use iiwa_link::Published;
use iiwa_view::NearestPlaces;
use serde::Serialize;

use crate::{failure::Failure, output};

use super::{
    Setup, Viewers,
    message::{PageChannel, page_message},
};

/// Time between messages to pages, at least: less than a frame of a screen.
const MESSAGE_INTERVAL: Duration = Duration::from_millis(10);

/// How long to wait for the stream before the interrupt flag is checked.
const POLL: Duration = Duration::from_millis(50);

/// The latest joint positions, and when they were received.
#[derive(Debug, Default)]
pub(crate) struct LatestJoints(Mutex<Option<(Instant, Joints)>>);

impl LatestJoints {
    /// The joint positions; none if nothing was received for a second.
    pub(super) fn now(&self) -> Option<Joints> {
        const FRESH: Duration = Duration::from_secs(1);
        let newest = *self.0.lock().ok()?;
        newest.filter(|(at, _)| at.elapsed() < FRESH).map(|(_, joints_rad)| joints_rad)
    }

    fn set(&self, at: Instant, joints_rad: Joints) {
        if let Ok(mut newest) = self.0.lock() {
            *newest = Some((at, joints_rad));
        }
    }
}

/// Joint positions as pages receive them.
#[derive(Serialize)]
struct LiveJoints {
    /// Time stamp of the drive.
    t_s: f64,
    joints_rad: Joints,
    /// When they were received, in ms since 1970.
    at_ms: f64,
    /// Delay beyond that of the fastest recent message.
    behind_ms: f64,
    #[serde(flatten)]
    nearest: NearestPlaces,
}

/// Publishes the stream of the drive until an interrupt; reconnects when it breaks off.
pub(crate) fn follow(
    setup: &Setup,
    latest: &LatestJoints,
    pages: &PageChannel,
    viewers: Option<&Mutex<Viewers>>,
) -> Result<(), Failure> {
    let mut lag = Lag::default();
    let mut last_message = None::<Instant>;
    let mut stream = None;
    while !output::interrupted() {
        let Some(open) = &mut stream else {
            stream = setup.stream().ok();
            if stream.is_none() {
                thread::sleep(POLL);
            }
            continue;
        };
        let mut newest = None;
        let mut timeout = POLL;
        // Of the queued messages, only the last one matters.
        loop {
            match open.next(timeout) {
                Ok(Some(Published::Joints { t_s, joints_rad })) => newest = Some((t_s, joints_rad)),
                Ok(Some(_)) => {}
                Ok(None) => break,
                Err(_) => {
                    // The thread that polls the state reports why.
                    stream = None;
                    thread::sleep(POLL);
                    break;
                }
            }
            timeout = Duration::ZERO;
        }
        let Some((t_s, joints_rad)) = newest else { continue };
        let now = Instant::now();
        latest.set(now, joints_rad);
        let behind_ms = lag.behind_ms(now, t_s);
        if last_message.is_some_and(|last| now - last < MESSAGE_INTERVAL) {
            continue;
        }
        last_message = Some(now);
        let clock = SystemTime::now();
        if let Some(Ok(mut viewers)) = viewers.map(Mutex::lock) {
            viewers.joints(clock, &joints_rad)?;
        }
        let since_1970 = clock.duration_since(UNIX_EPOCH).unwrap_or_default();
        let at_ms = 1e3 * since_1970.as_secs_f64();
        let nearest = setup.nearest(&joints_rad);
        pages.send_replace(page_message(
            "live",
            &LiveJoints { t_s, joints_rad, at_ms, behind_ms, nearest },
        ));
    }
    Ok(())
}

/// Delay of messages relative to the fastest one, since no clock is shared with the controller.
#[derive(Debug, Default)]
struct Lag {
    since: Option<Instant>,
    /// Least time of reception minus time stamp, in s: in the previous window, and in this one.
    least_s: [f64; 2],
    window_from_s: f64,
    last_s: f64,
}

impl Lag {
    /// Clocks drift: old messages are no reference.
    const WINDOW_S: f64 = 10.0;

    fn behind_ms(&mut self, now: Instant, t_s: f64) -> f64 {
        let now_s = (now - *self.since.get_or_insert(now)).as_secs_f64();
        let late_s = now_s - t_s;
        // Stamps that start again are those of another drive.
        if self.last_s > t_s || self.least_s == [0.0; 2] {
            self.least_s = [late_s; 2];
            self.window_from_s = now_s;
        }
        self.last_s = t_s;
        if now_s - self.window_from_s > Self::WINDOW_S {
            self.least_s = [self.least_s[1], late_s];
            self.window_from_s = now_s;
        }
        self.least_s[1] = self.least_s[1].min(late_s);
        1e3 * (late_s - self.least_s[0].min(self.least_s[1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lag_is_next_to_the_fastest() {
        let from = Instant::now();
        let mut lag = Lag::default();
        let mut at = |now_s: f64, t_s| lag.behind_ms(from + Duration::from_secs_f64(now_s), t_s);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} is not {b}");
        near(at(0.0, 100.0), 0.0);
        near(at(1.003, 101.0), 3.0);
        near(at(1.999, 102.0), 0.0);
        near(at(3.0, 103.0), 1.0);
        // A clock that loses 1 ms a second is followed.
        for i in 4..100 {
            let i = f64::from(i);
            assert!(at(1.001 * i, 100.0 + i) < 25.0);
        }
        // Another drive.
        near(at(200.0, 0.5), 0.0);
        near(at(200.504, 1.0), 4.0);
    }
}
