//! Files of tools, bases and frames that programs include.

use std::collections::BTreeMap;

use iiwa_json::{JsonStep, Unread, locate, read_version, without_mark};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, de::IgnoredAny};
use serde_json::value::RawValue;

use super::{
    by_name::by_name,
    error::{ProgramError, VERSION, json_error},
    frames::{BaseWire, TargetWire, ToolWire},
    workcell::named,
};
use crate::{program::Program, source::Sources, workcell::Workcell};

/// Tools, bases and frames of a workcell, for the programs that include them.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "iiwasim frames", rename = "Frames")]
struct FramesWire {
    /// URL or path of the JSON Schema of this format, for editors; otherwise unused.
    #[serde(default, rename = "$schema", skip_serializing)]
    #[expect(dead_code, reason = "it is for editors")]
    schema: Option<String>,
    /// Version of this format.
    #[schemars(extend("const" = 1))]
    version: u64,
    /// Tools by name.
    #[serde(default, deserialize_with = "by_name", skip_serializing_if = "BTreeMap::is_empty")]
    tools: BTreeMap<String, ToolWire>,
    /// Reference frames for other frames, by name.
    #[serde(default, deserialize_with = "by_name", skip_serializing_if = "BTreeMap::is_empty")]
    bases: BTreeMap<String, BaseWire>,
    /// Target frames, by name.
    #[serde(default, deserialize_with = "by_name", skip_serializing_if = "BTreeMap::is_empty")]
    frames: BTreeMap<String, TargetWire>,
    /// Key of programs only, read here to give a specific error.
    #[serde(default, skip_serializing)]
    #[schemars(skip)]
    include: Option<IgnoredAny>,
}

impl Workcell {
    /// Reads the tools, bases and frames that programs include, in the format of
    /// [`to_json`](Self::to_json).
    ///
    /// ```
    /// use iiwa_program::Workcell;
    ///
    /// let text = r#"{ "version": 1, "bases": { "table": { "x_mm": 500 } } }"#;
    /// let cell = Workcell::from_json(text)?;
    /// assert_eq!(cell.bases["table"].frame.xyz_mm, [500.0, 0.0, 0.0]);
    /// assert_eq!(Workcell::from_json(&cell.to_json())?, cell);
    /// # Ok::<(), iiwa_program::ProgramError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the text is something else; the error gives the place in the text.
    pub fn from_json(text: &str) -> Result<Self, ProgramError> {
        let text = without_mark(text);
        let wire =
            read_version(text, VERSION, |wire: &FramesWire| wire.version).map_err(|error| {
                match error {
                    Unread::Version { found, place } => ProgramError::Json {
                        message: format!(
                            "these are frames of version {found}; version {VERSION} is understood"
                        ),
                        motion: None,
                        sources: Sources::default(),
                        place,
                    },
                    error @ Unread::Json(_) => ProgramError::unread(text, error),
                }
            })?;
        if wire.include.is_some() {
            let message = "an included file cannot include other files".to_owned();
            let place = locate(text, &[JsonStep::Key("include")]);
            return Err(ProgramError::Json {
                message,
                motion: None,
                sources: Sources::default(),
                place,
            });
        }
        named(text, wire.tools, wire.bases, wire.frames)
    }

    /// Writes the tools, bases and frames as JSON (version 1), for programs to include. The tool
    /// and base in use are not written: programs choose them.
    #[must_use]
    pub fn to_json(&self) -> String {
        let wire = FramesWire {
            schema: None,
            version: VERSION,
            tools: self.tools.iter().map(|(name, tool)| (name.clone(), tool.into())).collect(),
            bases: self.bases.iter().map(|(name, base)| (name.clone(), base.into())).collect(),
            frames: self.frames.iter().map(|(name, to)| (name.clone(), to.into())).collect(),
            include: None,
        };
        // Serialisation can only fail for a map whose keys are not strings.
        serde_json::to_string_pretty(&wire).unwrap_or_default()
    }

    /// JSON Schema of a file of tools, bases and frames (draft 2020-12).
    #[must_use]
    pub fn schema() -> serde_json::Value {
        schemars::schema_for!(FramesWire).to_value()
    }
}

/// Keys of an object with their unparsed values.
type RawKeys<'a> = BTreeMap<String, &'a RawValue>;

impl Program {
    /// Merges a program text with its included file, so that it needs no other file. Keeps the
    /// original text of everything that [`from_json_with`](Self::from_json_with) reads of the two.
    ///
    /// ```
    /// use iiwa_program::Program;
    ///
    /// let text = r#"{ "version": 1, "include": "cell.json", "frames": {},
    ///                 "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
    ///                 "motions": [{ "type": "wait", "seconds": 1 }] }"#;
    /// let cell = r#"{ "version": 1, "bases": { "table": { "x_mm": 500 } } }"#;
    /// let program = Program::from_json(&Program::merged_json(text, cell)?)?;
    /// assert_eq!(program.workcell.bases["table"].frame.xyz_mm, [500.0, 0.0, 0.0]);
    /// # Ok::<(), iiwa_program::ProgramError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If one of the two texts is not a JSON object; neither is checked further.
    pub fn merged_json(text: &str, included: &str) -> Result<String, ProgramError> {
        fn read<'a, T: Deserialize<'a>>(text: &'a str, part: &'a str) -> Result<T, ProgramError> {
            serde_json::from_str(part).map_err(|error| json_error(text, part, None, &error))
        }
        let [text, included] = [text, included].map(without_mark);
        let mut program: RawKeys<'_> = read(text, text)?;
        let file: RawKeys<'_> = read(included, included)?;
        program.remove("include");
        let mut lists = Vec::new();
        for list in ["tools", "bases", "frames"] {
            let Some(added) = file.get(list) else { continue };
            let mut merged: RawKeys<'_> = read(included, added.get())?;
            if let Some(overrides) = program.get(list) {
                merged.extend(read::<RawKeys<'_>>(text, overrides.get())?);
            }
            // Values that were just read can be written.
            lists.push((list, serde_json::value::to_raw_value(&merged).unwrap_or_default()));
        }
        program.extend(lists.iter().map(|(list, merged)| ((*list).to_owned(), merged.as_ref())));
        Ok(serde_json::to_string_pretty(&program).unwrap_or_default())
    }
}

/// Reads the file `name` that the program `text` includes.
pub(super) fn included(
    text: &str,
    name: &str,
    read: impl FnOnce(&str) -> Result<String, String>,
) -> Result<Workcell, ProgramError> {
    let place = || locate(text, &[JsonStep::Key("include")]);
    let file = read(name).map_err(|reason| ProgramError::Include {
        name: name.to_owned(),
        reason,
        place: place(),
    })?;
    Workcell::from_json(&file).map_err(|error| ProgramError::Included {
        name: name.to_owned(),
        text: file,
        error: Box::new(error),
        place: place(),
    })
}

/// Reader for texts without access to files.
pub(super) fn no_files(_: &str) -> Result<String, String> {
    Err("only the text of the program is available, but no other file".to_owned())
}
