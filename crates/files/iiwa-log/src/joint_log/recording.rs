//! Joint positions of an MCAP file.

use std::io::Read;

use mcap::{MAGIC, McapError};

use super::samples::{PositionUnit, SampleCollector};
use super::{CycleClock, FilePlace, JointLog, JointLogError, Loss, PositionSource};
use crate::recorded_robot::PROFILE;
use crate::{Entry, JointSample, ReadError, Reader, Topic};

/// Returns true if a file begins like an MCAP file; it may be cut off within the magic bytes.
pub(super) fn is_mcap(head: &[u8]) -> bool {
    let len = head.len().min(MAGIC.len());
    head[..len] == MAGIC[..len]
}

pub(super) fn read<R: Read>(stream: R) -> Result<JointLog, JointLogError> {
    let mut samples = SampleCollector::new(PositionSource::Mcap, [PositionUnit::Radians; 7]);
    let mut described = None;
    let mut place = 0;
    let mut first = None;
    let mut is_unset = false;
    let mut end = None;
    let topics = [Topic::JointStates, Topic::RobotDescription];
    for entry in Reader::new(stream).only(&topics) {
        match entry {
            Ok(Entry::JointState(sample)) => {
                place += 1;
                // Stamps that were never set are all zero, but simulated time begins at zero, too:
                // the second sample decides.
                if place == 1 && !sample.is_stamped {
                    first = Some(sample);
                    continue;
                }
                is_unset |= first.is_some() && !sample.is_stamped;
                if let Some(first) = first.take() {
                    add(&mut samples, 1, &first, is_unset)?;
                }
                add(&mut samples, place, &sample, is_unset)?;
            }
            Ok(Entry::RobotDescription { urdf, .. }) => described = robot_of(&urdf),
            Ok(Entry::Attachment(attachment)) if attachment.name == "program.json" => {
                samples.log().program = String::from_utf8(attachment.bytes).ok();
            }
            Ok(Entry::Attachment(attachment)) if attachment.name == PROFILE => {
                samples.log().profile = String::from_utf8(attachment.bytes).ok();
            }
            Ok(Entry::Metadata { name, mut entries }) if name == "iiwasim" => {
                let log = samples.log();
                log.is_plan = entries.contains_key("timing");
                log.robot = entries.remove("robot");
                log.cycle_time_s = entries.remove("cycle_time_s").and_then(|s| s.parse().ok());
                let timed_by = entries.remove("timed_by");
                log.timed_by =
                    timed_by.and_then(|name| CycleClock::from_name(&name)).unwrap_or_default();
            }
            Ok(_) => {}
            Err(error) => end = Some(broken_off(&mut samples, error)?),
        }
    }
    if let Some(first) = first {
        add(&mut samples, 1, &first, false)?;
    }
    let log = samples.log();
    log.robot = log.robot.take().or(described);
    samples.finish(end)
}

/// Adds a sample at its stamp, or at its log time if stamps are unset.
fn add(
    samples: &mut SampleCollector,
    place: u64,
    sample: &JointSample,
    is_unset: bool,
) -> Result<(), JointLogError> {
    let t_s = if is_unset && !sample.is_stamped { sample.log_s } else { sample.t_s };
    samples.push(FilePlace::Sample(place), t_s, sample.q)?;
    if let Some(torques_nm) = sample.torques_nm {
        samples.add_torques(torques_nm);
    }
    Ok(())
}

/// Returns the loss for a file that is cut off or damaged, if the part read so far is reliable.
fn broken_off(samples: &mut SampleCollector, error: ReadError) -> Result<Loss, JointLogError> {
    let reason = match &error {
        // The checksum of the whole file is wrong although each chunk's was right: perhaps a chunk
        // was not recognised as such, at an unknown position.
        ReadError::Mcap { source: McapError::BadDataCrc { .. }, .. } => return Err(error.into()),
        ReadError::Mcap { source, .. } => format!("{error}: {source}"),
        ReadError::Truncated { .. } | ReadError::Concatenated => error.to_string(),
        _ => return Err(error.into()),
    };
    match samples.log().t_s.last() {
        Some(&t_s) => Ok(Loss::BrokenOff { t_s, samples: samples.len(), reason }),
        None => Err(error.into()),
    }
}

/// Returns the name in the first element of a URDF.
fn robot_of(urdf: &str) -> Option<String> {
    let (_, element) = urdf.split_once("<robot")?;
    let (attributes, _) = element.split_once('>')?;
    let (_, value) = attributes.split_once("name=\"")?;
    let (name, _) = value.split_once('"')?;
    Some(name.to_owned())
}
