//! What the joints did, whatever file it was in.

use std::io::Read;

use crate::{Entry, ReadError, Reader};

/// Joint positions over time: what is left of a recording when all else is taken away.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct JointLog {
    /// Times, in s from any instant; they increase strictly.
    pub t_s: Vec<f64>,
    /// Joint positions at these times, in rad.
    pub q_rad: Vec<[f64; 7]>,
    /// The motion program that was run, if the recording has it: JSON.
    pub program: Option<String>,
    /// The robot's name, if the recording has it.
    pub robot: Option<String>,
}

impl JointLog {
    /// A log of these positions at these times.
    #[must_use]
    pub fn new(t_s: Vec<f64>, q_rad: Vec<[f64; 7]>) -> Self {
        Self { t_s, q_rad, ..Self::default() }
    }

    /// Reads an MCAP file.
    ///
    /// # Errors
    ///
    /// If it is none, or damaged.
    pub fn read_mcap<R: Read>(stream: R) -> Result<Self, ReadError> {
        let mut log = Self::default();
        for entry in Reader::new(stream) {
            match entry? {
                Entry::JointState(sample) => {
                    log.t_s.push(sample.t_s);
                    log.q_rad.push(sample.q);
                }
                Entry::Attachment(attachment) if attachment.name == "program.json" => {
                    log.program = String::from_utf8(attachment.bytes).ok();
                }
                Entry::Metadata { name, entries } if name == "iiwasim" => {
                    log.robot = entries.get("robot").cloned();
                }
                _ => {}
            }
        }
        Ok(log)
    }
}
