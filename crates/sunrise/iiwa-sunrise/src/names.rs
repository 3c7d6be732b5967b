//! Names that programs can use.

use std::collections::{BTreeMap, BTreeSet};

/// An entry that has another name in programs than in its project.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Renamed {
    /// Its path in the project.
    pub from: String,
    /// Its name in programs.
    pub to: String,
    /// Why.
    pub why: &'static str,
}

/// Gives each entry of a list a name of its own.
#[derive(Default)]
pub(crate) struct Names {
    used: BTreeSet<String>,
    /// How often a name was asked for that was taken.
    taken: BTreeMap<String, u32>,
    pub(crate) renamed: Vec<Renamed>,
}

impl Names {
    /// Without those that mean something else in programs.
    pub(crate) fn without(reserved: &[&str]) -> Self {
        let used = reserved.iter().map(|name| (*name).to_owned()).collect();
        Self { used, ..Self::default() }
    }

    /// The name for the entry called `own`, below `parent` if that is given, whose path in the project is `from`.
    pub(crate) fn give(&mut self, parent: Option<&str>, own: &str, from: &str) -> String {
        let plain = match own {
            "" => "unnamed".to_owned(),
            own => own.replace('/', "_"),
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
        } else if plain != own {
            Some("a name has letters, and no `/` in it")
        } else {
            None
        };
        if let Some(why) = why {
            let (from, to) = (from.to_owned(), given.clone());
            self.renamed.push(Renamed { from, to, why });
        }
        self.used.insert(given.clone());
        given
    }
}
