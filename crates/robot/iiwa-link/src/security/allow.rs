//! The list of permitted clients.

use std::{collections::BTreeMap, path::Path};

use super::{error::SecurityError, key::PublicKey};

/// Public keys of the permitted clients, each with a name. An empty list does not permit any
/// client.
///
/// ```
/// use iiwa_link::security::{AllowList, KeyPair};
///
/// let alice = KeyPair::generate()?.public();
/// let list = AllowList::from_iter([("alice".to_owned(), alice)]);
/// assert_eq!(list.name(&alice), Some("alice"));
/// assert_eq!(list.name(&KeyPair::generate()?.public()), None);
/// # Ok::<(), iiwa_link::security::SecurityError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct AllowList {
    names: BTreeMap<PublicKey, String>,
}

impl AllowList {
    /// Reads one public key file, or all files `*.pub` directly in a folder. The name of a key is
    /// its file name without extension.
    ///
    /// # Errors
    /// A file cannot be read or is not a public key file; the folder does not contain any.
    pub fn read(path: &Path) -> Result<Self, SecurityError> {
        let to_error = |source| SecurityError::Read { path: path.to_owned(), source };
        if !path.metadata().map_err(to_error)?.is_dir() {
            return Ok(Self::from_iter([(name(path), PublicKey::read(path)?)]));
        }
        let mut files = Vec::new();
        for entry in path.read_dir().map_err(to_error)? {
            let file = entry.map_err(to_error)?.path();
            if file.extension().is_some_and(|extension| extension == "pub") {
                files.push(file);
            }
        }
        if files.is_empty() {
            return Err(SecurityError::NoClientKeys { path: path.to_owned() });
        }
        // A key in two files has the name of the first file.
        files.sort_unstable();
        files.iter().map(|file| Ok((name(file), PublicKey::read(file)?))).collect()
    }

    /// Returns the name of a key, if it is on the list.
    #[must_use]
    pub fn name(&self, key: &PublicKey) -> Option<&str> {
        self.names.get(key).map(String::as_str)
    }

    /// Returns the number of keys.
    #[must_use]
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// Returns true if the list is empty.
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

/// Returns the name of a key from its file name, without control characters, because it is logged.
fn name(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    stem.chars().map(|c| if c.is_control() { '?' } else { c }).take(64).collect()
}
