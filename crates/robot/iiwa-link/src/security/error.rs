//! Key and address errors.

use std::{io, path::PathBuf};

/// Reason why a text is not a key.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum KeyTextError {
    /// A wrong number of characters.
    #[error("a key has 40 characters, found {found}")]
    Length {
        /// The number of characters.
        found: usize,
    },
    /// A character outside the Z85 alphabet.
    #[error("character {position} of the key is {character:?}, which is not one of Z85's")]
    Character {
        /// Position in the key, from 1.
        position: usize,
        /// The character.
        character: char,
    },
    /// A group of five characters whose value exceeds four bytes.
    #[error("characters {position} to {} of the key are out of range", .position + 4)]
    TooLarge {
        /// Position of its first character in the key, from 1.
        position: usize,
    },
}

/// Reason why keys or addresses cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SecurityError {
    /// A text that is not a public key.
    #[error("not a public key")]
    KeyText(#[from] KeyTextError),
    /// A name that is not allowed for key files.
    #[error(
        "`{}` is not a valid name of a key: use 1 to 64 letters, digits, -, _ and ., beginning \
         with a letter or a digit", .name.escape_debug()
    )]
    Name {
        /// The refused name.
        name: String,
    },
    /// A file or folder could not be read.
    #[error("cannot read {}", .path.display())]
    Read {
        /// Path of the file or folder.
        path: PathBuf,
        /// The system's error.
        #[source]
        source: io::Error,
    },
    /// A file or folder could not be written.
    #[error("cannot write {}", .path.display())]
    Write {
        /// Path of the file or folder.
        path: PathBuf,
        /// The system's error.
        #[source]
        source: io::Error,
    },
    /// A key file that already exists. Key files are never overwritten, because the key may be in
    /// use.
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
        /// Permissions of the file.
        mode: u32,
    },
    /// A key file with an invalid line.
    #[error("{}, line {line}: {message}", .path.display())]
    KeyLine {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The fault.
        message: String,
    },
    /// A file that is not a key file, or not of the required kind.
    #[error("{}: {message}", .path.display())]
    KeyFile {
        /// The file.
        path: PathBuf,
        /// The fault.
        message: &'static str,
    },
    /// A folder of client keys that does not contain any.
    #[error("no client can connect: {} contains no public key files (*.pub)", .path.display())]
    NoClientKeys {
        /// The folder.
        path: PathBuf,
    },
    /// A text that is not a supported address.
    #[error("`{}` is not an address: {message}", .text.escape_debug())]
    Address {
        /// The text.
        text: String,
        /// The fault.
        message: &'static str,
    },
    /// An attempt to bind an address that other machines can reach, without keys.
    #[error(
        "{endpoint} can be reached from other machines, so CURVE keys are required; without keys, \
         only loopback addresses are bound, such as tcp://127.0.0.1:5560"
    )]
    BindNeedsKeys {
        /// The address.
        endpoint: String,
    },
    /// An attempt to connect to another machine, without keys.
    #[error(
        "{endpoint} may be another machine, so CURVE keys are required; without keys, only \
         loopback addresses are connected to, such as tcp://127.0.0.1:5560"
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
