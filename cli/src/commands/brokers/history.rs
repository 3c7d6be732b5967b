//! `iiwasim history`.

use std::ops::ControlFlow::Continue;

use iiwa_bridge::{
    Kind, Timestamp,
    history::{History, ProgramHistory},
    kafka::reader::{KafkaReader, Selection},
};
use iiwa_json::printable;
use iiwa_plan::is_above;
use iiwa_report::{fitted, table};

use crate::{
    args,
    broker_access::{failure, kafka_connection},
    failure::{Failure, print_note},
    output, terminal,
};

/// Prints the history, and applies the gates.
pub(crate) fn run(options: &args::History) -> Result<(), Failure> {
    let (reader, selection) = reader(&options.stored, options.name.clone())?;
    let mut messages = Vec::new();
    let left_out = reader
        .read(Kind::Run, &selection, |message| {
            messages.push(message);
            Continue(())
        })
        .map_err(|error| failure(&error))?;
    let mut history = History::of(messages, options.recent);
    if let Some(program) = &options.program {
        history.programs.retain(|history| history.program.as_ref() == Some(program));
    }
    if left_out.unreadable > 0 {
        print_note(&format!("{} records could not be read\n", left_out.unreadable));
    }
    if options.json {
        output::print_json(&history)?;
    } else {
        output::print(&text(&history))?;
    }
    judge(&history, options.max_drift)
}

/// Returns a reader of the stored messages.
pub(crate) fn reader(
    stored: &args::Stored,
    robot: Option<String>,
) -> Result<(KafkaReader, Selection), Failure> {
    let connection = kafka_connection(&stored.brokers, &stored.access)?;
    let reader = KafkaReader::new(&connection, &stored.access.prefix);
    let reader = reader.map_err(|error| failure(&error))?;
    let selection = Selection {
        robot,
        from: stored.from.map(Timestamp::from),
        until: stored.until.map(Timestamp::from),
    };
    Ok((reader, selection))
}

fn judge(history: &History, max_drift: Option<f64>) -> Result<(), Failure> {
    let Some(limit) = max_drift else { return Ok(()) };
    let slower = history.programs.iter().filter_map(|program| {
        let percent = program.drift.as_ref()?.percent;
        if !is_above(percent, limit, 1) {
            return None;
        }
        Some(format!("{} on {} by {percent:.1} %", name(program), printable(&program.robot)))
    });
    let slower: Vec<_> = slower.collect();
    if slower.is_empty() {
        return Ok(());
    }
    Err(Failure::Gate(format!("slower than before by more than {limit} %: {}", slower.join(", "))))
}

fn name(program: &ProgramHistory) -> String {
    program.program.as_deref().map_or_else(|| "(no name)".to_owned(), printable)
}

fn text(history: &History) -> String {
    if history.programs.is_empty() {
        return "No runs\n".to_owned();
    }
    let mut rows = table(&[
        "program",
        "robot",
        "runs",
        "failed",
        "planned s",
        "median s",
        "last s",
        "drift %",
        "trend",
    ]);
    let seconds = |time: Option<f64>| time.map_or("-".to_owned(), |time| format!("{time:.3}"));
    for program in &history.programs {
        let last = program.runs.last();
        rows.add_row([
            name(program),
            printable(&program.robot),
            program.runs.len().to_string(),
            program.failed().to_string(),
            seconds(last.and_then(|run| run.planned_s)),
            seconds(program.median_s),
            seconds(last.and_then(|run| run.measured_s)),
            program.drift.map_or("-".to_owned(), |drift| format!("{:+.1}", drift.percent)),
            program.trend(),
        ]);
    }
    format!("{}\n", fitted(rows, terminal::width()))
}
