//! Joint positions of the arm, from the stream of the drive.

use std::{
    sync::Mutex,
    thread,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use iiwa_files::interrupt;
use iiwa_foxglove::Viewers;
use iiwa_kin::Joints;
use iiwa_link::{Lag, Published};
use iiwa_page::NearestPlaces;
use serde::Serialize;

use crate::{
    Setup, TwinError,
    message::{PageChannel, page_message},
};

/// Minimum time between messages to pages: less than a screen frame.
const MESSAGE_INTERVAL: Duration = Duration::from_millis(10);

/// Timeout of the stream before the interrupt flag is checked.
const POLL: Duration = Duration::from_millis(50);

/// Latest joint positions, and their reception time.
#[derive(Debug, Default)]
pub(crate) struct LatestJoints(Mutex<Option<(Instant, Joints)>>);

impl LatestJoints {
    /// Returns the joint positions; `None` if nothing was received for 1 s.
    pub(crate) fn now(&self) -> Option<Joints> {
        const FRESH: Duration = Duration::from_secs(1);
        let newest = *self.0.lock().ok()?;
        newest.filter(|(received, _)| received.elapsed() < FRESH).map(|(_, joints_rad)| joints_rad)
    }

    fn set(&self, received: Instant, joints_rad: Joints) {
        if let Ok(mut newest) = self.0.lock() {
            *newest = Some((received, joints_rad));
        }
    }
}

/// Joint positions in page format.
#[derive(Serialize)]
struct LiveJoints {
    /// Time stamp of the drive.
    t_s: f64,
    joints_rad: Joints,
    /// Torques that the joints exert, if measured: the controller reports them with the opposite
    /// sign.
    torque_nm: Option<Joints>,
    /// Reception time, in ms since 1970.
    at_ms: f64,
    /// Delay relative to the fastest recent message.
    behind_ms: f64,
    #[serde(flatten)]
    nearest: NearestPlaces,
}

/// Publishes the stream of the drive until an interrupt; reconnects when the stream fails.
pub(crate) fn follow(
    setup: &Setup,
    latest: &LatestJoints,
    pages: &PageChannel,
    viewers: Option<&Mutex<Viewers>>,
) -> Result<(), TwinError> {
    let mut lag = Lag::default();
    let mut last_message = None::<Instant>;
    let mut stream = None;
    // Torques arrive before the positions with the same time stamp.
    let mut torques = None;
    while !interrupt::has_come() {
        let Some(open) = &mut stream else {
            stream = setup.stream().ok();
            if stream.is_none() {
                thread::sleep(POLL);
            }
            continue;
        };
        let mut newest = None;
        let mut timeout = POLL;
        // Only the last of the queued messages is relevant.
        loop {
            match open.next(timeout) {
                Ok(Some(Published::Joints { t_s, joints_rad })) => newest = Some((t_s, joints_rad)),
                Ok(Some(Published::Torques { t_s, measured_nm, .. })) => {
                    torques = Some((t_s, measured_nm));
                }
                Ok(Some(_)) => {}
                Ok(None) => break,
                Err(_) => {
                    // The thread that polls the state reports the reason.
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
        let of_now = torques.filter(|(at_s, _)| *at_s == t_s);
        let torque_nm = of_now.map(|(_, measured_nm)| measured_nm.map(|it| -it));
        let live = LiveJoints { t_s, joints_rad, torque_nm, at_ms, behind_ms, nearest };
        pages.send_replace(page_message("live", &live));
    }
    Ok(())
}
