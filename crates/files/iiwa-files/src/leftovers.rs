//! Temporary files of killed processes, distinguished by their locks from files in use.
//!
//! Temporary files and folders are locked as long as their process runs; the operating system
//! releases the lock however the process ends. A file with such a name and without a lock is a
//! leftover.

use std::{
    collections::HashSet,
    fs::{self, File},
    io,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

/// Naming of temporary files or folders.
#[derive(Clone, Copy, Debug)]
pub struct TemporaryName {
    /// Common prefix of the names.
    pub prefix: &'static str,
    /// Common suffix of the names.
    pub suffix: &'static str,
    /// `true` for folders.
    pub is_folder: bool,
}

impl TemporaryName {
    /// Creates a temporary file or folder with `make`; no other process removes it as long as the
    /// lock is open. Removes leftovers with the same naming from the folder.
    ///
    /// Another process may remove the new file as a leftover before it is locked: then `make` runs
    /// again.
    ///
    /// # Errors
    ///
    /// The error of `make`.
    pub fn make<T>(
        self,
        folder: &Path,
        mut make: impl FnMut(&mut tempfile::Builder<'_, '_>) -> io::Result<T>,
        path: impl Fn(&T) -> &Path,
    ) -> io::Result<(T, Option<File>)> {
        self.clear(folder);
        loop {
            let created = make(tempfile::Builder::new().prefix(self.prefix).suffix(self.suffix))?;
            // On file systems without locks, leftovers are not removed.
            let lock = File::open(path(&created)).and_then(|file| file.lock().map(|()| file)).ok();
            if path(&created).symlink_metadata().is_ok() {
                return Ok((created, lock));
            }
        }
    }

    /// Removes the leftovers in a folder, once per process and folder.
    fn clear(self, folder: &Path) {
        static CLEARED: Mutex<Option<HashSet<PathBuf>>> = Mutex::new(None);
        {
            let mut cleared = CLEARED.lock().unwrap_or_else(PoisonError::into_inner);
            if !cleared.get_or_insert_default().insert(folder.join(self.prefix)) {
                return;
            }
        }
        // Leftovers that cannot be read or removed do no harm.
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            if name.starts_with(self.prefix) && name.ends_with(self.suffix) {
                self.remove_unless_used(&entry.path());
            }
        }
    }

    fn remove_unless_used(self, path: &Path) {
        let is_mine = path
            .symlink_metadata()
            .is_ok_and(|kind| if self.is_folder { kind.is_dir() } else { kind.is_file() });
        if !is_mine {
            return;
        }
        let Ok(file) = File::open(path) else { return };
        if file.try_lock().is_ok() {
            let _ = if self.is_folder { fs::remove_dir_all(path) } else { fs::remove_file(path) };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAME: TemporaryName =
        TemporaryName { prefix: ".part-of-a-test-", suffix: ".part", is_folder: false };

    #[test]
    fn files_in_use_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let (used, abandoned, other) =
            (at(".part-of-a-test-1.part"), at(".part-of-a-test-2.part"), at("part.part"));
        for path in [&used, &abandoned, &other] {
            fs::write(path, "text").unwrap();
        }
        fs::create_dir(at(".part-of-a-test-3.part")).unwrap();
        let lock = File::open(&used).unwrap();
        lock.lock().unwrap();
        let make = || {
            let make = |name: &mut tempfile::Builder<'_, '_>| name.tempfile_in(folder.path());
            NAME.make(folder.path(), make, tempfile::NamedTempFile::path).unwrap()
        };
        let (created, created_lock) = make();
        assert!(!abandoned.exists() && used.exists() && other.exists());
        assert!(at(".part-of-a-test-3.part").exists());
        // Acts like the next process.
        drop(lock);
        NAME.remove_unless_used(created.path());
        NAME.remove_unless_used(&used);
        assert!(created.path().exists() && !used.exists());
        drop(created_lock);
        NAME.remove_unless_used(created.path());
        assert!(!created.path().exists());
    }
}
