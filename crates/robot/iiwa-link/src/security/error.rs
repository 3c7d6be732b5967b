//! Errors of keys and addresses.

use std::{io, path::PathBuf};

/// Why a text is not a key.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum KeyTextError {
    /// A wrong number of characters.
    #[error("a key has 40 characters, found {found}")]
    Length {
        /// The number of characters.
        found: usize,
    },
    /// A character that is not one of Z85.
    #[error("character {position} of the key is {character:?}, which is not one of Z85's")]
    Character {
        /// Its position in the key, from 1.
        position: usize,
        /// The character.
        character: char,
    },
    /// A group of five characters whose value exceeds four bytes.
    #[error("characters {position} to {} of the key are out of range", .position + 4)]
    TooLarge {
        /// Position of the first of them in the key, from 1.
        position: usize,
    },
}

/// Why keys or addresses cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SecurityError {
    /// A text that is not a public key.
    #[error("not a public key")]
    KeyText(#[from] KeyTextError),
    /// A name that is not allowed for key files.
    #[error(
        "`{}` is not a valid name of a key: use 1 to 64 letters, digits, -, _ and ., beginning with \
         a letter or a digit", .name.escape_debug()
    )]
    Name {
        /// The refused name.
        name: String,
    },
    /// A file or folder could not be read.
    #[error("cannot read {}", .path.display())]
    Read {
        /// Its path.
        path: PathBuf,
        /// The system's error.
        #[source]
        source: io::Error,
    },
    /// A file or folder could not be written.
    #[error("cannot write {}", .path.display())]
    Write {
        /// Its path.
        path: PathBuf,
        /// The system's error.
        #[source]
        source: io::Error,
    },
    /// A key file that exists already. It is never overwritten: its key may be in use.
    #[error("{} exists already and is not overwritten", .path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// A secret key file that other users may access.
    #[error(
        "{} contains a secret key and is accessible to other users (mode {mode:04o}): `chmod 600` \
         it, and replace the key if it may have been read", .path.display()
    )]
    Exposed {
        /// The file.
        path: PathBuf,
        /// Its permissions.
        mode: u32,
    },
    /// A key file with an invalid line.
    #[error("{}, line {line}: {what}", .path.display())]
    KeyLine {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The fault.
        what: String,
    },
    /// A file that is not a key file, or not of the required kind.
    #[error("{}: {what}", .path.display())]
    KeyFile {
        /// The file.
        path: PathBuf,
        /// The fault.
        what: &'static str,
    },
    /// A folder of clients' keys without any.
    #[error("no client can connect: {} contains no public key files (*.pub)", .path.display())]
    NoClientKeys {
        /// The folder.
        path: PathBuf,
    },
    /// A text that is not a supported address.
    #[error("`{}` is not an address: {what}", .text.escape_debug())]
    Address {
        /// The text.
        text: String,
        /// The fault.
        what: &'static str,
    },
    /// Binding an address that other machines can reach, without keys.
    #[error(
        "{endpoint} can be reached from other machines, so CURVE keys are required; without keys, \
         only loopback addresses are bound, such as tcp://127.0.0.1:5560"
    )]
    BindNeedsKeys {
        /// The address.
        endpoint: String,
    },
    /// Connecting to another machine, without keys.
    #[error(
        "{endpoint} may be another machine, so CURVE keys are required; without keys, only loopback \
         addresses are connected to, such as tcp://127.0.0.1:5560"
    )]
    ConnectNeedsKeys {
        /// The address.
        endpoint: String,
    },
    /// The system's random number generator has failed.
    #[error("the system provides no random numbers")]
    Random {
        /// The system's error.
        #[source]
        source: getrandom::Error,
    },
}
