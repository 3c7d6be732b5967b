//! Sections that other threads plan while the caller uses the sections before them.

use std::{
    collections::VecDeque,
    ops::Range,
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, Sender, channel},
    },
    thread,
};

use iiwa_path::Step;

use crate::{section::Section, section_planner::SectionPlanner, timing::TimingError};

/// Moves that are planned ahead per thread, at most: enough to keep all threads busy, few enough
/// for little memory.
const MOVES_AHEAD: usize = 100;

/// Threads, and the sections that they plan, in the order of the path.
#[derive(Debug)]
pub(crate) struct PlannedAhead {
    jobs: Sender<SectionJob>,
    pending: VecDeque<PendingSection>,
    /// Step at which the first section that no thread plans yet begins.
    next_step: usize,
    /// Number of moves of the pending sections.
    moves: usize,
    max_moves: usize,
    /// Set when the caller needs no more sections.
    abandoned: Arc<AtomicBool>,
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
    /// as good: with fewer than two threads, or for a path with few moves or no stop on its way.
    pub(crate) fn new(planner: &SectionPlanner, threads: impl FnOnce() -> usize) -> Option<Self> {
        let steps = planner.path.steps();
        let is_long = steps.iter().filter(|step| step.moves()).nth(MOVES_AHEAD).is_some();
        let stops = |pair: &[Step]| !pair[0].moves() && pair[1].moves();
        if !is_long || !steps.windows(2).any(stops) {
            return None;
        }
        let threads = threads();
        if threads < 2 {
            return None;
        }
        let planner = Arc::new(planner.clone());
        let abandoned = Arc::default();
        let (jobs, received) = channel();
        let received = Arc::new(Mutex::new(received));
        for _ in 0..threads {
            let worker = SectionWorker {
                planner: Arc::clone(&planner),
                jobs: Arc::clone(&received),
                abandoned: Arc::clone(&abandoned),
            };
            thread::Builder::new()
                .name("section planner".into())
                .spawn(move || worker.run())
                .ok()?;
        }
        let max_moves = MOVES_AHEAD * threads;
        let pending = VecDeque::new();
        Some(Self { jobs, pending, next_step: 0, moves: 0, max_moves, abandoned })
    }

    /// Returns the section of these moves, each section of the path in turn. Returns `None` if no
    /// thread has planned it.
    pub(crate) fn take(
        &mut self,
        planner: &SectionPlanner,
        moves: &Range<usize>,
    ) -> Option<Result<Section, TimingError>> {
        self.fill(planner);
        let first = self.pending.pop_front()?;
        self.moves -= first.moves.len();
        // A thread that panics sends nothing.
        (first.moves == *moves).then(|| first.section.recv().ok())?
    }

    /// Gives the threads as many sections as may be pending.
    fn fill(&mut self, planner: &SectionPlanner) {
        let steps = planner.path.steps();
        while self.moves < self.max_moves && self.next_step < steps.len() {
            let first = self.next_step;
            let end = first + steps[first..].iter().take_while(|step| step.moves()).count();
            self.next_step = end + steps[end..].iter().take_while(|step| !step.moves()).count();
            if end > first {
                let (sender, section) = channel();
                // The threads live as long as `jobs`.
                let _ = self.jobs.send(SectionJob { moves: first..end, section: sender });
                self.pending.push_back(PendingSection { moves: first..end, section });
                self.moves += end - first;
            }
        }
    }
}

impl Drop for PlannedAhead {
    fn drop(&mut self) {
        self.abandoned.store(true, Ordering::Relaxed);
    }
}

/// Thread that plans sections.
struct SectionWorker {
    planner: Arc<SectionPlanner>,
    jobs: Arc<Mutex<Receiver<SectionJob>>>,
    abandoned: Arc<AtomicBool>,
}

impl SectionWorker {
    fn run(&self) {
        let mut scratch = self.planner.scratch();
        while let Some(SectionJob { moves, section }) = self.next() {
            // The caller may have ended meanwhile.
            let _ = section.send(self.planner.plan(moves, &mut scratch));
        }
    }

    /// Waits for the next job. Returns `None` at the end.
    fn next(&self) -> Option<SectionJob> {
        let job = self.jobs.lock().ok()?.recv().ok()?;
        (!self.abandoned.load(Ordering::Relaxed)).then_some(job)
    }
}
