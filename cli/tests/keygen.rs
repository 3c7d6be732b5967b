//! `iiwasim keygen` as a process.

use std::fs;

use iiwa_link::security::{KeyPair, PublicKey, SecurityError};
use predicates::{
    prelude::PredicateBooleanExt,
    str::{contains, is_empty},
};
use tempfile::tempdir;

use crate::run::{files, iiwasim};

#[test]
fn writes_two_files_that_belong_together() {
    let folder = tempdir().unwrap();
    let run = iiwasim(&folder, &["keygen", "alice"]);
    run.success()
        .stdout(contains("alice.key: secret").and(contains("--allow clients/")))
        .stdout(contains("--key alice.key --server-key drive.pub"))
        .stderr(is_empty());
    assert_eq!(files(&folder), ["alice.key", "alice.pub"]);
    let pair = KeyPair::read(&folder.path().join("alice.key")).unwrap();
    assert_eq!(PublicKey::read(&folder.path().join("alice.pub")).unwrap(), pair.public());
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        let mode = fs::metadata(folder.path().join("alice.key")).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
    }
}

#[test]
fn never_overwrites() {
    for (existing, name) in [("drive.key", "drive"), ("drive.pub", "drive")] {
        let folder = tempdir().unwrap();
        fs::write(folder.path().join(existing), "mine").unwrap();
        iiwasim(&folder, &["keygen", name])
            .code(2)
            .stdout(is_empty())
            .stderr(contains(existing).and(contains("not overwritten")));
        assert_eq!(files(&folder), [existing]);
        assert_eq!(fs::read_to_string(folder.path().join(existing)).unwrap(), "mine");
    }
}

#[test]
fn makes_its_folder_and_refuses_odd_names() {
    let folder = tempdir().unwrap();
    iiwasim(&folder, &["keygen", "bob", "-o", "keys/clients"])
        .success()
        .stdout(contains("keys/clients/bob.pub"));
    assert!(matches!(
        PublicKey::read(&folder.path().join("keys/clients/bob.key")),
        Err(SecurityError::KeyFile { .. })
    ));
    for name in ["", "a/b", "../a", ".a", "a b", "a\nb"] {
        iiwasim(&folder, &["keygen", name]).code(2).stdout(is_empty());
    }
    fs::write(folder.path().join("file"), "").unwrap();
    iiwasim(&folder, &["keygen", "bob", "-o", "file"]).code(1).stderr(contains("file"));
    assert_eq!(files(&folder), ["file", "keys"]);
}
