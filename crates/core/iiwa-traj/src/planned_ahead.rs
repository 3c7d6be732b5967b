//! Sections that other threads plan while the caller uses the sections before them.

use std::{
    collections::VecDeque,
    ops::Range,
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, RecvTimeoutError, Sender, channel},
    },
    thread::{self, JoinHandle},
    time::Duration,
};

use crate::{section::Section, section_planner::SectionPlanner, timing::TimingError};

/// Moves per thread up to which further sections are planned ahead: enough to keep all threads
/// busy, few enough for little memory. Longer sections are planned ahead by one per thread.
const MOVES_AHEAD: usize = 100;

/// Time after which a waiting caller looks whether it is interrupted.
const INTERRUPT_WAIT: Duration = Duration::from_millis(20);

/// Threads, and the sections that they plan, in the order of the path. The threads have ended when
/// this is dropped.
#[derive(Debug)]
pub(crate) struct PlannedAhead {
    /// `None` when the threads end.
    jobs: Option<Sender<SectionJob>>,
    pending: Mutex<VecDeque<PendingSection>>,
    /// Step at which the first section that no thread plans yet begins.
    next_step: usize,
    /// Number of moves of the pending sections.
    moves: usize,
    /// Interrupts the threads.
    stop: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

/// Moves to plan, and where to send the section.
#[derive(Debug)]
struct SectionJob {
    moves: Range<usize>,
    section: Sender<Result<Section, TimingError>>,
}

#[derive(Debug)]
struct PendingSection {
    moves: Range<usize>,
    section: Receiver<Result<Section, TimingError>>,
}

impl PlannedAhead {
    /// Starts the threads. Returns `None` if that fails, or if planning on the caller's thread is
    /// as good: with fewer than two threads, or for a path with few moves or a single section.
    pub(crate) fn new(planner: &SectionPlanner, threads: impl FnOnce() -> usize) -> Option<Self> {
        let steps = planner.path.steps();
        let is_long = steps.iter().filter(|step| step.moves()).nth(MOVES_AHEAD).is_some();
        if !is_long {
            return None;
        }
        let sections = steps.chunk_by(|a, b| a.moves() == b.moves());
        let sections = sections.filter(|steps| steps[0].moves()).count();
        if sections < 2 {
            return None;
        }
        let count = threads().min(sections);
        if count < 2 {
            return None;
        }
        let stop = Arc::default();
        let mut planner = planner.clone();
        planner.stop = Arc::clone(&stop);
        let planner = Arc::new(planner);
        let (jobs, received) = channel();
        let received = Arc::new(Mutex::new(received));
        let mut threads = Vec::with_capacity(count);
        for _ in 0..count {
            let (planner, jobs) = (Arc::clone(&planner), Arc::clone(&received));
            let name = "section planner".to_owned();
            let run = move || run(&planner, &jobs);
            threads.push(thread::Builder::new().name(name).spawn(run).ok()?);
        }
        let (jobs, pending) = (Some(jobs), Mutex::default());
        Some(Self { jobs, pending, next_step: 0, moves: 0, stop, threads })
    }

    /// Returns the section of these moves, each section of the path in turn. Returns `None` if no
    /// thread has planned it.
    pub(crate) fn take(
        &mut self,
        planner: &SectionPlanner,
        moves: &Range<usize>,
    ) -> Option<Result<Section, TimingError>> {
        self.fill(planner);
        let first = self.pending.get_mut().ok()?.pop_front()?;
        self.moves -= first.moves.len();
        self.fill(planner);
        if first.moves != *moves {
            return None;
        }
        loop {
            if planner.stop.load(Ordering::Relaxed) {
                return Some(Err(TimingError::Interrupted));
            }
            match first.section.recv_timeout(INTERRUPT_WAIT) {
                Ok(section) => return Some(section),
                Err(RecvTimeoutError::Timeout) => {}
                // The thread has panicked.
                Err(RecvTimeoutError::Disconnected) => return None,
            }
        }
    }

    /// Gives the threads as many sections as may be pending.
    fn fill(&mut self, planner: &SectionPlanner) {
        let threads = self.threads.len();
        let (Ok(pending), Some(jobs)) = (self.pending.get_mut(), &self.jobs) else { return };
        while (pending.len() < threads || self.moves < MOVES_AHEAD * threads)
            && self.next_step < planner.path.steps().len()
        {
            let moves = planner.moves_from(self.next_step);
            self.next_step = planner.rests_from(moves.end).end;
            if !moves.is_empty() {
                self.moves += moves.len();
                let (sender, section) = channel();
                // The threads end later than `jobs`.
                let _ = jobs.send(SectionJob { moves: moves.clone(), section: sender });
                pending.push_back(PendingSection { moves, section });
            }
        }
    }
}

impl Drop for PlannedAhead {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.jobs = None;
        for thread in self.threads.drain(..) {
            // A thread that has panicked has ended as well.
            let _ = thread.join();
        }
    }
}

/// Plans one section after the other until there are no more, or the planner is stopped.
fn run(planner: &SectionPlanner, jobs: &Mutex<Receiver<SectionJob>>) {
    let mut scratch = planner.scratch();
    loop {
        let job = jobs.lock().ok().and_then(|jobs| jobs.recv().ok());
        let Some(SectionJob { moves, section }) = job else { return };
        if planner.stop.load(Ordering::Relaxed) {
            return;
        }
        // The caller may have ended meanwhile.
        let _ = section.send(planner.plan(moves, &mut scratch));
    }
}
