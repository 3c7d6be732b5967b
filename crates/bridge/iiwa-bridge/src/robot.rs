//! Robots of a bridge.

use iiwa_link::{Client, LinkError, Remote, Stream};

use crate::BridgeError;

/// A robot whose data is forwarded.
#[derive(Clone, Debug)]
pub struct BridgedRobot {
    name: String,
    remote: Remote,
    drive: String,
    stream: String,
}

impl BridgedRobot {
    /// Creates a robot with a name of letters, digits, `-` and `_`, and the addresses of its drive
    /// for requests and of its stream, such as `tcp://127.0.0.1:5560` and `tcp://127.0.0.1:5561`.
    ///
    /// # Errors
    ///
    /// The name is empty, longer than 64 characters or contains other characters: it is part of
    /// topics and a folder name.
    pub fn new(
        name: impl Into<String>,
        remote: Remote,
        drive: impl Into<String>,
        stream: impl Into<String>,
    ) -> Result<Self, BridgeError> {
        let name = name.into();
        // Without dots, a name cannot refer to another folder, such as `..`.
        let fits = |letter: char| letter.is_ascii_alphanumeric() || "_-".contains(letter);
        if name.is_empty() || name.len() > 64 || !name.chars().all(fits) {
            return Err(BridgeError::RobotName { name });
        }
        Ok(Self { name, remote, drive: drive.into(), stream: stream.into() })
    }

    /// Returns the name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the address of the drive.
    #[must_use]
    pub fn drive(&self) -> &str {
        &self.drive
    }

    /// Creates a client of the drive.
    ///
    /// # Errors
    ///
    /// The address is invalid, or requires keys.
    pub fn client(&self) -> Result<Client, LinkError> {
        Client::new(&self.remote, &self.drive)
    }

    /// Creates a subscription to the stream, with torques and runs.
    ///
    /// # Errors
    ///
    /// The address is invalid, or requires keys.
    pub fn stream(&self) -> Result<Stream, LinkError> {
        Stream::with_runs(&self.remote, &self.stream)
    }
}
