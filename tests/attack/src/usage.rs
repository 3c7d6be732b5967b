//! Memory and log volume of the programs.

use std::time::{Duration, Instant};

use super::{output::print, process::Process, report::Row, rig::Rig};

/// Upper bound on the memory per program, in MB.
const MAX_MEMORY_MB: f64 = 150.0;

/// Upper bound on the output of all programs on standard error, in bytes per minute.
const MAX_LOG_RATE: f64 = 1e6;

/// Shortest time over which the rate is computed, in s: each start is logged in some lines.
const SHORTEST_S: f64 = 10.0;

/// Memory and log volume since an instant.
pub(super) struct Usage {
    begin: Instant,
    logged: u64,
}

impl Usage {
    /// Begins the measurement.
    pub(super) fn begin(rig: &Rig) -> Self {
        for (_, process) in processes(rig) {
            process.take_peak_memory_mb();
        }
        Self { begin: Instant::now(), logged: logged_bytes(rig) }
    }

    /// Returns the row of an attack.
    pub(super) fn row(self, beside: &str, rig: &mut Rig) -> Row {
        let elapsed = self.begin.elapsed();
        let logged = logged_bytes(rig).saturating_sub(self.logged);
        let mut parts = Vec::new();
        let minutes = elapsed.as_secs_f64().max(SHORTEST_S) / 60.0;
        let mut met = logged as f64 <= MAX_LOG_RATE * minutes;
        for (name, process) in processes(rig) {
            if let Some(mb) = process.take_peak_memory_mb() {
                parts.push(format!("{name} {mb:.0} MB"));
                met &= mb <= MAX_MEMORY_MB;
            }
        }
        for (name, why) in ended(rig) {
            print(&format!("beside {beside}: the {name} has ended: {why}"));
            parts.push(format!("the {name} has **ended by itself**"));
            met = false;
        }
        parts.push(format!("{} in {:.0} s of logs", bytes(logged), elapsed.as_secs_f64()));
        Row {
            quantity: format!("memory and logs beside {beside}"),
            required: "150 MB each, 1 MB a minute".to_owned(),
            measured: parts.join(", "),
            met,
        }
    }

    /// Time since the beginning.
    pub(super) fn elapsed(&self) -> Duration {
        self.begin.elapsed()
    }
}

fn processes(rig: &Rig) -> impl Iterator<Item = (&'static str, &Process)> {
    let all = [("drive", &rig.drive), ("cabinet", &rig.cabinet), ("twin", &rig.twin)];
    all.into_iter().filter_map(|(name, process)| Some((name, process.as_ref()?)))
}

fn logged_bytes(rig: &Rig) -> u64 {
    processes(rig).map(|(_, process)| process.stderr_bytes()).sum()
}

/// Returns programs that have ended, and their output on standard error.
fn ended(rig: &mut Rig) -> Vec<(&'static str, String)> {
    let all = [("drive", &mut rig.drive), ("cabinet", &mut rig.cabinet), ("twin", &mut rig.twin)];
    let mut ended = Vec::new();
    for (name, process) in all {
        if let Some(process) = process
            && !process.runs()
        {
            ended.push((name, process.stderr()));
        }
    }
    ended
}

fn bytes(count: u64) -> String {
    let kb = count as f64 * 1e-3;
    if kb < 1000.0 { format!("{kb:.0} kB") } else { format!("{:.1} MB", kb * 1e-3) }
}
