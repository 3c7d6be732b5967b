//! What can go wrong with keys and addresses.

use std::{io, path::PathBuf};

/// Why a text is not a key.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum KeyTextError {
    /// Too long or too short.
    #[error("a key has 40 characters, found {found}")]
    Length {
        /// How many characters there are.
        found: usize,
    },
    /// A character that Z85 does not know.
    #[error("character {position} of the key is {character:?}, which is not one of Z85's")]
    Character {
        /// Its place in the key, from 1.
        position: usize,
        /// The character.
        character: char,
    },
    /// Five characters that stand for more than four bytes hold.
    #[error("characters {position} to {} of the key stand for no four bytes", .position + 4)]
    TooLarge {
        /// Place of the first of them in the key, from 1.
        position: usize,
    },
}

/// Why something cannot be guarded by keys, or must not be done without them.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SecurityError {
    /// A text that is not a public key.
    #[error("not a public key")]
    KeyText(#[from] KeyTextError),
    /// A name that key files cannot have.
    #[error(
        "`{}` is no name for a key: 1 to 64 letters, digits, -, _ and ., beginning with a letter \
         or a digit", .name.escape_debug()
    )]
    Name {
        /// The refused name.
        name: String,
    },
    /// A file or folder could not be read.
    #[error("cannot read {}", .path.display())]
    Read {
        /// Which one.
        path: PathBuf,
        /// What the system says.
        #[source]
        source: io::Error,
    },
    /// A file or folder could not be written.
    #[error("cannot write {}", .path.display())]
    Write {
        /// Which one.
        path: PathBuf,
        /// What the system says.
        #[source]
        source: io::Error,
    },
    /// A key file that is there already. It is never overwritten: its key may be in use.
    #[error("{} exists already and is not overwritten", .path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// A file with a secret key that others may read.
    #[error(
        "{} holds a secret key and others may read it (mode {mode:04o}): `chmod 600` it, and if \
         somebody may have read it, make a new one", .path.display()
    )]
    Exposed {
        /// The file.
        path: PathBuf,
        /// Its permissions.
        mode: u32,
    },
    /// A key file with a line that does not belong there.
    #[error("{}, line {line}: {what}", .path.display())]
    KeyLine {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        what: String,
    },
    /// A file that is no key file, or not the right one.
    #[error("{}: {what}", .path.display())]
    KeyFile {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: &'static str,
    },
    /// A folder of clients' keys without any: nobody could connect.
    #[error(
        "no file *.pub in {}: nobody could connect. Put the clients' public keys there, which \
         `iiwasim keygen` makes", .path.display()
    )]
    NobodyAllowed {
        /// The folder.
        path: PathBuf,
    },
    /// A text that is not an address, or one of a kind that is not used.
    #[error("`{}` is not an address: {what}", .text.escape_debug())]
    Address {
        /// The text.
        text: String,
        /// What is wrong.
        what: &'static str,
    },
    /// An address that other machines reach, without keys.
    #[error(
        "{endpoint} can be reached from other machines, so keys are needed: make them with \
         `iiwasim keygen drive`, then give --key drive.key and --allow with the clients' .pub \
         files. Without keys, only loopback addresses are bound, such as tcp://127.0.0.1:5560"
    )]
    BindNeedsKeys {
        /// The address.
        endpoint: String,
    },
    /// An address on another machine, without keys.
    #[error(
        "{endpoint} may be another machine, so keys are needed: make them with `iiwasim keygen \
         NAME`, then give --key NAME.key and --server-key (a drive: --cabinet-key) with the other \
         side's .pub file. Without keys, only loopback addresses are used, such as tcp://127.0.0.1:5560"
    )]
    ConnectNeedsKeys {
        /// The address.
        endpoint: String,
    },
    /// The system has no random numbers.
    #[error("cannot make keys")]
    Random {
        /// What the system says.
        #[source]
        source: getrandom::Error,
    },
}
