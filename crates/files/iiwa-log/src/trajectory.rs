//! Trajectory message that is built point by point.

use std::iter::{self, zip};
use std::time::Duration;

use crate::error::WriteError;
use crate::ros::{
    Header, JointArray, JointNames, JointTrajectory, JointTrajectoryPoint, Time, USUAL_STEM,
};
use crate::template::{Template, stamp_word};
use crate::{Topic, cdr};

/// Node of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectoryPoint {
    /// Time since the start of the trajectory.
    pub time_from_start: Duration,
    /// Joint positions, rad.
    pub positions: [f64; 7],
    /// Joint velocities, rad/s.
    pub velocities: [f64; 7],
    /// Joint accelerations, rad/s^2.
    pub accelerations: [f64; 7],
}

/// Bytes of a point in a message.
const POINT_BYTES: usize = 200;

/// Reserved bytes for the data before a message in its chunk, which avoids reallocating its bytes.
const BEFORE_BYTES: usize = 4096;

/// `/joint_trajectory` message under construction, kept in encoded form.
///
/// A point has 200 bytes, so an hour at 250 Hz has 180 MB.
#[derive(Clone, Debug)]
pub struct TrajectoryMessage {
    /// Encoded message; the head has the default names until the message is stamped.
    bytes: Vec<u8>,
    /// Template of a point, with the word before it.
    point: Template,
    head_bytes: usize,
    count: u32,
    last: Option<Duration>,
}

impl TrajectoryMessage {
    /// Creates a trajectory without points.
    ///
    /// # Errors
    ///
    /// [`WriteError::Encode`] if the encoder fails, which no input causes.
    pub fn new() -> Result<Self, WriteError> {
        let bytes = head(Time { sec: 0, nanosec: 0 }, USUAL_STEM, 0)?;
        let head_bytes = bytes.len();
        // Doubles are aligned to 8 in the whole message, and a point begins 4 past a multiple of 8.
        // So the word before it (the count, or nanoseconds) is encoded with the point.
        let point = Template::new(iter::empty(), |buffer, time_from_start, value| {
            let point = JointTrajectoryPoint {
                positions: JointArray::from([value; 7]),
                velocities: JointArray::from([value; 7]),
                accelerations: JointArray::from([value; 7]),
                effort: JointArray::EMPTY,
                time_from_start,
            };
            cdr::append(buffer, &(0_u32, point))
        })
        .map_err(|source| WriteError::Encode { topic: Topic::JointTrajectory, source })?;
        Ok(Self { bytes, point, head_bytes, count: 0, last: None })
    }

    /// Reserves memory for this number of further points.
    pub(crate) fn reserve(&mut self, points: usize) {
        self.bytes.reserve(points * POINT_BYTES + BEFORE_BYTES);
    }

    /// Creates a trajectory of all `points`.
    ///
    /// # Errors
    ///
    /// See [`push`](Self::push).
    pub fn from_points(
        points: impl IntoIterator<Item = TrajectoryPoint>,
    ) -> Result<Self, WriteError> {
        let mut message = Self::new()?;
        for point in points {
            message.push(&point)?;
        }
        Ok(message)
    }

    /// Time of the last point, since the start of the trajectory.
    #[must_use]
    pub fn last(&self) -> Option<Duration> {
        self.last
    }

    /// Appends a point.
    ///
    /// # Errors
    ///
    /// [`WriteError::NotIncreasing`] if the point is not later than the previous one,
    /// [`WriteError::StampOutOfRange`] if its time does not fit into 2^31 s,
    /// [`WriteError::TooManyPoints`] beyond 2^32 - 1 points.
    pub fn push(&mut self, point: &TrajectoryPoint) -> Result<(), WriteError> {
        let topic = Topic::JointTrajectory;
        let t = point.time_from_start;
        if let Some(previous) = self.last.filter(|last| t <= *last) {
            return Err(WriteError::NotIncreasing { topic, t, previous });
        }
        let time_from_start = Time::from_duration(t).ok_or(WriteError::StampOutOfRange {
            topic,
            t,
            epoch: Duration::ZERO,
        })?;
        let count = self.count.checked_add(1).ok_or(WriteError::TooManyPoints)?;
        let mut words = [stamp_word(time_from_start); 3 * 7 + 1];
        let numbers = [point.positions, point.velocities, point.accelerations];
        for (word, number) in zip(&mut words, numbers.as_flattened()) {
            *word = number.to_le_bytes();
        }
        self.bytes.extend_from_slice(&self.point.fill(&words)[4..]);

        self.count = count;
        self.last = Some(t);
        Ok(())
    }

    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.count as usize
    }

    /// Returns true before the first point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Size of the message with the names of `iiwa_stack` before compression, bytes.
    #[must_use]
    pub fn len_bytes(&self) -> usize {
        self.bytes.len()
    }

    /// Returns the finished, stamped message for joints whose names begin with `joint_stem`.
    pub(crate) fn stamped(mut self, stamp: Time, joint_stem: &str) -> Result<Vec<u8>, WriteError> {
        let mut head = head(stamp, joint_stem, self.count)?;
        let mut replaced = self.head_bytes;
        // After a head of this length, the first point begins at a multiple of 8: its first doubles
        // are 4 bytes farther from the count. All later points keep their alignment.
        if !self.is_empty() && (head.len() - cdr::ENCAPSULATION.len()).is_multiple_of(8) {
            head.extend_from_slice(&self.bytes[replaced..replaced + 4]);
            head.extend([0; 4]);
            replaced += 4;
        }
        self.bytes.splice(..replaced, head);
        Ok(self.bytes)
    }
}

/// Encodes the head: everything up to the number of points.
fn head(stamp: Time, joint_stem: &str, count: u32) -> Result<Vec<u8>, WriteError> {
    let mut bytes = Vec::new();
    let empty = JointTrajectory {
        header: Header { stamp, frame_id: "".into() },
        joint_names: JointNames::Of(joint_stem.into()),
        points: Vec::new(),
    };
    cdr::encode(&mut bytes, &empty)
        .map_err(|source| WriteError::Encode { topic: Topic::JointTrajectory, source })?;
    let count_at = bytes.len() - 4;
    bytes[count_at..].copy_from_slice(&count.to_le_bytes());
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growing_gives_the_bytes_of_the_whole_message() {
        let mut message = TrajectoryMessage::new().unwrap();
        let mut points = Vec::new();
        for i in 0..5_u32 {
            let x = f64::from(i);
            let point = TrajectoryPoint {
                time_from_start: Duration::from_millis(u64::from(i) * 1300),
                positions: [x; 7],
                velocities: [x + 0.1; 7],
                accelerations: [x + 0.2; 7],
            };
            let before = message.len_bytes();
            message.push(&point).unwrap();
            assert_eq!(message.len_bytes() - before, POINT_BYTES);
            points.push(JointTrajectoryPoint {
                positions: point.positions.into(),
                velocities: point.velocities.into(),
                accelerations: point.accelerations.into(),
                effort: JointArray::EMPTY,
                time_from_start: Time::from_duration(point.time_from_start).unwrap(),
            });
        }
        let stamp = Time { sec: 1_577_836_800, nanosec: 5 };
        let mut ends = [false; 2];
        // Points are aligned after names of any length.
        for stem in [USUAL_STEM, "lbr_A", "right_A", "a_A", "a_joint_", "another_A"] {
            for (message, points) in
                [(message.clone(), points.clone()), (TrajectoryMessage::new().unwrap(), Vec::new())]
            {
                let whole = JointTrajectory {
                    header: Header { stamp, frame_id: "".into() },
                    joint_names: JointNames::Of(stem.into()),
                    points,
                };
                let mut expected = Vec::new();
                cdr::encode(&mut expected, &whole).unwrap();
                ends[usize::from(expected.len().is_multiple_of(8))] = true;
                assert!(message.stamped(stamp, stem).unwrap() == expected, "{stem}");
                assert_eq!(cdr::decode::<JointTrajectory<'_>>(&expected).unwrap(), whole);
            }
        }
        // The heads without points include both alignments.
        assert_eq!(ends, [true; 2]);
    }

    #[test]
    fn time_must_increase() {
        let point = TrajectoryPoint {
            time_from_start: Duration::from_secs(1),
            positions: [0.0; 7],
            velocities: [0.0; 7],
            accelerations: [0.0; 7],
        };
        let error = TrajectoryMessage::from_points([point, point]).unwrap_err();
        assert!(matches!(error, WriteError::NotIncreasing { .. }), "{error}");
    }
}
