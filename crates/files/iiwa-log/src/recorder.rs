//! Recording what the robot does, as it happens.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Cursor;
use std::path::Path;
use std::time::Duration;

use iiwa_kin::{Joints, Robot};

use crate::arm::Arm;
use crate::storage::Storage;
use crate::tail::Index;
use crate::whole_file::{WholeFile, header_is_torn};
use crate::{Config, Diagnostic, Topic, WriteError, Writer};

/// How a recording is made.
#[derive(Clone, Debug)]
pub struct RecorderConfig {
    /// How much of the motion may be missing when the program is killed. The file gets a chunk
    /// that often.
    pub period: Duration,
    /// The most messages a second on `/tf` and `/tcp_pose`, which follow from the joint positions
    /// and are there for viewers. Zero for none.
    pub pose_rate_hz: u32,
    /// How the file is written.
    pub file: Config,
}

impl Default for RecorderConfig {
    /// A second, and 100 poses a second.
    fn default() -> Self {
        Self { period: Duration::from_secs(1), pose_rate_hz: 100, file: Config::default() }
    }
}

/// What the name of the writing program ends with, in the header of a recording.
const RECORDS: &str = " recorder";

/// Whether a file that begins with `head` is an MCAP file that no plan was written into: a [`Recorder`]'s, or another program's.
#[must_use]
pub fn is_recording(head: &[u8]) -> bool {
    // The magic bytes, the header's opcode and length, then two texts with their lengths: profile and library.
    let text = |bytes: &[u8]| -> Option<(usize, String)> {
        let length = u32::from_le_bytes(bytes.get(..4)?.try_into().ok()?) as usize;
        let text = bytes.get(4..4_usize.checked_add(length)?)?;
        Some((4 + length, String::from_utf8_lossy(text).into_owned()))
    };
    let library = head.get(17..).and_then(|header| {
        let (length, _profile) = text(header)?;
        Some(text(&header[length..])?.1)
    });
    library.is_none_or(|library| !library.starts_with("iiwa-log/") || library.ends_with(RECORDS))
}

/// The checksum of a data section that is not complete: none.
const NO_CRC: u32 = 0;

/// Writes joint positions into an MCAP file as they come in, for hours and up to 1 kHz.
///
/// The file is whole and indexed at every moment: a program that is killed loses at most the last
/// [`period`](RecorderConfig::period) and the sample after it. (Not so when the machine loses its
/// power: nothing waits for the disk.) What a reader sees that has the file open meanwhile is not
/// part of the promise.
///
/// Every sample gets a message on `/joint_states`. Its velocity is the slope, at the sample, of the
/// parabola through it and its two neighbours: the central difference, where the stamps are even.
/// At the ends, it is the slope to the only neighbour. `/robot_description` stands at the epoch;
/// `/tf` and `/tcp_pose` come with the first sample of every interval of their rate, and with the
/// last one of all.
///
/// At 1 kHz an hour is some 600 MB, of which the poses are a fifth; at 200 Hz it is a third of that.
/// Every period ends with the index of the whole file being written anew, some 110 bytes for every
/// period before: 4 MB after ten hours of periods of a second, which takes some 10 ms then. Memory
/// grows by some 2 kB a period. Longer periods make both less.
///
/// The same calls give the same bytes. The end of a period goes by the stamps, never by the clock:
/// a caller whose samples stop coming calls [`flush`](Self::flush).
pub struct Recorder<S: Storage> {
    /// Its stream is what `file` does not have yet.
    writer: Writer<Vec<u8>>,
    /// What the file's summary says.
    index: Index,
    file: WholeFile<S>,
    arm: Arm,
    config: RecorderConfig,
    /// The last sample but one.
    previous: Option<Sample>,
    last: Option<Last>,
    /// The interval of the pose rate that has its pose.
    posed: Option<u128>,
    /// The first sample that the file does not have.
    open_since: Option<Duration>,
}

#[derive(Clone, Copy, Debug)]
struct Sample {
    t: Duration,
    q: Joints,
    torques_nm: Option<Joints>,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    sample: Sample,
    /// It usually waits for the next one, which its velocity depends on.
    written: bool,
}

impl<S: Storage> std::fmt::Debug for Recorder<S> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Recorder")
            .field("config", &self.config)
            .field("last", &self.last)
            .finish_non_exhaustive()
    }
}

impl Recorder<File> {
    /// Begins a recording of `robot` in a new file, or with `overwrite` in place of one that exists. A recording that
    /// cannot begin leaves no file, and a file that exists as it was, unless the disk is full.
    ///
    /// # Errors
    ///
    /// Any [`WriteError`].
    pub fn create(
        path: &Path,
        overwrite: bool,
        robot: &Robot,
        config: RecorderConfig,
    ) -> Result<Self, WriteError> {
        Recorder::new(Cursor::new(Vec::new()), robot, config.clone())?;
        let file = if overwrite { File::create(path) } else { File::create_new(path) };
        let file = file.map_err(mcap::McapError::from)?;
        Self::new(file, robot, config).inspect_err(|_| drop(fs::remove_file(path)))
    }
}

impl<S: Storage> Recorder<S> {
    /// Begins a recording of `robot` in an empty storage: a file with its description. It is whole
    /// when this returns.
    ///
    /// # Errors
    ///
    /// Any [`WriteError`].
    pub fn new(storage: S, robot: &Robot, config: RecorderConfig) -> Result<Self, WriteError> {
        let library = format!("{}{RECORDS}", config.file.library);
        let mut writer = Writer::new(Vec::new(), Config { library, ..config.file.clone() })?;
        let arm = Arm::with_names(robot, &config.file.names);
        arm.description(&mut writer)?;
        end_chunk(&mut writer)?;
        let data = std::mem::take(writer.stream_mut());
        let index = writer.index().clone();
        let file = WholeFile::new(storage, &data, &index.tail(data.len() as u64, NO_CRC)?)?;
        Ok(Self {
            writer,
            index,
            file,
            arm,
            config,
            previous: None,
            last: None,
            posed: None,
            open_since: None,
        })
    }

    /// Takes the positions of the joints at `t` after the epoch. Brings the file up to date when a
    /// period is full.
    ///
    /// # Errors
    ///
    /// [`WriteError::NotIncreasing`] for a stamp that is not later than the one before, and
    /// [`WriteError::StampOutOfRange`]: the sample is left out, and the recording goes on.
    /// [`WriteError::Mcap`] when the storage refuses: the file stays as it was, and takes nothing
    /// more.
    pub fn sample(&mut self, t: Duration, joints_rad: &Joints) -> Result<(), WriteError> {
        self.sample_with_torques(t, joints_rad, None)
    }

    /// The same with the joints' torques, in Nm, if they are known.
    ///
    /// # Errors
    ///
    /// As [`sample`](Self::sample).
    pub fn sample_with_torques(
        &mut self,
        t: Duration,
        joints_rad: &Joints,
        torques_nm: Option<&Joints>,
    ) -> Result<(), WriteError> {
        self.writer.stamp(Topic::JointStates, t)?;
        let next = Sample { t, q: *joints_rad, torques_nm: torques_nm.copied() };
        if let Some(Last { sample, written }) = self.last {
            if t <= sample.t {
                let topic = Topic::JointStates;
                return Err(WriteError::NotIncreasing { topic, t, previous: sample.t });
            }
            if !written {
                self.write(&sample, &slope(self.previous.as_ref(), &sample, Some(&next)))?;
            }
            self.previous = Some(sample);
        }
        self.last = Some(Last { sample: next, written: false });
        if t.saturating_sub(*self.open_since.get_or_insert(t)) >= self.config.period {
            self.save()?;
            self.open_since = Some(t);
        }
        Ok(())
    }

    /// Takes how parts of the machine are at `t` after the epoch.
    ///
    /// # Errors
    ///
    /// As [`sample`](Self::sample).
    pub fn diagnostics(&mut self, t: Duration, parts: &[Diagnostic<'_>]) -> Result<(), WriteError> {
        self.writer.diagnostics(t, parts)
    }

    /// Brings the file up to date, with every sample so far. For a caller that gets no more
    /// samples, but does not know whether that is the end; [`sample`](Self::sample) does it by
    /// itself after every period.
    ///
    /// The last sample then has the slope to the one before it as its velocity.
    ///
    /// # Errors
    ///
    /// [`WriteError::Mcap`], as [`sample`](Self::sample).
    pub fn flush(&mut self) -> Result<(), WriteError> {
        self.write_last()?;
        self.open_since = None;
        self.save()
    }

    /// Writes the end, the `metadata` record `iiwasim`, the robot's profile and URDF and the `attachments`
    /// (name, media type, content), and completes the file: the checksum of its data section is the only thing
    /// that it did not have before.
    ///
    /// # Errors
    ///
    /// Any [`WriteError`].
    pub fn finish(
        mut self,
        metadata: &BTreeMap<String, String>,
        attachments: &[(&str, &str, &[u8])],
    ) -> Result<S, WriteError> {
        self.write_last()?;
        if let (Some(Last { sample, .. }), Some(_)) = (self.last, self.posed) {
            match self.arm.poses(&mut self.writer, sample.t, &sample.q) {
                // It had its pose already.
                Ok(()) | Err(WriteError::NotIncreasing { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        let new = self.arm.finish(self.writer, metadata, attachments)?;
        self.file.grow(|at| self.index.tail(at, NO_CRC), &new, new.len())?;
        Ok(self.file.into_inner())
    }

    /// Writes the last sample if it still waits.
    fn write_last(&mut self) -> Result<(), WriteError> {
        if let Some(Last { sample, written: false }) = self.last {
            self.write(&sample, &slope(self.previous.as_ref(), &sample, None))?;
            self.last = Some(Last { sample, written: true });
        }
        Ok(())
    }

    /// Writes a sample, with the poses when it is their turn.
    fn write(&mut self, sample: &Sample, velocity: &Joints) -> Result<(), WriteError> {
        self.writer.joint_state(sample.t, &sample.q, velocity, sample.torques_nm.as_ref())?;
        let interval = sample.t.as_nanos() * u128::from(self.config.pose_rate_hz) / 1_000_000_000;
        if self.config.pose_rate_hz > 0 && self.posed != Some(interval) {
            self.posed = Some(interval);
            self.arm.poses(&mut self.writer, sample.t, &sample.q)?;
        }
        Ok(())
    }

    /// Brings the file up to date with what is written.
    fn save(&mut self) -> Result<(), WriteError> {
        end_chunk(&mut self.writer)?;
        let mut new = std::mem::take(self.writer.stream_mut());
        let data_bytes = new.len();
        if data_bytes == 0 {
            return Ok(());
        }
        new.extend(self.writer.index().tail(self.writer.offset(), NO_CRC)?);
        self.file.grow(|at| self.index.tail(at, NO_CRC), &new, data_bytes)?;
        self.index.clone_from(self.writer.index());
        Ok(())
    }
}

/// Ends the chunk, and the data section so that the header of the next record is in one page.
fn end_chunk(writer: &mut Writer<Vec<u8>>) -> Result<(), WriteError> {
    writer.end_chunk()?;
    if header_is_torn(writer.offset()) {
        writer.pad(&[0; 8])?;
    }
    Ok(())
}

/// The slope at `at` of the parabola through the three, rad/s: of the line where there are two, and
/// zero where there is one.
fn slope(before: Option<&Sample>, at: &Sample, after: Option<&Sample>) -> Joints {
    let span = |from: &Sample, to: &Sample| to.t.saturating_sub(from.t).as_secs_f64();
    let line = |from: &Sample, to: &Sample| -> Joints {
        std::array::from_fn(|joint| (to.q[joint] - from.q[joint]) / span(from, to))
    };
    match (before, after) {
        (None, None) => [0.0; 7],
        (Some(before), None) => line(before, at),
        (None, Some(after)) => line(at, after),
        (Some(before), Some(after)) => {
            let (left, right) = (line(before, at), line(at, after));
            // The nearer neighbour counts more.
            let weight = span(at, after) / span(before, after);
            std::array::from_fn(|joint| weight * left[joint] + (1.0 - weight) * right[joint])
        }
    }
}
