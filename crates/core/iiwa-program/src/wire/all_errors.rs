//! All errors of a program text.

use std::collections::BTreeMap;

use iiwa_json::{JsonObject, JsonPlace, JsonStep, locate, problem, without_mark};
use serde::{Deserialize, de::DeserializeOwned};
use serde_json::value::RawValue;

use super::{
    ProgramWire, StartWire,
    entries::EntryReader,
    error::{ProgramError, json_error},
    workcell::named,
};
use crate::{program::Program, source::Sources};

/// Maximum number of errors that are reported at once.
pub const MAX_ERRORS: usize = 20;

/// Parts of a program that are read independently of each other.
#[derive(Deserialize)]
struct ProgramParts<'a> {
    #[serde(borrow)]
    start: Option<&'a RawValue>,
    #[serde(borrow)]
    tools: Option<&'a RawValue>,
    #[serde(borrow)]
    bases: Option<&'a RawValue>,
    #[serde(borrow)]
    frames: Option<&'a RawValue>,
    #[serde(borrow)]
    motions: Option<&'a RawValue>,
}

impl Program {
    /// Returns all errors of a program text that are independent of each other, in the order of
    /// their places: one for each unknown key of the program, at most one for the start, one for
    /// each tool, base, frame and motion, and one for the rest of the text; at most [`MAX_ERRORS`]
    /// in all. `first` is the error of [`from_json`](Self::from_json) or
    /// [`from_json_with`](Self::from_json_with). If the text is not a JSON object or has an unknown
    /// version, `first` is returned alone.
    ///
    /// ```
    /// use iiwa_program::Program;
    ///
    /// let text = r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
    ///     "motions": [{ "type": "wait" }, { "type": "movej" }, { "type": "lin" }] }"#;
    /// let first = Program::from_json(text).unwrap_err();
    /// let motions = Program::all_errors(text, first).into_iter().map(|error| error.motion());
    /// assert_eq!(motions.flatten().map(|it| it.index()).collect::<Vec<_>>(), [0, 1, 2]);
    /// ```
    #[must_use]
    pub fn all_errors(text: &str, first: ProgramError) -> Vec<ProgramError> {
        let text = without_mark(text);
        let parts = match (&first, serde_json::from_str::<JsonObject<ProgramParts<'_>>>(text)) {
            // Another version may have other keys.
            (ProgramError::Version { .. }, _) | (_, Err(_)) => return vec![first],
            (_, Ok(JsonObject(parts))) => parts,
        };
        let ProgramParts { start, tools, bases, frames, motions } = parts;
        let motions = motions.and_then(|list| serde_json::from_str::<Vec<_>>(list.get()).ok());
        let mut errors = vec![first];
        errors.extend(unknown_keys(text));
        if let Some(start) = start {
            errors.extend(start_error(text, start.get()));
        }
        errors.extend(entry_errors(text, tools, |tools| {
            named(text, tools, BTreeMap::new(), BTreeMap::new()).err()
        }));
        errors.extend(entry_errors(text, bases, |bases| {
            named(text, BTreeMap::new(), bases, BTreeMap::new()).err()
        }));
        errors.extend(entry_errors(text, frames, |frames| {
            named(text, BTreeMap::new(), BTreeMap::new(), frames).err()
        }));
        errors.extend(motion_errors(text, &motions.unwrap_or_default()));
        errors.sort_by_key(|error| error.place().span.start);
        errors.dedup_by_key(|error| error.place().span.start);
        errors.truncate(MAX_ERRORS);
        errors
    }
}

/// Errors of the outermost keys that programs do not have.
fn unknown_keys(text: &str) -> Vec<ProgramError> {
    let keys: BTreeMap<String, &RawValue> = serde_json::from_str(text).unwrap_or_default();
    let error = |(key, value): (String, &RawValue)| {
        let alone = serde_json::json!({ key: null }).to_string();
        // A known key alone has another error, such as a missing key.
        let error = serde_json::from_str::<ProgramWire<'_>>(&alone).err()?;
        let message = problem(&error);
        message.starts_with("unknown key ").then(|| ProgramError::Json {
            message,
            motion: None,
            sources: Sources::default(),
            place: key_place(text, value.get()),
        })
    };
    keys.into_iter().filter_map(error).take(MAX_ERRORS).collect()
}

/// Returns the place of the key of `value`, a slice of `text`.
fn key_place(text: &str, value: &str) -> JsonPlace {
    let before = &text[..value.as_ptr().addr() - text.as_ptr().addr()];
    let key = before.trim_end().trim_end_matches(':').trim_end();
    let is_quote = |offset: &usize| {
        // The offset may be within a character.
        let (before, from) = key.as_bytes().split_at(*offset);
        let backslashes = before.iter().rev().take_while(|byte| **byte == b'\\').count();
        from[0] == b'"' && backslashes % 2 == 0
    };
    let start = (0..key.len().saturating_sub(1)).rev().find(is_quote).unwrap_or(0);
    JsonPlace::of_span(text, start..key.len())
}

fn start_error(text: &str, raw: &str) -> Option<ProgramError> {
    match serde_json::from_str::<JsonObject<StartWire>>(raw) {
        Err(error) => Some(json_error(text, raw, None, &error)),
        Ok(JsonObject(wire)) => wire.start().err().map(|message| ProgramError::Json {
            message: format!("the start pose: {message}"),
            motion: None,
            sources: Sources::default(),
            place: locate(text, &[JsonStep::Key("start")]),
        }),
    }
}

/// Errors of named tools, bases or frames. `check` returns the error of a list with one entry.
fn entry_errors<T: DeserializeOwned>(
    text: &str,
    list: Option<&RawValue>,
    check: impl Fn(BTreeMap<String, T>) -> Option<ProgramError>,
) -> Vec<ProgramError> {
    let entries = list.and_then(|list| serde_json::from_str(list.get()).ok());
    let entries: BTreeMap<String, &RawValue> = entries.unwrap_or_default();
    let error =
        |(name, raw): (String, &RawValue)| match serde_json::from_str::<JsonObject<T>>(raw.get()) {
            Err(error) => Some(json_error(text, raw.get(), None, &error)),
            Ok(JsonObject(wire)) => check(BTreeMap::from([(name, wire)])),
        };
    entries.into_iter().filter_map(error).take(MAX_ERRORS).collect()
}

/// Errors of motions, each at the place where the motion is written: once for all rounds of a
/// repeat block.
fn motion_errors(text: &str, motions: &[&RawValue]) -> Vec<ProgramError> {
    let mut reader = EntryReader::new(text, MAX_ERRORS);
    let program = reader.program(Program::from_deg([0.0; 7]).build(), motions);
    let mut is_reported = vec![false; reader.paths.len()];
    let entries = program.checked_entries(0..program.motions.len());
    let faults = entries.zip(&reader.written).filter_map(|(entry, written)| {
        let (reported, path) = (is_reported.get_mut(*written)?, &reader.paths[*written]);
        let fault = if *reported { None } else { program.check_entry(&entry).err() }?;
        *reported = true;
        let place = fault.place_at(text, path);
        Some(ProgramError::Fault { fault, sources: program.sources.clone(), place })
    });
    let faults: Vec<_> = faults.take(MAX_ERRORS).collect();
    let mut errors = reader.errors;
    errors.extend(faults);
    errors
}
