//! Long lists of numbers as text.

use base64::{Engine as _, engine::general_purpose::STANDARD};
use serde::Serialize;

/// Numbers in base64 of their bytes, little-endian: a third of what they take in decimals.
#[derive(Clone, Debug, Default, Serialize)]
#[serde(transparent)]
pub(crate) struct Packed(String);

impl Packed {
    /// Times and other numbers that need all their digits.
    pub(crate) fn doubles(values: impl IntoIterator<Item = f64>) -> Self {
        Self::of(values.into_iter().flat_map(f64::to_le_bytes))
    }

    /// Numbers that are drawn: seven digits.
    #[expect(clippy::cast_possible_truncation, reason = "finer than any screen")]
    pub(crate) fn singles(values: impl IntoIterator<Item = f64>) -> Self {
        Self::of(values.into_iter().flat_map(|value| (value as f32).to_le_bytes()))
    }

    fn of(bytes: impl Iterator<Item = u8>) -> Self {
        Self(STANDARD.encode(bytes.collect::<Vec<_>>()))
    }
}
