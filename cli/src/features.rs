//! Cargo features of this build: their commands, and instructions to add a missing one.

use clap::error::{ContextKind, ContextValue, ErrorKind};

use crate::failure::Failure;

/// Optional part of the command.
pub(crate) struct Feature {
    name: &'static str,
    is_enabled: bool,
    commands: &'static [&'static str],
}

pub(crate) const SUNRISE: Feature =
    Feature::new("sunrise", cfg!(feature = "sunrise"), &["import", "export"]);
const OPTIMISE: Feature =
    Feature::new("optimise", cfg!(feature = "optimise"), &["advise", "optimise", "order", "place"]);
pub(crate) const PICTURES: Feature = Feature::new("pictures", cfg!(feature = "pictures"), &[]);
pub(crate) const PARQUET: Feature = Feature::new("parquet", cfg!(feature = "parquet"), &[]);
pub(crate) const BRIDGE: Feature =
    Feature::new("bridge", cfg!(feature = "bridge"), &["bridge", "replay", "history"]);

const LIVE: &[&str] = &[
    "run",
    "experiment",
    "twin",
    "record",
    "status",
    "stop",
    "io",
    "sensors",
    "drive",
    "cabinet",
    "keygen",
];

const FEATURES: [Feature; 8] = [
    Feature::new("live", cfg!(feature = "live"), LIVE),
    SUNRISE,
    OPTIMISE,
    PICTURES,
    PARQUET,
    BRIDGE,
    Feature::new("ros2", cfg!(feature = "ros2"), &[]),
    Feature::new("opcua", cfg!(feature = "opcua"), &[]),
];

impl Feature {
    const fn new(name: &'static str, is_enabled: bool, commands: &'static [&str]) -> Self {
        Self { name, is_enabled, commands }
    }

    /// Fails with instructions if this build lacks the feature; `used` is the option or value that
    /// needs it.
    pub(crate) fn require(&self, used: &str) -> Result<(), Failure> {
        if self.is_enabled { Ok(()) } else { Err(self.missing(used)) }
    }

    /// Returns the failure of `used`, an option or value that needs this missing feature.
    pub(crate) fn missing(&self, used: &str) -> Failure {
        Failure::input(self.instructions(used))
    }

    fn instructions(&self, used: &str) -> String {
        let name = self.name;
        format!(
            "{used} needs the feature `{name}`, which this build lacks: \
             cargo install --locked --path cli --features {name} (or full)"
        )
    }
}

/// Returns version, commit, and features.
pub(crate) fn version() -> String {
    let enabled: Vec<_> = FEATURES.iter().filter(|it| it.is_enabled).map(|it| it.name).collect();
    let keys = if cfg!(feature = "live") { ", with CURVE" } else { "" };
    let names = if enabled.is_empty() { "none".to_owned() } else { enabled.join(", ") };
    let version = concat!(env!("CARGO_PKG_VERSION"), env!("IIWASIM_BUILD"));
    format!("{version}{keys}; features: {names}")
}

/// Returns the section of the help that lists the commands of missing features.
pub(crate) fn missing_commands() -> Option<String> {
    let missing = FEATURES.iter().filter(|it| !it.is_enabled && !it.commands.is_empty());
    let lines: Vec<_> =
        missing.map(|it| format!("  {}: feature `{}`", it.commands.join(", "), it.name)).collect();
    let title = "Not in this build (cargo install --locked --path cli --features NAME adds them)";
    (!lines.is_empty()).then(|| format!("{title}:\n{}", lines.join("\n")))
}

/// Explains how to add the feature if the unknown command of an error belongs to a missing feature.
pub(crate) fn explain(error: clap::Error) -> clap::Error {
    let Some(ContextValue::String(command)) = error.get(ContextKind::InvalidSubcommand) else {
        return error;
    };
    let is_missing = |it: &&Feature| !it.is_enabled && it.commands.contains(&command.as_str());
    match FEATURES.iter().find(is_missing) {
        Some(feature) => clap::Error::raw(
            ErrorKind::InvalidSubcommand,
            format!("{}\n", feature.instructions(&format!("`iiwasim {command}`"))),
        ),
        None => error,
    }
}
