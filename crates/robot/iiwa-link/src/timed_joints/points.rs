//! Points of a trajectory, and their JSON.

use std::{fmt, marker::PhantomData};

use iiwa_kin::Joints;
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{Error as _, IgnoredAny, SeqAccess, Visitor},
};

/// Maximum number of points of a trajectory: 13 minutes at one point per 4 ms.
pub const MAX_POINTS: usize = 200_000;

/// A trajectory: joint positions with time stamps.
///
/// ```
/// use iiwa_link::TimedJoints;
///
/// let text = r#"{"t_s": [0, 0.02], "joints_rad": [[0,0,0,0,0,0,0], [0.001,0,0,0,0,0,0]]}"#;
/// let trajectory: TimedJoints = serde_json::from_str(text)?;
/// assert_eq!(trajectory.duration_s(), 0.02);
/// assert_eq!(trajectory.at(1.0)[0], 0.001);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimedJoints {
    /// Time stamps, in s, strictly increasing. The first stamp is the start, for any value.
    #[serde(deserialize_with = "bounded")]
    pub t_s: Vec<f64>,
    /// Positions at these times, in rad; one per time stamp.
    #[serde(deserialize_with = "points")]
    pub joints_rad: Vec<Joints>,
}

fn points<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Joints>, D::Error> {
    let points: Vec<TimedPoint> = bounded(deserializer)?;
    Ok(points.into_iter().map(|TimedPoint(joints_rad)| joints_rad).collect())
}

/// Deserializes a list of at most [`MAX_POINTS`] values; a longer list is not read to its end.
fn bounded<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<T>, D::Error> {
    struct BoundedList<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for BoundedList<T> {
        type Value = Vec<T>;
        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "a sequence of at most {MAX_POINTS} values")
        }
        fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Vec<T>, A::Error> {
            let mut values = Vec::new();
            while let Some(value) = seq.next_element()? {
                if values.len() == MAX_POINTS {
                    return Err(A::Error::invalid_length(MAX_POINTS + 1, &self));
                }
                values.push(value);
            }
            Ok(values)
        }
    }
    deserializer.deserialize_seq(BoundedList(PhantomData))
}

/// Exactly seven numbers. Serde's error for an eighth number would be about trailing text.
struct TimedPoint(Joints);

impl<'de> Deserialize<'de> for TimedPoint {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct SevenNumbers;
        impl<'de> Visitor<'de> for SevenNumbers {
            type Value = TimedPoint;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("seven joint angles, A1 to A7")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<TimedPoint, A::Error> {
                let mut joints_rad = [0.0; 7];
                for (count, joint) in joints_rad.iter_mut().enumerate() {
                    let Some(value) = seq.next_element()? else {
                        return Err(A::Error::invalid_length(count, &self));
                    };
                    *joint = value;
                }
                let mut count = 7;
                while seq.next_element::<IgnoredAny>()?.is_some() {
                    count += 1;
                }
                if count == 7 {
                    Ok(TimedPoint(joints_rad))
                } else {
                    Err(A::Error::invalid_length(count, &self))
                }
            }
        }
        deserializer.deserialize_seq(SevenNumbers)
    }
}

impl TimedJoints {
    /// Returns the time from the first to the last point, in s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        match self.t_s.as_slice() {
            [first, .., last] => last - first,
            _ => 0.0,
        }
    }
}
