//! Recording of a moving robot.

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

/// Options of a recording.
#[derive(Clone, Debug)]
pub struct RecorderConfig {
    /// Longest part of the motion that is lost if the program is killed. The file gets a chunk once
    /// per period.
    pub period: Duration,
    /// Maximum number of messages per second on `/tf` and `/tcp_pose`, which follow from the joint
    /// positions and are meant for viewers. Zero for none.
    pub pose_rate_hz: u32,
    /// Options of the file.
    pub file: Config,
}

impl Default for RecorderConfig {
    /// Returns a period of 1 s, and 100 poses per second.
    fn default() -> Self {
        Self { period: Duration::from_secs(1), pose_rate_hz: 100, file: Config::default() }
    }
}

/// Suffix of the name of the writing program in the header of a recording.
const RECORDS: &str = " recorder";

/// Returns true if a file that begins with `head` is an MCAP file without a plan: written by a
/// [`Recorder`], or by another program.
#[must_use]
pub fn is_recording(head: &[u8]) -> bool {
    // The magic bytes, opcode and length of the header, then two texts with their lengths: profile
    // and library.
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

/// Checksum of an incomplete data section: 0 if a checksum is missing.
const NO_CRC: u32 = 0;

/// Writes joint positions into an MCAP file as they arrive, for hours and at up to 1 kHz.
///
/// The file is complete and indexed at every moment: a killed program loses at most the last
/// [`period`](RecorderConfig::period) and the sample after it. (This does not hold for a power
/// failure: writes are not synchronised to the disk.) A reader that has the file open during a
/// write may see an intermediate state.
///
/// Every sample gets a message on `/joint_states`. Its velocity is the slope, at the sample, of the
/// parabola through the sample and its two neighbours: the central difference if the stamps are
/// equidistant. At the ends, the velocity is the slope to the only neighbour. `/robot_description`
/// is stamped with the epoch; `/tf` and `/tcp_pose` are written with the first sample of every
/// interval of their rate, and with the last sample of all.
///
/// At 1 kHz an hour is some 700 MB, of which the poses are a fifth; at 200 Hz it is a third of
/// that. Every period ends with rewriting the index of the whole file, some 110 bytes for every
/// period before: 4 MB after ten hours of periods of 1 s, which takes some 10 ms then. Memory grows
/// by some 2 kB per period. Longer periods reduce both.
///
/// The same calls give the same bytes. The end of a period is determined by the stamps, never by
/// the clock: a caller whose samples stop arriving calls [`flush`](Self::flush).
pub struct Recorder<S: Storage> {
    /// Writer whose stream contains the data that `file` lacks.
    writer: Writer<Vec<u8>>,
    /// Summary of the file.
    index: Index,
    file: WholeFile<S>,
    arm: Arm,
    config: RecorderConfig,
    /// Sample before the last one.
    previous: Option<RecorderSample>,
    last: Option<Last>,
    /// Interval of the pose rate whose pose is written.
    posed: Option<u128>,
    /// First sample that the file lacks.
    open_since: Option<Duration>,
}

#[derive(Clone, Copy, Debug)]
struct RecorderSample {
    t: Duration,
    q: Joints,
    torques_nm: Option<Joints>,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    sample: RecorderSample,
    /// `true` if the sample is written; usually it waits for the next one, which its velocity
    /// depends on.
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
    /// Begins a recording of `robot` in a new file, or with `overwrite` in place of an existing
    /// one. A recording that cannot begin creates no file, and leaves an existing file unchanged,
    /// unless the disk is full.
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
    /// Begins a recording of `robot` in an empty storage: a complete file with the robot
    /// description.
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

    /// Adds the joint positions at `t` after the epoch. Updates the file at the end of each period.
    ///
    /// # Errors
    ///
    /// [`WriteError::NotIncreasing`] for a stamp that is not later than the previous one, and
    /// [`WriteError::StampOutOfRange`]: the sample is omitted, and the recording continues.
    /// [`WriteError::Mcap`] if the storage fails: the file keeps its content, and accepts no more
    /// samples.
    pub fn sample(&mut self, t: Duration, joints_rad: &Joints) -> Result<(), WriteError> {
        self.sample_with_torques(t, joints_rad, None)
    }

    /// Adds the joint positions with the joint torques, in Nm, if known.
    ///
    /// # Errors
    ///
    /// See [`sample`](Self::sample).
    pub fn sample_with_torques(
        &mut self,
        t: Duration,
        joints_rad: &Joints,
        torques_nm: Option<&Joints>,
    ) -> Result<(), WriteError> {
        self.writer.stamp(Topic::JointStates, t)?;
        let next = RecorderSample { t, q: *joints_rad, torques_nm: torques_nm.copied() };
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

    /// Adds the status of machine components at `t` after the epoch.
    ///
    /// # Errors
    ///
    /// See [`sample`](Self::sample).
    pub fn diagnostics(&mut self, t: Duration, parts: &[Diagnostic<'_>]) -> Result<(), WriteError> {
        self.writer.diagnostics(t, parts)
    }

    /// Updates the file with every sample so far, for callers whose samples stop arriving, perhaps
    /// temporarily; [`sample`](Self::sample) does the same after every period.
    ///
    /// The velocity of the last sample is then the slope to the previous one.
    ///
    /// # Errors
    ///
    /// [`WriteError::Mcap`], see [`sample`](Self::sample).
    pub fn flush(&mut self) -> Result<(), WriteError> {
        self.write_last()?;
        self.open_since = None;
        self.save()
    }

    /// Writes the end, the `metadata` record `iiwasim`, the robot's profile and URDF and the
    /// `attachments` (name, media type, content), and completes the file, which so far lacks only
    /// the checksum of its data section.
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
                // The pose of this sample is already written.
                Ok(()) | Err(WriteError::NotIncreasing { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        let new = self.arm.finish(self.writer, metadata, attachments)?;
        self.file.grow(|at| self.index.tail(at, NO_CRC), &new, new.len())?;
        Ok(self.file.into_inner())
    }

    /// Writes the last sample if it is still pending.
    fn write_last(&mut self) -> Result<(), WriteError> {
        if let Some(Last { sample, written: false }) = self.last {
            self.write(&sample, &slope(self.previous.as_ref(), &sample, None))?;
            self.last = Some(Last { sample, written: true });
        }
        Ok(())
    }

    /// Writes a sample, with the poses if their interval has begun.
    fn write(&mut self, sample: &RecorderSample, velocity: &Joints) -> Result<(), WriteError> {
        self.writer.joint_state(sample.t, &sample.q, velocity, sample.torques_nm.as_ref())?;
        let interval = sample.t.as_nanos() * u128::from(self.config.pose_rate_hz) / 1_000_000_000;
        if self.config.pose_rate_hz > 0 && self.posed != Some(interval) {
            self.posed = Some(interval);
            self.arm.poses(&mut self.writer, sample.t, &sample.q)?;
        }
        Ok(())
    }

    /// Adds the encoded data to the file.
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

/// Ends the chunk, and pads the data section so that the header of the next record is in one page.
fn end_chunk(writer: &mut Writer<Vec<u8>>) -> Result<(), WriteError> {
    writer.end_chunk()?;
    if header_is_torn(writer.offset()) {
        writer.pad(&[0; 8])?;
    }
    Ok(())
}

/// Slope at `at` of the parabola through the three samples, rad/s: of the straight line through two
/// samples, and zero for one sample.
fn slope(
    before: Option<&RecorderSample>,
    at: &RecorderSample,
    after: Option<&RecorderSample>,
) -> Joints {
    let span =
        |from: &RecorderSample, to: &RecorderSample| to.t.saturating_sub(from.t).as_secs_f64();
    let line = |from: &RecorderSample, to: &RecorderSample| -> Joints {
        std::array::from_fn(|joint| (to.q[joint] - from.q[joint]) / span(from, to))
    };
    match (before, after) {
        (None, None) => [0.0; 7],
        (Some(before), None) => line(before, at),
        (None, Some(after)) => line(at, after),
        (Some(before), Some(after)) => {
            let (left, right) = (line(before, at), line(at, after));
            // The nearer neighbour has the larger weight.
            let weight = span(at, after) / span(before, after);
            std::array::from_fn(|joint| weight * left[joint] + (1.0 - weight) * right[joint])
        }
    }
}
