//! What the programs take: memory, and room in their logs.

use std::time::{Duration, Instant};

use super::{process::Process, report::Row, rig::Rig};

/// Most memory of a program, in MB.
const MOST_MEMORY_MB: f64 = 150.0;

/// Most that all of them say on standard error in a minute, in bytes.
const MOST_SAID: f64 = 1e6;

/// Over a shorter time, in s, the rate is not judged: the start of anything is told in some lines.
const SHORTEST_S: f64 = 10.0;

/// What is taken from an instant on.
pub(super) struct Usage {
    begin: Instant,
    said: u64,
}

impl Usage {
    /// From now on.
    pub(super) fn begin(rig: &Rig) -> Self {
        for (_, process) in processes(rig) {
            process.take_peak_memory_mb();
        }
        Self { begin: Instant::now(), said: said_bytes(rig) }
    }

    /// What was taken beside an attack.
    pub(super) fn row(self, beside: &str, rig: &mut Rig) -> Row {
        let elapsed = self.begin.elapsed();
        let said = said_bytes(rig).saturating_sub(self.said);
        let mut parts = Vec::new();
        let minutes = elapsed.as_secs_f64().max(SHORTEST_S) / 60.0;
        let mut met = said as f64 <= MOST_SAID * minutes;
        for (name, process) in processes(rig) {
            if let Some(mb) = process.take_peak_memory_mb() {
                parts.push(format!("{name} {mb:.0} MB"));
                met &= mb <= MOST_MEMORY_MB;
            }
        }
        for (name, why) in ended(rig) {
            super::tell::tell(&format!("beside {beside}: the {name} has ended: {why}"));
            parts.push(format!("the {name} has **ended by itself**"));
            met = false;
        }
        parts.push(format!("{} in {:.0} s of logs", bytes(said), elapsed.as_secs_f64()));
        Row {
            what: format!("memory and logs beside {beside}"),
            required: "150 MB each, 1 MB a minute".to_owned(),
            measured: parts.join(", "),
            met,
        }
    }

    /// Since when.
    pub(super) fn elapsed(&self) -> Duration {
        self.begin.elapsed()
    }
}

fn processes(rig: &Rig) -> impl Iterator<Item = (&'static str, &Process)> {
    let all = [("drive", &rig.drive), ("cabinet", &rig.cabinet), ("twin", &rig.twin)];
    all.into_iter().filter_map(|(name, process)| Some((name, process.as_ref()?)))
}

fn said_bytes(rig: &Rig) -> u64 {
    processes(rig).map(|(_, process)| process.said_bytes()).sum()
}

/// Those that do not run any more, and the last that they said.
fn ended(rig: &mut Rig) -> Vec<(&'static str, String)> {
    let all = [("drive", &mut rig.drive), ("cabinet", &mut rig.cabinet), ("twin", &mut rig.twin)];
    let mut ended = Vec::new();
    for (name, process) in all {
        if let Some(process) = process
            && !process.runs()
        {
            ended.push((name, process.said()));
        }
    }
    ended
}

fn bytes(count: u64) -> String {
    let kb = count as f64 * 1e-3;
    if kb < 1000.0 { format!("{kb:.0} kB") } else { format!("{:.1} MB", kb * 1e-3) }
}
