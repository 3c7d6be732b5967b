//! Stops at random instants of requests, planning, start, motion and end, and losses of clients,
//! drive and cabinet: no motion may follow.

use std::{
    collections::BTreeMap,
    path::Path,
    time::{Duration, Instant},
};

use fastrand::Rng;

use super::{
    deadlines::scaled,
    output::print,
    report::Row,
    rig::{Fault, Parts, Rig},
    round::{Attempt, Outcome, Planning, Rounds},
};

/// Extent of the attempts.
pub(super) struct StopExtent {
    pub(super) rounds: usize,
    pub(super) time: Duration,
    pub(super) longest_planning: Duration,
}

#[derive(Default)]
struct Tally {
    rounds: usize,
    void: usize,
    unanswered: usize,
    moved: usize,
    worst_reply: Duration,
    worst_move: Duration,
    /// Attempts that the harness could not make.
    failed: usize,
}

/// Makes attempts, each kind in turn.
pub(super) fn run(binary: &Path, seed: u64, extent: &StopExtent) -> Result<Vec<Row>, Fault> {
    let mut random = Rng::with_seed(seed);
    let mut rig = Rig::start(binary, Parts::default())?;
    let planning = Planning::measure(&mut rig, &mut random)?;
    print(&format!("from a request to the motion: {planning:?}"));
    let begin = Instant::now();
    let mut tallies: BTreeMap<usize, Tally> = BTreeMap::new();
    for round in 0..extent.rounds {
        // Each kind at least once, however slow.
        if begin.elapsed() > extent.time && round >= Attempt::ALL.len() {
            break;
        }
        let kind = round % Attempt::ALL.len();
        let attempt = Attempt::ALL[kind];
        let mut rounds = Rounds {
            rig: &mut rig,
            random: random.fork(),
            planning,
            longest_planning: extent.longest_planning,
        };
        let outcome = rounds.rig.await_idle().and_then(|()| rounds.make(attempt));
        let tally = tallies.entry(kind).or_default();
        tally.rounds += 1;
        match outcome {
            Ok(outcome) => tally.add(round, attempt, outcome),
            Err(fault) => {
                tally.failed += 1;
                print(&format!("round {round}, {}: not attempted: {fault}", attempt.name()));
                rig.restart()?;
            }
        }
    }
    Ok(tallies.iter().map(|(kind, tally)| tally.row(Attempt::ALL[*kind])).collect())
}

impl Tally {
    fn add(&mut self, round: usize, attempt: Attempt, outcome: Outcome) {
        let Outcome { reply, unanswered, moved_after, is_void } = outcome;
        self.void += usize::from(is_void);
        self.unanswered += usize::from(unanswered);
        self.moved += usize::from(moved_after.is_some());
        self.worst_reply = self.worst_reply.max(reply.unwrap_or_default());
        self.worst_move = self.worst_move.max(moved_after.unwrap_or_default());
        if unanswered || moved_after.is_some() {
            print(&format!("round {round}, {}: {outcome:?}", attempt.name()));
        }
    }

    fn row(&self, attempt: Attempt) -> Row {
        let seconds = Duration::as_secs_f64;
        let mut parts = vec![format!("{} rounds", self.rounds)];
        if self.void > 0 {
            parts.push(format!("{} void, as the arm moved before", self.void));
        }
        if !self.worst_reply.is_zero() {
            parts.push(format!("reply after {:.2} s at worst", seconds(&self.worst_reply)));
        }
        parts.push(format!("{} without a reply in time", self.unanswered));
        parts.push(match self.moved {
            0 => "0 moved".to_owned(),
            moved => format!("{moved} moved, up to {:.2} s later", seconds(&self.worst_move)),
        });
        if self.failed > 0 {
            parts.push(format!("{} could not be attempted", self.failed));
        }
        let s = scaled(Duration::from_secs(1)).as_secs();
        let required = match attempt {
            Attempt::CabinetKilled => {
                format!("a reply within {} s, no motion; the next stop within {} s", 6 * s, s)
            }
            Attempt::ConnectionClosed | Attempt::ClientKilled => "no motion".to_owned(),
            Attempt::DriveEnded(_) => "it ends, no motion".to_owned(),
            _ => format!("a reply within {s} s, no motion"),
        };
        Row {
            quantity: attempt.name(),
            required,
            measured: parts.join(", "),
            met: self.unanswered + self.moved + self.failed == 0,
        }
    }
}
