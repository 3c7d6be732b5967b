//! The clients that are let in.

use std::{collections::BTreeMap, path::Path};

use super::{PublicKey, SecurityError};

/// Public keys of the clients that are let in, each with a name. An empty list lets nobody in.
#[derive(Clone, Debug, Default)]
pub struct AllowList {
    names: BTreeMap<PublicKey, String>,
}

impl AllowList {
    /// Reads one file with a public key, or all files `*.pub` directly in a folder. A key is called
    /// by its file's name.
    ///
    /// # Errors
    /// A file cannot be read or is not one with a public key alone; the folder has none.
    pub fn read(path: &Path) -> Result<Self, SecurityError> {
        let refuse = |source| SecurityError::Read { path: path.to_owned(), source };
        if !path.metadata().map_err(refuse)?.is_dir() {
            return Ok(Self::from_iter([(name(path), PublicKey::read(path)?)]));
        }
        let mut files = Vec::new();
        for entry in path.read_dir().map_err(refuse)? {
            let file = entry.map_err(refuse)?.path();
            if file.extension().is_some_and(|extension| extension == "pub") {
                files.push(file);
            }
        }
        if files.is_empty() {
            return Err(SecurityError::NobodyAllowed { path: path.to_owned() });
        }
        // A key in two files has the name of the first one.
        files.sort_unstable();
        files.iter().map(|file| Ok((name(file), PublicKey::read(file)?))).collect()
    }

    /// The name of a key, if it is on the list.
    #[must_use]
    pub fn name(&self, key: &PublicKey) -> Option<&str> {
        self.names.get(key).map(String::as_str)
    }

    /// How many keys are on the list.
    #[must_use]
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// Whether nobody is let in.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }
}

impl FromIterator<(String, PublicKey)> for AllowList {
    fn from_iter<I: IntoIterator<Item = (String, PublicKey)>>(keys: I) -> Self {
        let mut names = BTreeMap::new();
        for (name, key) in keys {
            names.entry(key).or_insert(name);
        }
        Self { names }
    }
}

/// What a key is called by its file's name: it goes into logs and replies, so without control
/// characters.
fn name(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    stem.chars().map(|c| if c.is_control() { '?' } else { c }).take(64).collect()
}
