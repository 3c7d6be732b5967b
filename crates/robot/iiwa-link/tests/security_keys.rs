//! Keys as text and in files.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{fs, path::Path};

use iiwa_link::security::{AllowList, KeyPair, KeyTextError, PublicKey, SecurityError};
use proptest::prelude::*;
use tempfile::tempdir;

/// Test vectors of the CURVE documentation (`zmq_curve`), cross-validated against libzmq's Z85 in
/// `tests/peers`.
const PUBLIC: &str = "rq:rM>}U?@Lns47E1%kR.o@n%FcmmsL/@{H8]yf7";
const SECRET: &str = "D:)Q[IlAW!ahhC2ac:9*A}h:p?([4%wOTJ%JR%cs";

#[test]
fn text_is_as_it_was_read() {
    let key: PublicKey = PUBLIC.parse().unwrap();
    assert_eq!(key.to_string(), PUBLIC);
    assert_eq!(format!("{key:?}"), format!("PublicKey({PUBLIC})"));
}

proptest! {
    #[test]
    fn text_round_trip(bytes: [u8; 32]) {
        let key = PublicKey::from(bytes);
        let text = key.to_string();
        prop_assert_eq!(text.parse::<PublicKey>().unwrap(), key);
    }

    #[test]
    fn any_text_is_a_key_or_an_error(text in ".{0,60}") {
        if let Ok(key) = text.parse::<PublicKey>() {
            prop_assert_eq!(key.to_string(), text);
        }
    }

    #[test]
    fn any_file_is_a_key_or_an_error(
        text in "(?s)(public-key|secret-key|curve|[ =\"#\n]|.){0,40}",
    ) {
        let folder = tempdir().unwrap();
        let path = folder.path().join("x.pub");
        fs::write(&path, text).unwrap();
        let _ = (PublicKey::read(&path), KeyPair::read(&path));
    }
}

#[test]
fn invalid_keys_are_refused() {
    let parse = |text: &str| text.parse::<PublicKey>().unwrap_err();
    assert_eq!(parse(&PUBLIC[1..]), KeyTextError::Length { found: 39 });
    assert_eq!(parse(""), KeyTextError::Length { found: 0 });
    let spoiled = PUBLIC.replacen('M', "~", 1);
    assert_eq!(parse(&spoiled), KeyTextError::Character { position: 5, character: '~' });
    let umlaut = PUBLIC.replacen('M', "ä", 1);
    assert_eq!(parse(&umlaut), KeyTextError::Character { position: 5, character: 'ä' });
    let large = format!("{}#####{}", &PUBLIC[..5], &PUBLIC[10..]);
    assert_eq!(parse(&large), KeyTextError::TooLarge { position: 6 });
}

fn write(path: &Path, text: &str, mode: u32) {
    fs::write(path, text).unwrap();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
    }
}

fn key_file() -> String {
    format!("# note\ncurve\n    public-key = \"{PUBLIC}\"\n    secret-key = \"{SECRET}\"\n")
}

#[test]
fn files_round_trip() {
    let folder = tempdir().unwrap();
    let first = folder.path().join("first.key");
    write(&first, &key_file(), 0o600);
    let pair = KeyPair::read(&first).unwrap();
    assert_eq!(pair.public().to_string(), PUBLIC);
    assert!(!format!("{pair:?}").contains(SECRET), "the secret is not printed");

    let (key, public) = pair.write(folder.path(), "alice").unwrap();
    assert_eq!(key, folder.path().join("alice.key"));
    assert_eq!(public, folder.path().join("alice.pub"));
    assert!(fs::read_to_string(&key).unwrap().contains(SECRET));
    assert!(!fs::read_to_string(&public).unwrap().contains(SECRET));
    assert_eq!(KeyPair::read(&key).unwrap().public(), pair.public());
    assert_eq!(PublicKey::read(&public).unwrap(), pair.public());

    let before = fs::read(&key).unwrap();
    assert!(matches!(pair.write(folder.path(), "alice"), Err(SecurityError::Exists { .. })));
    fs::remove_file(&key).unwrap();
    assert!(matches!(pair.write(folder.path(), "alice"), Err(SecurityError::Exists { .. })));
    assert!(!key.exists(), "both or none");
    assert!(before.starts_with(b"# SECRET"));
    for name in ["", "..", "a/b", "-a", "a\0"] {
        assert!(matches!(pair.write(folder.path(), name), Err(SecurityError::Name { .. })));
    }
    let nowhere = folder.path().join("nowhere");
    assert!(matches!(pair.write(&nowhere, "a"), Err(SecurityError::Write { .. })));
}

#[test]
fn reads_certificates_of_pyzmq() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("x.key_secret");
    let text = format!(
        "#   ****  Generated on 2024-01-01 by pyzmq  ****\n\nmetadata\n    name = \
         \"x\"\ncurve\n    public-key = \"{PUBLIC}\"\n    secret-key = \"{SECRET}\"\n"
    );
    write(&path, &text, 0o600);
    assert_eq!(KeyPair::read(&path).unwrap().public().to_string(), PUBLIC);
}

#[cfg(unix)]
#[test]
fn secret_keys_accessible_to_others_are_refused() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.key");
    for mode in [0o644, 0o640, 0o604, 0o620] {
        write(&path, &key_file(), mode);
        let error = KeyPair::read(&path).unwrap_err();
        assert!(matches!(error, SecurityError::Exposed { .. }), "{error}");
        assert!(error.to_string().contains("a.key") && error.to_string().contains("chmod 600"));
    }
    write(&path, &key_file(), 0o400);
    KeyPair::read(&path).unwrap();
}

#[test]
fn errors_name_the_line() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("a.key");
    let cases = [
        (key_file().replace("public-key", "public"), ", line 3: expected"),
        (key_file().replace("secret-key = ", "secret-key "), ", line 4: expected"),
        (key_file().replace(SECRET, &SECRET[1..]), ", line 4: a key has 40 characters, found 39"),
        (
            key_file().replace("IlAW", "Il~W"),
            ", line 4: character 8 of the key is not one of Z85's",
        ),
        (key_file().replace('"', ""), ", line 3: a key has to be in double quotes"),
        (format!("{}{}", key_file(), key_file()), ", line 7: a second key"),
        (String::new(), "not a key file"),
        ("\u{0}ELF\n".to_owned(), ", line 1: expected"),
    ];
    for (text, expected) in cases {
        write(&path, &text, 0o600);
        let error = KeyPair::read(&path).unwrap_err().to_string();
        assert!(error.contains("a.key") && error.contains(expected), "{error}");
        assert!(!error.contains("Il~W"), "no part of a secret is printed");
    }
    fs::write(&path, [0xff, 0xfe]).unwrap();
    assert!(KeyPair::read(&path).unwrap_err().to_string().contains("not text"));
    let missing = KeyPair::read(&folder.path().join("b.key")).unwrap_err();
    assert!(matches!(missing, SecurityError::Read { .. }));
    let secret = format!("secret-key = \"{SECRET}\"\n");
    write(&path, &secret, 0o600);
    assert!(KeyPair::read(&path).unwrap_err().to_string().contains("public-key"));
}

#[test]
fn allow_list_is_a_file_or_a_folder() {
    let folder = tempdir().unwrap();
    let clients = folder.path().join("clients");
    fs::create_dir(&clients).unwrap();
    let error = AllowList::read(&clients).unwrap_err();
    assert!(matches!(error, SecurityError::NoClientKeys { .. }), "{error}");

    let (alice, bob) = (PublicKey::from([1; 32]), PublicKey::from([2; 32]));
    let line = |key: PublicKey| format!("public-key = \"{key}\"\n");
    fs::write(clients.join("alice.pub"), line(alice)).unwrap();
    fs::write(clients.join("bob.pub"), line(bob)).unwrap();
    fs::write(clients.join("bob2.pub"), line(bob)).unwrap();
    fs::write(clients.join("README"), "not a key").unwrap();
    let list = AllowList::read(&clients).unwrap();
    assert_eq!((list.len(), list.is_empty()), (2, false));
    assert_eq!((list.name(&alice), list.name(&bob)), (Some("alice"), Some("bob")));
    assert_eq!(list.name(&PublicKey::from([3; 32])), None);

    let one = AllowList::read(&clients.join("bob.pub")).unwrap();
    assert_eq!((one.name(&alice), one.name(&bob)), (None, Some("bob")));

    write(&clients.join("carol.pub"), &key_file(), 0o600);
    let error = AllowList::read(&clients).unwrap_err().to_string();
    assert!(error.contains("carol.pub") && error.contains("secret key"), "{error}");
    assert!(matches!(AllowList::read(&folder.path().join("no")), Err(SecurityError::Read { .. })));
}
