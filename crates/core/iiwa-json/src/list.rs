//! Lists of a fixed count of numbers.

use std::fmt;

use serde::{
    Deserializer,
    de::{Error as _, IgnoredAny, SeqAccess, Visitor},
};

/// Reads exactly `N` numbers; `expected` describes them for errors, such as "three numbers, for x,
/// y and z".
///
/// ```
/// use iiwa_json::numbers;
///
/// let mut reader = serde_json::Deserializer::from_str("[1, 2.5]");
/// let error = numbers::<3, _>(&mut reader, "three numbers, for x, y and z").unwrap_err();
/// assert!(error.to_string().contains("expected three numbers"));
/// ```
///
/// # Errors
///
/// If the value is not a list of numbers, or has another length.
pub fn numbers<'de, const N: usize, D: Deserializer<'de>>(
    reader: D,
    expected: &'static str,
) -> Result<[f64; N], D::Error> {
    reader.deserialize_seq(Numbers(expected))
}

/// The visitor of [`numbers`], for fields that may be something else as well.
#[derive(Clone, Copy, Debug)]
pub struct Numbers<const N: usize>(
    /// Description of the expected numbers.
    pub &'static str,
);

impl<'de, const N: usize> Visitor<'de> for Numbers<N> {
    type Value = [f64; N];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
        let mut numbers = [0.0; N];
        let mut count = 0;
        while count < N {
            let Some(value) = seq.next_element()? else { break };
            numbers[count] = value;
            count += 1;
        }
        while count >= N && seq.next_element::<IgnoredAny>()?.is_some() {
            count += 1;
        }
        if count == N { Ok(numbers) } else { Err(A::Error::invalid_length(count, &self)) }
    }
}
