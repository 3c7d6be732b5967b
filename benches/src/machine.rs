//! Machine of the measurements.

use std::{fs, process::Command};

/// Returns the instruction level that the crates use on this machine: they select it at run time.
#[must_use]
pub fn instruction_level() -> &'static str {
    match pulp::Arch::new() {
        #[cfg(target_arch = "x86_64")]
        pulp::Arch::V4(_) => "x86-64-v4",
        #[cfg(target_arch = "x86_64")]
        pulp::Arch::V3(_) => "x86-64-v3",
        _ if cfg!(target_arch = "x86_64") => "x86-64",
        _ => std::env::consts::ARCH,
    }
}

/// Returns the first line that a program prints with `--version`; `none` without the program.
#[must_use]
pub fn version(program: &str) -> String {
    let output = Command::new(program).arg("--version").output();
    let text = output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    text.ok().and_then(|text| text.lines().next().map(str::to_owned)).unwrap_or("none".to_owned())
}

/// Returns the name of the processor and its number of threads.
#[must_use]
pub fn processor() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |name: &str| {
        let line = info.lines().find(|line| line.starts_with(name));
        line.and_then(|line| line.split_once(':')).map_or("unknown", |(_, value)| value.trim())
    };
    let threads = std::thread::available_parallelism().map_or(1, Into::into);
    format!(
        "{} (family {}, model {}), {threads} threads",
        field("model name"),
        field("cpu family"),
        field("model\t")
    )
}

/// Returns the peak memory of this process so far, in MB of 10^6 bytes.
///
/// # Errors
///
/// An error if the system does not report it.
pub fn peak_memory_mb() -> super::Result<f64> {
    let status = fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|line| line.trim().strip_suffix("kB")).ok_or("no VmHWM")?;
    Ok(kib.trim().parse::<f64>()? * 1024.0 * 1e-6)
}
