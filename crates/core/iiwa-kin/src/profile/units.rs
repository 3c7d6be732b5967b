//! Units and range checks of the numbers in profiles.

use iiwa_json::{
    JsonStep::{self, Index, Key},
    locate,
};

use super::{
    bounds::{KAPPA_RANGE, MASSES},
    error::ProfileError,
};

/// Conversion from a profile unit to SI.
pub(super) type ToSi = fn(f64) -> f64;

pub(super) const DEG: ToSi = f64::to_radians;
pub(super) const SAME: ToSi = |value| value;

pub(super) fn from_mm(mm: f64) -> f64 {
    mm / 1e3
}

/// True if any bit differs.
pub(super) fn differ(a: &[f64], b: &[f64]) -> bool {
    a.iter().map(|v| v.to_bits()).ne(b.iter().map(|v| v.to_bits()))
}

pub(super) fn list<const N: usize>(
    text: &str,
    key: &'static str,
    numbers: &[f64],
    max: f64,
    to_si: ToSi,
) -> Result<[f64; N], ProfileError> {
    if numbers.len() != N {
        let place = locate(text, &[Key(key)]);
        return Err(ProfileError::Count { place, key, found: numbers.len(), expected: N });
    }
    let mut values = [0.0; N];
    for (index, value) in values.iter_mut().enumerate() {
        let quantity = || {
            if key == MASSES {
                format!("{key}: link {index}")
            } else {
                format!("{key}: joint A{}", index + 1)
            }
        };
        *value = checked(text, &[Key(key), Index(index)], numbers[index], max, quantity, to_si)?;
    }
    Ok(values)
}

/// Checked coefficients of kappa.
pub(super) fn kappa(
    text: &str,
    key: &'static str,
    numbers: &[f64],
) -> Result<[f64; 3], ProfileError> {
    let found = numbers.len();
    let coefficients = numbers.try_into().map_err(|_| {
        let place = locate(text, &[Key(key)]);
        ProfileError::Count { place, key, found, expected: 3 }
    })?;
    for (index, &found) in numbers.iter().enumerate() {
        let quantity = || format!("{key}: number {}", index + 1);
        within(text, &[Key(key), Index(index)], found, KAPPA_RANGE, quantity)?;
    }
    Ok(coefficients)
}

pub(super) fn checked(
    text: &str,
    path: &[JsonStep<'_>],
    found: f64,
    max: f64,
    quantity: impl Fn() -> String,
    to_si: ToSi,
) -> Result<f64, ProfileError> {
    let value = to_si(found);
    // Subnormal numbers are rejected because they lose digits in the conversion to SI.
    if value.is_normal() && found > 0.0 && found <= max {
        Ok(value)
    } else {
        Err(ProfileError::Number { place: locate(text, path), quantity: quantity(), found, max })
    }
}

pub(super) fn within(
    text: &str,
    path: &[JsonStep<'_>],
    found: f64,
    [min, max]: [f64; 2],
    quantity: impl Fn() -> String,
) -> Result<(), ProfileError> {
    if (min..=max).contains(&found) {
        Ok(())
    } else {
        Err(ProfileError::Range {
            place: locate(text, path),
            quantity: quantity(),
            found,
            min,
            max,
        })
    }
}

/// Number that `to_si` converts to `value`, with as few digits as possible; the closest number if
/// no number converts exactly.
pub(super) fn unconvert(value: f64, to_si: ToSi) -> f64 {
    let near = value / to_si(1.0);
    let rounded = (12..=16).filter_map(|digits| format!("{near:.digits$e}").parse::<f64>().ok());
    let around = [near, near.next_down(), near.next_up()];
    let mut best = near;
    for candidate in rounded.chain(around) {
        let error = (to_si(candidate) - value).abs();
        if error == 0.0 {
            return candidate;
        }
        if error < (to_si(best) - value).abs() {
            best = candidate;
        }
    }
    best
}
