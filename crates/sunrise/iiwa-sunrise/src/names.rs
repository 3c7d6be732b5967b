//! Unique names for programs.

use std::collections::{BTreeMap, BTreeSet};

/// Entry whose name in programs differs from its name in the project.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Renamed {
    /// Path in the project.
    pub from: String,
    /// Name in programs.
    pub to: String,
    /// Reason.
    pub reason: &'static str,
}

/// Assigns a unique name to each entry of a list.
#[derive(Default)]
pub(crate) struct UniqueNames {
    used: BTreeSet<String>,
    /// Last number that was appended, by name.
    taken: BTreeMap<String, u32>,
    pub(crate) renamed: Vec<Renamed>,
}

impl UniqueNames {
    /// Creates an empty list without the names that are reserved in programs.
    pub(crate) fn without(reserved: &[&str]) -> Self {
        let used = reserved.iter().map(|name| (*name).to_owned()).collect();
        Self { used, ..Self::default() }
    }

    /// Returns the name for an `entry`, below `parent` if given; `from` is its path in
    /// the project.
    pub(crate) fn give(&mut self, parent: Option<&str>, entry: &str, from: &str) -> String {
        let plain = match entry {
            "" => "unnamed".to_owned(),
            name => name.replace('/', "_"),
        };
        let wanted = parent.map_or_else(|| plain.clone(), |parent| format!("{parent}/{plain}"));
        let mut given = wanted.clone();
        while self.used.contains(&given) {
            let count = self.taken.entry(wanted.clone()).or_insert(1);
            *count += 1;
            given = format!("{wanted}_{count}");
        }
        let why = if given != wanted {
            Some("the name is taken, or means something else in programs")
        } else if plain != entry {
            Some("a name has letters, and no `/` in it")
        } else {
            None
        };
        if let Some(why) = why {
            let (from, to) = (from.to_owned(), given.clone());
            self.renamed.push(Renamed { from, to, reason: why });
        }
        self.used.insert(given.clone());
        given
    }
}
