//! An independent witness of the arm: it sits on the wire between cabinet and drive, passes on FRI's
//! messages, and notes when the arm is commanded to move.

use std::{
    io,
    net::{Ipv4Addr, SocketAddr, UdpSocket},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use super::fri_wire;

/// A commanded position that differs by less from the one before, in rad, is the same.
const STILL_RAD: f64 = 1e-7;

/// How long the arm is commanded to stay where it is before it counts as standing: several cycles.
const STANDS_AFTER: Duration = Duration::from_millis(60);

/// How often the threads look whether they are done.
const AWAKE: Duration = Duration::from_millis(50);

/// Messages go through it, and it sees them.
pub(super) struct Witness {
    /// Where the cabinet sends to.
    pub(super) address: SocketAddr,
    log: Arc<Mutex<Log>>,
    over: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

#[derive(Default)]
struct Log {
    commanded_rad: Option<[f64; 7]>,
    /// When messages came in which the arm was commanded elsewhere than in those before.
    moves: Vec<Instant>,
}

fn lock(log: &Mutex<Log>) -> MutexGuard<'_, Log> {
    log.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Witness {
    /// Sits down before the drive's port of FRI.
    pub(super) fn start(drive: SocketAddr) -> io::Result<Self> {
        let bind = || -> io::Result<UdpSocket> {
            let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))?;
            socket.set_read_timeout(Some(AWAKE))?;
            Ok(socket)
        };
        let [to_cabinet, to_drive] = [bind()?, bind()?];
        let address = to_cabinet.local_addr()?;
        let log = Arc::new(Mutex::new(Log::default()));
        let over = Arc::new(AtomicBool::new(false));
        let cabinet = Arc::new(Mutex::new(None));
        let down = {
            let [from, to] = [to_cabinet.try_clone()?, to_drive.try_clone()?];
            let (log, cabinet) = (Arc::clone(&log), Arc::clone(&cabinet));
            pass_on(from, Arc::clone(&over), move |datagram, sender| {
                // Passed on first: what is noted costs the drive no time.
                let _ = to.send_to(datagram, drive);
                *cabinet.lock().unwrap_or_else(PoisonError::into_inner) = Some(sender);
                lock(&log).note(datagram, Instant::now());
            })
        };
        let up = pass_on(to_drive, Arc::clone(&over), move |datagram, _| {
            let sender = *cabinet.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some(sender) = sender {
                let _ = to_cabinet.send_to(datagram, sender);
            }
        });
        Ok(Self { address, log, over, threads: vec![down, up] })
    }

    /// The controller is another one: where it is first is no motion.
    pub(super) fn forget(&self) {
        lock(&self.log).commanded_rad = None;
    }

    /// Where the arm is commanded to, in rad.
    pub(super) fn position(&self) -> Option<[f64; 7]> {
        lock(&self.log).commanded_rad
    }

    /// When the arm was first commanded to move after an instant.
    pub(super) fn first_move_after(&self, instant: Instant) -> Option<Instant> {
        let log = lock(&self.log);
        log.moves.get(log.moves.partition_point(|at| *at <= instant)).copied()
    }

    /// When the arm was last commanded to move before an instant.
    pub(super) fn last_move_before(&self, instant: Instant) -> Option<Instant> {
        let log = lock(&self.log);
        log.moves[..log.moves.partition_point(|at| *at <= instant)].last().copied()
    }

    /// Whether the arm stands.
    pub(super) fn stands(&self) -> bool {
        lock(&self.log).moves.last().is_none_or(|at| at.elapsed() > STANDS_AFTER)
    }

    /// Waits until the arm is commanded to move, since `since`; none if that does not come.
    pub(super) fn await_move(&self, since: Instant, patience: Duration) -> Option<Instant> {
        wait(patience, || self.first_move_after(since))
    }

    /// Waits until the arm stands; none if that does not come.
    pub(super) fn await_rest(&self, patience: Duration) -> Option<()> {
        wait(patience, || self.stands().then_some(()))
    }
}

impl Drop for Witness {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// Looks until there is something to be seen, or patience is over.
fn wait<T>(patience: Duration, look: impl Fn() -> Option<T>) -> Option<T> {
    let since = Instant::now();
    loop {
        let seen = look();
        if seen.is_some() || since.elapsed() > patience {
            return seen;
        }
        thread::sleep(Duration::from_millis(1));
    }
}

impl Log {
    fn note(&mut self, datagram: &[u8], now: Instant) {
        let Some(read) = fri_wire::monitoring(datagram) else { return };
        let Some(commanded_rad) = read.commanded_rad else { return };
        if let Some(before) = self.commanded_rad
            && (0..7).any(|j| (commanded_rad[j] - before[j]).abs() > STILL_RAD)
        {
            self.moves.push(now);
        }
        self.commanded_rad = Some(commanded_rad);
    }
}

fn pass_on(
    from: UdpSocket,
    over: Arc<AtomicBool>,
    take: impl Fn(&[u8], SocketAddr) + Send + 'static,
) -> JoinHandle<()> {
    thread::spawn(move || {
        raise();
        let mut buffer = [0; 2048];
        while !over.load(Ordering::Relaxed) {
            if let Ok((length, sender)) = from.recv_from(&mut buffer) {
                take(&buffer[..length], sender);
            }
        }
    })
}

/// Ahead of the attackers on this machine, where the system permits it: the witness must not be what
/// makes the drive's answers late.
fn raise() {
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
        set_thread_priority_and_policy, thread_native_id,
    };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    if let Ok(value) = ThreadPriorityValue::try_from(41_u8) {
        let priority = ThreadPriority::Crossplatform(value);
        // Without it the witness is an ordinary thread.
        let _ = set_thread_priority_and_policy(thread_native_id(), priority, policy);
    }
}
