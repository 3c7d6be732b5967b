//! Where the arm is.

use std::{
    sync::Mutex,
    thread,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use iiwa_kin::Joints;
use iiwa_link::Published;
use iiwa_view::Nearest;
use serde::Serialize;

use crate::{failure::Failure, output};

use super::{Setup, Viewers, Words, word};

/// Pages are told so often at most: more often than any screen shows it.
const EVERY: Duration = Duration::from_millis(10);

/// How long nothing may come before it is seen whether the twin is to end.
const LOOK: Duration = Duration::from_millis(50);

/// Where the arm was last, and when that came in.
#[derive(Debug, Default)]
pub(crate) struct Live(Mutex<Option<(Instant, Joints)>>);

impl Live {
    /// Where the arm is; none if nothing was heard for a second.
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

/// The word for pages.
#[derive(Serialize)]
struct Where {
    /// The drive's stamp.
    t_s: f64,
    joints_rad: Joints,
    /// When it came in, in ms since 1970.
    at_ms: f64,
    /// How much later than the fastest message of late.
    behind_ms: f64,
    nearest: Option<Nearest>,
}

/// Follows the drive's stream until the twin ends. It connects again by itself.
pub(crate) fn follow(
    setup: &Setup,
    live: &Live,
    words: &Words,
    viewers: Option<&Mutex<Viewers>>,
) -> Result<(), Failure> {
    let mut lag = Lag::default();
    let mut told = None::<Instant>;
    let mut stream = None;
    while !output::interrupted() {
        let Some(open) = &mut stream else {
            stream = setup.stream().ok();
            if stream.is_none() {
                thread::sleep(LOOK);
            }
            continue;
        };
        let mut newest = None;
        let mut patience = LOOK;
        // Whatever waits is older than the last of it.
        loop {
            match open.next(patience) {
                Ok(Some(Published::Joints { t_s, joints_rad })) => newest = Some((t_s, joints_rad)),
                Ok(Some(_)) => {}
                Ok(None) => break,
                Err(_) => {
                    // The other thread tells why.
                    stream = None;
                    thread::sleep(LOOK);
                    break;
                }
            }
            patience = Duration::ZERO;
        }
        let Some((t_s, joints_rad)) = newest else { continue };
        let now = Instant::now();
        live.set(now, joints_rad);
        let behind_ms = lag.behind_ms(now, t_s);
        if told.is_some_and(|told| now - told < EVERY) {
            continue;
        }
        told = Some(now);
        let clock = SystemTime::now();
        if let Some(Ok(mut viewers)) = viewers.map(Mutex::lock) {
            viewers.joints(clock, &joints_rad)?;
        }
        let since_1970 = clock.duration_since(UNIX_EPOCH).unwrap_or_default();
        let at_ms = 1e3 * since_1970.as_secs_f64();
        let nearest = setup.nearest(&joints_rad);
        words.send_replace(word("live", &Where { t_s, joints_rad, at_ms, behind_ms, nearest }));
    }
    Ok(())
}

/// How late messages come in: next to the fastest one, since no clock is shared with the controller.
#[derive(Debug, Default)]
struct Lag {
    since: Option<Instant>,
    /// When it came in minus its stamp, in s, at least: in the window before, and in this one.
    least_s: [f64; 2],
    window_from_s: f64,
    last_s: f64,
}

impl Lag {
    /// Clocks drift: what was long ago does not count.
    const WINDOW_S: f64 = 10.0;

    fn behind_ms(&mut self, now: Instant, t_s: f64) -> f64 {
        let now_s = (now - *self.since.get_or_insert(now)).as_secs_f64();
        let late_s = now_s - t_s;
        // Stamps that begin again are those of another drive.
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
