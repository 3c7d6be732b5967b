//! Independent witness of the arm: an FRI relay between cabinet and drive that records changes of
//! the commanded position.

use std::{
    collections::VecDeque,
    io,
    net::{Ipv4Addr, SocketAddr, UdpSocket},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use super::{arrival::TimedSocket, fri_wire};

/// Largest change of the commanded position that counts as standstill, in rad.
const STILL_RAD: f64 = 1e-7;

/// Time for which the commanded position of an arm at rest is constant: several cycles.
const REST_TIME: Duration = Duration::from_millis(60);

/// Interval of the shutdown check.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// FRI relay.
pub(super) struct Witness {
    /// Address that the cabinet sends to.
    pub(super) address: SocketAddr,
    log: Arc<Mutex<Log>>,
    shutdown: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

/// Joint positions in a message.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Arrival time by the kernel's real-time clock.
    pub(super) arrival: Duration,
    /// Time stamp of the controller; for an answer, that of the answered message.
    pub(super) stamp: Duration,
    /// Joint positions, in rad.
    pub(super) joints_rad: [f64; 7],
}

/// Messages of a run.
#[derive(Debug, Default)]
pub(super) struct Recording {
    /// Commanded positions in the controller's messages.
    pub(super) commanded: Vec<Sample>,
    /// Set-points in the drive's answers.
    pub(super) answers: Vec<Sample>,
}

/// Maximum number of messages that await their answers.
const UNANSWERED: usize = 1000;

#[derive(Default)]
struct Log {
    commanded_rad: Option<[f64; 7]>,
    /// Messages, while they are recorded.
    recording: Option<Recording>,
    /// Sequence numbers and time stamps of the last messages.
    stamps: VecDeque<(u64, Duration)>,
    /// Arrival times of messages with a changed commanded position.
    moves: Vec<Instant>,
}

fn lock(log: &Mutex<Log>) -> MutexGuard<'_, Log> {
    log.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Witness {
    /// Starts a relay to the FRI port of a drive.
    pub(super) fn start(drive: SocketAddr) -> io::Result<Self> {
        let bind = || -> io::Result<UdpSocket> {
            let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))?;
            socket.set_read_timeout(Some(POLL_INTERVAL))?;
            Ok(socket)
        };
        let [to_cabinet, to_drive] = [bind()?, bind()?];
        let address = to_cabinet.local_addr()?;
        let log = Arc::new(Mutex::new(Log::default()));
        let shutdown = Arc::new(AtomicBool::new(false));
        let cabinet = Arc::new(Mutex::new(None));
        let down = {
            let [from, to] = [to_cabinet.try_clone()?, to_drive.try_clone()?];
            let (log, cabinet) = (Arc::clone(&log), Arc::clone(&cabinet));
            relay(from, Arc::clone(&shutdown), move |datagram, sender, arrival| {
                // Forwards first: recording does not delay the drive.
                let _ = to.send_to(datagram, drive);
                *cabinet.lock().unwrap_or_else(PoisonError::into_inner) = Some(sender);
                lock(&log).record(datagram, Instant::now(), arrival);
            })
        };
        let up_log = Arc::clone(&log);
        let up = relay(to_drive, Arc::clone(&shutdown), move |datagram, _, arrival| {
            lock(&up_log).record_answer(datagram, arrival);
            let sender = *cabinet.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some(sender) = sender {
                let _ = to_cabinet.send_to(datagram, sender);
            }
        });
        Ok(Self { address, log, shutdown, threads: vec![down, up] })
    }

    /// Forgets the commanded position: that of another controller is not a motion.
    pub(super) fn forget(&self) {
        lock(&self.log).commanded_rad = None;
    }

    /// Starts recording messages.
    pub(super) fn begin_recording(&self) {
        lock(&self.log).recording = Some(Recording::default());
    }

    /// Ends recording, and returns the messages.
    pub(super) fn end_recording(&self) -> Recording {
        lock(&self.log).recording.take().unwrap_or_default()
    }

    /// Commanded joint positions, in rad.
    pub(super) fn position(&self) -> Option<[f64; 7]> {
        lock(&self.log).commanded_rad
    }

    /// Returns the first motion after an instant.
    pub(super) fn first_move_after(&self, instant: Instant) -> Option<Instant> {
        let log = lock(&self.log);
        log.moves.get(log.moves.partition_point(|moved| *moved <= instant)).copied()
    }

    /// Returns the last motion before an instant.
    pub(super) fn last_move_before(&self, instant: Instant) -> Option<Instant> {
        let log = lock(&self.log);
        log.moves[..log.moves.partition_point(|moved| *moved <= instant)].last().copied()
    }

    /// Returns true if the arm is at rest.
    pub(super) fn is_at_rest(&self) -> bool {
        lock(&self.log).moves.last().is_none_or(|moved| moved.elapsed() > REST_TIME)
    }

    /// Waits for a motion after `since`; `None` on time-out.
    pub(super) fn await_move(&self, since: Instant, timeout: Duration) -> Option<Instant> {
        wait(timeout, || self.first_move_after(since))
    }

    /// Waits until the arm is at rest; `None` on time-out.
    pub(super) fn await_rest(&self, timeout: Duration) -> Option<()> {
        wait(timeout, || self.is_at_rest().then_some(()))
    }
}

impl Drop for Witness {
    fn drop(&mut self) {
        self.shutdown.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// Polls until there is a value or a time-out.
fn wait<T>(timeout: Duration, poll: impl Fn() -> Option<T>) -> Option<T> {
    let since = Instant::now();
    loop {
        let seen = poll();
        if seen.is_some() || since.elapsed() > timeout {
            return seen;
        }
        thread::sleep(Duration::from_millis(1));
    }
}

impl Log {
    fn record(&mut self, datagram: &[u8], now: Instant, arrival: Duration) {
        let Some(read) = fri_wire::monitoring(datagram) else { return };
        let Some(commanded_rad) = read.commanded_rad else { return };
        if let (Some(recording), Some((seconds, nanoseconds))) = (&mut self.recording, read.stamp) {
            let stamp = Duration::from_secs(seconds) + Duration::from_nanos(nanoseconds);
            recording.commanded.push(Sample { arrival, stamp, joints_rad: commanded_rad });
            self.stamps.push_back((read.sequence, stamp));
            if self.stamps.len() > UNANSWERED {
                self.stamps.pop_front();
            }
        }
        if let Some(before) = self.commanded_rad
            && (0..7).any(|j| (commanded_rad[j] - before[j]).abs() > STILL_RAD)
        {
            self.moves.push(now);
        }
        self.commanded_rad = Some(commanded_rad);
    }

    fn record_answer(&mut self, datagram: &[u8], arrival: Duration) {
        let Some(recording) = &mut self.recording else { return };
        let Some(fri_wire::Answer { sequence, joints_rad }) = fri_wire::answer(datagram) else {
            return;
        };
        let answered = self.stamps.iter().rev().find(|(number, _)| *number == sequence);
        if let Some((_, stamp)) = answered {
            recording.answers.push(Sample { arrival, stamp: *stamp, joints_rad });
        }
    }
}

fn relay(
    from: UdpSocket,
    shutdown: Arc<AtomicBool>,
    take: impl Fn(&[u8], SocketAddr, Duration) + Send + 'static,
) -> JoinHandle<()> {
    thread::spawn(move || {
        raise();
        let from = TimedSocket::new(from);
        let mut buffer = [0; 2048];
        while !shutdown.load(Ordering::Relaxed) {
            if let Ok((length, sender, arrival)) = from.receive(&mut buffer) {
                take(&buffer[..length], sender, arrival);
            }
        }
    })
}

/// Gives the thread real-time priority if permitted: the witness must not delay the drive's
/// answers.
fn raise() {
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
        set_thread_priority_and_policy, thread_native_id,
    };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    if let Ok(value) = ThreadPriorityValue::try_from(41_u8) {
        let priority = ThreadPriority::Crossplatform(value);
        // Without permission, the thread keeps its priority.
        let _ = set_thread_priority_and_policy(thread_native_id(), priority, policy);
    }
}
