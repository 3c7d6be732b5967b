//! Long lists of numbers as text.

use base64::{Engine as _, engine::general_purpose::STANDARD};
use serde::Serialize;

/// Numbers as base64 of their little-endian bytes: a third of the size of decimal text.
#[derive(Clone, Debug, Default, Serialize)]
#[serde(transparent)]
pub(crate) struct Packed(String);

impl Packed {
    /// Packs times and other numbers that need all their digits.
    pub(crate) fn doubles(values: impl IntoIterator<Item = f64>) -> Self {
        Self::of(values.into_iter().flat_map(f64::to_le_bytes))
    }

    /// Packs numbers that are drawn: seven digits.
    #[expect(clippy::cast_possible_truncation, reason = "finer than any screen")]
    pub(crate) fn singles(values: impl IntoIterator<Item = f64>) -> Self {
        Self::of(values.into_iter().flat_map(|value| (value as f32).to_le_bytes()))
    }

    /// Packs numbers from 0 to 1 in 16 bits.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it saturates")]
    pub(crate) fn shares(values: impl IntoIterator<Item = f64>) -> Self {
        let word = |value: f64| (value * f64::from(u16::MAX)).round() as u16;
        Self::of(values.into_iter().flat_map(|value| word(value).to_le_bytes()))
    }

    /// Packs counts below 65536.
    pub(crate) fn halves(values: impl IntoIterator<Item = u32>) -> Self {
        let half = |value: u32| u16::try_from(value).unwrap_or(u16::MAX);
        Self::of(values.into_iter().flat_map(|value| half(value).to_le_bytes()))
    }

    /// Packs counts in 32 bits.
    pub(crate) fn words(values: impl IntoIterator<Item = u32>) -> Self {
        Self::of(values.into_iter().flat_map(u32::to_le_bytes))
    }

    fn of(bytes: impl Iterator<Item = u8>) -> Self {
        Self(STANDARD.encode(bytes.collect::<Vec<_>>()))
    }
}
