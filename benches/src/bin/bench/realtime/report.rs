//! Table, its notes and the faults.

use std::process::ExitCode;

use iiwasim_benches::{Result, machine};

use super::{
    case::Case,
    measured::{Measured, measure},
    subscribers::Subscribers,
};

/// Measures all cases and prints them.
pub(crate) fn report(cases: &[Case]) -> Result<ExitCode> {
    println!("On {}.\n", machine::processor());
    println!(
        "| period | time | subscribers | real time: cabinet, drive | messages | not answered in \
         time | of these lost by the drive | cabinet held up | median | 99.9 % | longest | \
         trajectories |"
    );
    println!("|---:|---:|---|---|---:|---:|---:|---:|---:|---:|---:|---:|");
    let mut notes = Vec::new();
    let mut faults = Vec::new();
    for case in cases {
        let Some(measured) = measure(case)? else {
            notes
                .push("- `setpriv` cannot keep the drive from real-time priority here.".to_owned());
            continue;
        };
        print_row(case, &measured);
        note(case, &measured, &mut notes, &mut faults);
    }
    println!("\n{}", notes.join("\n"));
    if faults.is_empty() {
        return Ok(ExitCode::SUCCESS);
    }
    println!("\nNOT KEPT: {}", faults.join("; "));
    Ok(ExitCode::FAILURE)
}

fn print_row(case: &Case, measured: &Measured) {
    let Measured { cabinet, drive, runs, .. } = measured;
    let yes = |condition| if condition { "yes" } else { "no" };
    println!(
        "| {} ms | {} s | {} | {}, {} | {} | {} | {} | {} | {:.0} us | {:.0} us | {:.0} us | {} of \
         {} |",
        case.period_ms,
        case.seconds,
        if case.subscribers { "10, one asleep" } else { "none" },
        yes(cabinet.real_time),
        yes(drive.real_time),
        cabinet.cycles,
        cabinet.late_us.len() as u64 + measured.unanswered(),
        measured.lost(),
        cabinet.held_up,
        cabinet.latency_us[0],
        cabinet.latency_us[1],
        cabinet.latency_us[2],
        runs.done,
        runs.begun,
    );
}

/// Number of cycles of which one may be lost: a witness detects a stall up to 0.25 ms after its
/// start, so that several in a row, at 1 ms, may leave a late answer unexplained.
const UNEXPLAINED: u64 = 10_000;

fn note(case: &Case, measured: &Measured, notes: &mut Vec<String>, faults: &mut Vec<String>) {
    let Measured { cabinet, drive, subscribers, runs, still } = measured;
    let name = format!("{} ms, {} s", case.period_ms, case.seconds);
    let mut add_note = |message: String| notes.push(format!("- {name}: {message}."));
    add_note(match still {
        None => "no witness: that takes real-time priority, `chrt` and `taskset`".to_owned(),
        Some(still) => {
            let longest_us = still.iter().map(|[from, to]| to - from).max().unwrap_or(0);
            let all_us: i64 = still.iter().map(|[from, to]| to - from).sum();
            format!(
                "the machine stood still {} times, {:.0} ms in all and {:.1} ms at most",
                still.len(),
                all_us as f64 * 1e-3,
                longest_us as f64 * 1e-3
            )
        }
    });
    add_note(format!(
        "{} messages reached the drive, which found the next one there already when it answered {} \
         of them; the longest that it took to answer was {:.0} us; its memory was {:.1} MB at the \
         start and {:.1} MB at most",
        drive.received, drive.behind, drive.slowest_us, drive.memory_mb[0], drive.memory_mb[1],
    ));
    if let Some(Subscribers { live, asleep }) = subscribers {
        let fewest = live.iter().map(|followed| followed.messages).min().unwrap_or(0);
        let missed: u64 = live.iter().map(|followed| followed.missed).sum();
        add_note(format!(
            "the live subscribers got {fewest} messages or more, and missed {missed} in all; the \
             sleeper got {} once awake, and had missed {}",
            asleep.messages, asleep.missed
        ));
        if missed > cabinet.cycles.saturating_sub(drive.received) {
            faults.push(format!("{name}: live subscribers missed {missed} messages"));
        }
    }
    if let Some([took, stood]) = measured.late_by_drive().max_by_key(|[took, stood]| took - stood) {
        add_note(format!(
            "the worst answer lost by the drive took {took} us, for {stood} us of which the \
             machine stood still"
        ));
    }
    if runs.done < runs.begun {
        add_note(format!("a trajectory broke off: {}", runs.error));
    }
    if drive.real_time && measured.lost() * UNEXPLAINED > cabinet.cycles {
        faults.push(format!("{name}: the drive lost {} cycles", measured.lost()));
    }
}
