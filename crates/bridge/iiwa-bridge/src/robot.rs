//! The robots of a bridge.

use iiwa_link::{Client, LinkError, Remote, Stream};

use crate::BridgeError;

/// A robot whose data is passed on.
#[derive(Clone, Debug)]
pub struct BridgedRobot {
    name: String,
    remote: Remote,
    drive: String,
    stream: String,
}

impl BridgedRobot {
    /// A robot with a name of letters, digits, `-` and `_`, and the addresses of its drive for requests and of its
    /// stream, such as `tcp://127.0.0.1:5560` and `tcp://127.0.0.1:5561`.
    ///
    /// # Errors
    ///
    /// The name is empty, longer than 64 characters or has others than these: it is part of topics and the name of a folder.
    pub fn new(
        name: impl Into<String>,
        remote: Remote,
        drive: impl Into<String>,
        stream: impl Into<String>,
    ) -> Result<Self, BridgeError> {
        let name = name.into();
        // Without dots, no name is that of another folder, such as `..`.
        let fits = |letter: char| letter.is_ascii_alphanumeric() || "_-".contains(letter);
        if name.is_empty() || name.len() > 64 || !name.chars().all(fits) {
            return Err(BridgeError::RobotName { name });
        }
        Ok(Self { name, remote, drive: drive.into(), stream: stream.into() })
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The address of its drive.
    #[must_use]
    pub fn drive(&self) -> &str {
        &self.drive
    }

    /// A new client of its drive.
    ///
    /// # Errors
    ///
    /// The address is invalid, or requires keys.
    pub fn client(&self) -> Result<Client, LinkError> {
        Client::new(&self.remote, &self.drive)
    }

    /// A new subscription to its stream, with torques and runs.
    ///
    /// # Errors
    ///
    /// The address is invalid, or requires keys.
    pub fn stream(&self) -> Result<Stream, LinkError> {
        Stream::with_runs(&self.remote, &self.stream)
    }
}
