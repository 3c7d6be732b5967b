//! ROS 2 messages of a recording in CDR: fields in order, the same type for both directions.

use std::borrow::Cow;
use std::fmt;
use std::time::Duration;

use serde::de::{DeserializeSeed, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{Diagnostic, cdr};

/// `builtin_interfaces/msg/Time`, and `Duration` with the same fields.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Time {
    pub(crate) sec: i32,
    pub(crate) nanosec: u32,
}

impl Time {
    /// Converts a duration; `None` past 2^31 - 1 seconds.
    pub(crate) fn from_duration(duration: Duration) -> Option<Self> {
        let sec = i32::try_from(duration.as_secs()).ok()?;
        Some(Self { sec, nanosec: duration.subsec_nanos() })
    }

    /// Converts to a duration; `None` if negative or if the nanoseconds exceed a second.
    pub(crate) fn to_duration(self) -> Option<Duration> {
        let sec = u64::try_from(self.sec).ok()?;
        (self.nanosec < 1_000_000_000).then(|| Duration::new(sec, self.nanosec))
    }
}

/// `std_msgs/msg/Header`.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Header<'a> {
    pub(crate) stamp: Time,
    pub(crate) frame_id: Cow<'a, str>,
}

/// `std_msgs/msg/String`.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Text<'a> {
    pub(crate) data: Cow<'a, str>,
}

/// `sensor_msgs/msg/JointState`.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct JointState<'a> {
    pub(crate) header: Header<'a>,
    pub(crate) name: JointNames<'a>,
    pub(crate) position: JointArray,
    pub(crate) velocity: JointArray,
    pub(crate) effort: JointArray,
}

/// `geometry_msgs/msg/PoseStamped`. Vectors and quaternions are sequences of doubles on the wire.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PoseStamped<'a> {
    pub(crate) header: Header<'a>,
    pub(crate) position: [f64; 3],
    pub(crate) orientation: [f64; 4],
}

/// `geometry_msgs/msg/TransformStamped`.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct TransformStamped<'a> {
    pub(crate) header: Header<'a>,
    pub(crate) child_frame_id: Cow<'a, str>,
    pub(crate) translation: [f64; 3],
    pub(crate) rotation: [f64; 4],
}

/// `trajectory_msgs/msg/JointTrajectory`.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct JointTrajectory<'a> {
    pub(crate) header: Header<'a>,
    pub(crate) joint_names: JointNames<'a>,
    pub(crate) points: Vec<JointTrajectoryPoint>,
}

/// `trajectory_msgs/msg/JointTrajectoryPoint`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct JointTrajectoryPoint {
    pub(crate) positions: JointArray,
    pub(crate) velocities: JointArray,
    pub(crate) accelerations: JointArray,
    pub(crate) effort: JointArray,
    pub(crate) time_from_start: Time,
}

/// `diagnostic_msgs/msg/DiagnosticArray`.
#[derive(Debug, Serialize)]
pub(crate) struct DiagnosticArray<'a> {
    pub(crate) header: Header<'a>,
    pub(crate) status: &'a [Diagnostic<'a>],
}

/// `iiwasim_msgs/msg/Motion`.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct MotionMessage<'a> {
    pub(crate) header: Header<'a>,
    pub(crate) index: u32,
    pub(crate) kind: Cow<'a, str>,
    pub(crate) limiting_joint: u32,
    pub(crate) limiting_kind: Cow<'a, str>,
    /// Empty for a motion without a name.
    pub(crate) name: Cow<'a, str>,
    /// Empty for a motion without a group.
    pub(crate) group: Cow<'a, str>,
}

impl<'a> MotionMessage<'a> {
    /// Decodes a message, also one without name and group, as in files of earlier versions. The
    /// error is as for [`cdr::decode`].
    pub(crate) fn decode(bytes: &'a [u8]) -> Result<Self, String> {
        let with_name = |(header, index, kind, limiting_joint, limiting_kind)| {
            let (name, group) = (Cow::Borrowed(""), Cow::Borrowed(""));
            Self { header, index, kind, limiting_joint, limiting_kind, name, group }
        };
        cdr::decode(bytes).or_else(|error| cdr::decode(bytes).map(with_name).map_err(|_| error))
    }
}

/// `float64[]` with one value per joint. Keeps the length that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JointArray {
    pub(crate) len: usize,
    values: [f64; 7],
}

impl JointArray {
    pub(crate) const EMPTY: Self = Self { len: 0, values: [0.0; 7] };

    pub(crate) fn seven(&self) -> Option<[f64; 7]> {
        (self.len == self.values.len()).then_some(self.values)
    }
}

impl From<[f64; 7]> for JointArray {
    fn from(values: [f64; 7]) -> Self {
        Self { len: values.len(), values }
    }
}

impl Serialize for JointArray {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.values[..self.len.min(self.values.len())].serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for JointArray {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ValuesVisitor;

        impl<'de> Visitor<'de> for ValuesVisitor {
            type Value = JointArray;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a sequence of doubles")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<JointArray, A::Error> {
                let mut joints = JointArray::EMPTY;
                while let Some(value) = seq.next_element()? {
                    if let Some(slot) = joints.values.get_mut(joints.len) {
                        *slot = value;
                    }
                    joints.len += 1;
                }
                Ok(joints)
            }
        }

        deserializer.deserialize_seq(ValuesVisitor)
    }
}

/// Stem of the joint names in most files.
pub(crate) const USUAL_STEM: &str = "iiwa_joint_";

/// Numbers of the joints.
const NUMBERS: [&str; 7] = ["1", "2", "3", "4", "5", "6", "7"];

/// `string[]` with the seven joint names: the same stem with the numbers 1 to 7. Keeps the first
/// difference that was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum JointNames<'a> {
    /// Seven names with this stem, in order.
    Of(Cow<'a, str>),
    /// The name at `index` differs.
    Other { index: usize, expected: String, found: String },
    /// More or fewer than seven names; the common ones are right.
    Count(usize),
}

impl Serialize for JointNames<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Of(stem) => {
                serializer.collect_seq(NUMBERS.map(|number| format!("{stem}{number}")))
            }
            Self::Other { .. } | Self::Count(_) => {
                Err(serde::ser::Error::custom("expected seven joint names"))
            }
        }
    }
}

impl<'de> Deserialize<'de> for JointNames<'_> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ListVisitor;

        impl<'de> Visitor<'de> for ListVisitor {
            type Value = JointNames<'static>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a sequence of joint names")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
                let mut stem = Cow::Borrowed(USUAL_STEM);
                let mut other = None;
                let mut count = 0;
                while let Some(differing) =
                    seq.next_element_seed(JointNameReader { index: count, stem: &mut stem })?
                {
                    other = other.or(differing);
                    count += 1;
                }
                Ok(match other {
                    Some(other) => other,
                    None if count == NUMBERS.len() => JointNames::Of(stem),
                    None => JointNames::Count(count),
                })
            }
        }

        deserializer.deserialize_seq(ListVisitor)
    }
}

/// Reads one name and compares it with the expected one. The first name determines the stem.
struct JointNameReader<'a> {
    index: usize,
    stem: &'a mut Cow<'static, str>,
}

impl<'de> DeserializeSeed<'de> for JointNameReader<'_> {
    type Value = Option<JointNames<'static>>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_str(self)
    }
}

impl Visitor<'_> for JointNameReader<'_> {
    type Value = Option<JointNames<'static>>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a joint name")
    }

    fn visit_str<E>(self, name: &str) -> Result<Self::Value, E> {
        let Self { index, stem } = self;
        let Some(number) = NUMBERS.get(index) else { return Ok(None) };
        if index == 0
            && let Some(first) = name.strip_suffix(number).filter(|first| *first != USUAL_STEM)
        {
            *stem = Cow::Owned(first.to_owned());
        }
        if name.strip_prefix(&**stem) == Some(number) {
            return Ok(None);
        }
        let expected = format!("{stem}{number}");
        Ok(Some(JointNames::Other { index, expected, found: name.to_owned() }))
    }
}

#[cfg(test)]
mod tests {
    use iiwa_kin::RosNames;

    use super::*;

    #[test]
    fn motions_of_earlier_versions_have_no_name() {
        let header = || Header { stamp: Time { sec: 1, nanosec: 2 }, frame_id: "".into() };
        let message = |name: &'static str| MotionMessage {
            header: header(),
            index: 3,
            kind: "line".into(),
            limiting_joint: 4,
            limiting_kind: "jerk".into(),
            name: name.into(),
            group: name.into(),
        };
        let mut bytes = Vec::new();
        let earlier = (header(), 3_u32, "line", 4_u32, "jerk");
        assert!(cdr::encode(&mut bytes, &earlier).is_ok());
        assert_eq!(MotionMessage::decode(&bytes), Ok(message("")));
        for name in ["", "a", "swing"] {
            assert!(cdr::encode(&mut bytes, &message(name)).is_ok());
            assert_eq!(MotionMessage::decode(&bytes), Ok(message(name)));
        }
        bytes.truncate(20);
        assert!(MotionMessage::decode(&bytes).is_err());
    }

    #[test]
    fn the_usual_names_are_those_of_the_urdf() {
        assert_eq!(USUAL_STEM, RosNames::default().joint_stem());
        assert_eq!(
            RosNames::default().joints(),
            NUMBERS.map(|number| format!("{USUAL_STEM}{number}"))
        );
    }
}
