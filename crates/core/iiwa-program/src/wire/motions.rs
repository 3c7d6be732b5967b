//! JSON form of motions.

use iiwa_json::{JsonObject, JsonStep, are_known, excerpt, locate, object_or_null, tag, unknown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};
use serde_json::Value;

use super::{
    block_size::EntryPlace,
    cartesian::{CircWire, LinRelWire, LinWire},
    error::{ProgramError, json_error},
    io::{IoWire, SetWire, WaitForWire},
    notes::{NotesMut, noted_wire},
    ptp::PtpWire,
    repeat::REPEAT,
    shapes::LoadWire,
    spline::{SplWire, SplineWire, WrongSegment},
    wait::WaitWire,
};
use crate::{
    cartesian_motion::{Course, SegmentCourse, SplineSegment},
    flange_load::ShapeFault,
    motion_index::MotionIndex,
    motion_label::MotionLabel,
    motion_type::MotionType,
    program::Motion,
    source::{Source, Sources},
};

/// Writes a motion as in a program, joints in rad.
impl Serialize for Motion {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        MotionWire::from(self).serialize(serializer)
    }
}

/// Type of an entry of a motion list.
pub(super) enum EntryType {
    Motion(MotionType),
    Repeat,
}

/// Reads the type of the entry `raw` of the program `text`. A block has the index of its first
/// motion.
pub(super) fn entry_type(
    text: &str,
    place: &EntryPlace<'_>,
    motion: MotionIndex,
    raw: &str,
) -> Result<EntryType, ProgramError> {
    let tag = tag(raw).map_err(|error| json_error(text, raw, Some(motion), &error))?;
    let known = || [MotionType::NAMES.as_slice(), &[REPEAT]].concat();
    let Some(name) = tag.as_deref() else {
        let message = format!("it has no `type`; {}", are_known(&known()));
        return Err(wrong(text, place, motion, message, &[]));
    };
    if name == REPEAT {
        return Ok(EntryType::Repeat);
    }
    let message = match (MotionType::from_name(name), MotionType::of_other_language(name)) {
        (Some(motion_type), _) => return Ok(EntryType::Motion(motion_type)),
        (None, Some(meant)) => {
            format!("unknown type `{}`; did you mean `{}`?", excerpt(name), meant.name())
        }
        (None, None) => match name.to_ascii_lowercase().as_str() {
            "for" | "loop" | "while" => {
                format!("unknown type `{}`; did you mean `{REPEAT}`?", excerpt(name))
            }
            _ => unknown("type", name, &known()),
        },
    };
    Err(wrong(text, place, motion, message, &[JsonStep::Key("type")]))
}

/// Error of an entry, at a path within the entry.
fn wrong(
    text: &str,
    place: &EntryPlace<'_>,
    motion: MotionIndex,
    message: String,
    path: &[JsonStep<'_>],
) -> ProgramError {
    let place = locate(text, &[place.path().as_slice(), path].concat());
    ProgramError::Json { message, motion: Some(motion), sources: Sources::default(), place }
}

/// Reads the motion `raw` of the program `text`, with its label and its source.
pub(super) fn motion(
    text: &str,
    place: &EntryPlace<'_>,
    motion: MotionIndex,
    raw: &str,
    motion_type: MotionType,
) -> Result<(Motion, MotionLabel, Option<Source>), ProgramError> {
    let fail = |error: serde_json::Error| json_error(text, raw, Some(motion), &error);
    let wrong = |message: String, path: &[JsonStep<'_>]| wrong(text, place, motion, message, path);
    let at_key = |(key, message): (&str, String)| wrong(message, &[JsonStep::Key(key)]);
    let mut wire = match motion_type {
        MotionType::Ptp | MotionType::PtpToFrame => object(raw).map(MotionWire::Ptp),
        MotionType::Lin => object(raw).map(MotionWire::Lin),
        MotionType::LinRel => object(raw).map(MotionWire::LinRel),
        MotionType::Circ => object(raw).map(MotionWire::Circ),
        MotionType::Spl => object(raw).map(MotionWire::Spl),
        MotionType::Spline => object(raw).map(MotionWire::Spline),
        MotionType::Wait => object(raw).map(MotionWire::Wait),
        MotionType::Load => object(raw).map(MotionWire::Load),
        MotionType::Set => object(raw).map(MotionWire::Set),
        MotionType::WaitFor => object(raw).map(MotionWire::WaitFor),
    }
    .map_err(fail)?;
    let (label, source) = wire.notes_mut().take();
    if let Some(fault) = label.fault() {
        return Err(at_key(fault));
    }
    if let Some((key, message)) = source.as_ref().and_then(Source::fault) {
        return Err(wrong(message, &[JsonStep::Key("source"), JsonStep::Key(key)]));
    }
    let motion = match wire {
        MotionWire::Ptp(wire) => wire.motion().map_err(|message| wrong(message, &[])),
        MotionWire::Spline(wire) => {
            wire.motion().map_err(|WrongSegment { index, key, message }| {
                let path = [JsonStep::Key("segments"), JsonStep::Index(index), JsonStep::Key(key)];
                wrong(format!("segment {}: {message}", index + 1), &path)
            })
        }
        MotionWire::Lin(wire) => wire.motion().map_err(at_key),
        MotionWire::LinRel(wire) => wire.motion().map_err(at_key),
        MotionWire::Circ(wire) => wire.motion().map_err(at_key),
        MotionWire::Spl(wire) => wire.motion().map_err(at_key),
        MotionWire::Wait(wire) => wire.motion().map_err(at_key),
        MotionWire::Set(wire) => wire.motion().map_err(at_key),
        MotionWire::WaitFor(wire) => wire.motion().map_err(at_key),
        MotionWire::Load(wire) => wire.motion().map_err(|fault| {
            let mut path = vec![JsonStep::Key("load"), JsonStep::Key("shapes")];
            let key = JsonStep::Key(fault.key);
            path.extend(fault.shape.into_iter().flat_map(|it| [JsonStep::Index(it), key]));
            wrong(fault.to_string(), &path)
        }),
    };
    Ok((motion?, label, source))
}

/// Source and name of a motion that is otherwise unreadable; unsuitable ones are left out.
pub(super) fn sources_in(index: MotionIndex, motion: &str) -> Sources {
    #[derive(Deserialize)]
    struct Noted {
        #[serde(default)]
        name: Value,
        #[serde(default)]
        source: Value,
    }
    let mut sources = Sources::default();
    if let Ok(JsonObject(Noted { name, source })) = serde_json::from_str(motion) {
        let label = name.as_str().map(MotionLabel::named).unwrap_or_default();
        if label.fault().is_none() {
            sources.insert_label(index, label);
        }
        let source = serde_json::from_value(source).ok();
        if let Some(source) = source.filter(|source: &Source| source.fault().is_none()) {
            sources.insert(index, source);
        }
    }
    sources
}

/// Reads an object.
fn object<'a, T: Deserialize<'a>>(raw: &'a str) -> Result<T, serde_json::Error> {
    serde_json::from_str::<JsonObject<T>>(raw).map(|JsonObject(wire)| wire)
}

/// A motion of the motion list.
#[derive(Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "Motion")]
pub(super) enum MotionWire {
    Ptp(PtpWire),
    Lin(LinWire),
    LinRel(LinRelWire),
    Circ(CircWire),
    Spline(SplineWire),
    Spl(SplWire),
    Wait(WaitWire),
    Load(LoadStepWire),
    Set(SetWire),
    WaitFor(WaitForWire),
}

impl MotionWire {
    /// Converts a motion, with its label and its source, to the JSON form of programs.
    pub(super) fn new(
        motion: &Motion,
        label: Option<&MotionLabel>,
        source: Option<&Source>,
    ) -> Self {
        let mut wire = Self::from(motion);
        wire.notes_mut().set(label, source);
        wire
    }

    fn notes_mut(&mut self) -> NotesMut<'_> {
        match self {
            Self::Ptp(wire) => wire.notes_mut(),
            Self::Lin(wire) => wire.notes_mut(),
            Self::LinRel(wire) => wire.notes_mut(),
            Self::Circ(wire) => wire.notes_mut(),
            Self::Spline(wire) => wire.notes_mut(),
            Self::Spl(wire) => wire.notes_mut(),
            Self::Wait(wire) => wire.notes_mut(),
            Self::Load(wire) => wire.notes_mut(),
            Self::Set(wire) => wire.notes_mut(),
            Self::WaitFor(wire) => wire.notes_mut(),
        }
    }
}

#[derive(Deserialize, Serialize, JsonSchema)]
#[schemars(inline)]
enum LoadTag {
    #[serde(rename = "load")]
    Load,
}

noted_wire! {
/// A payload change, for which the robot is at rest. It takes no time.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "LoadStep", extend("required" = ["type", "load"]))]
pub(super) struct LoadStepWire {
    r#type: LoadTag,
    /// Total payload from here on, tool included; null to return to the tool's payload.
    #[serde(deserialize_with = "object_or_null")]
    load: Option<LoadWire>,
}
}

impl LoadStepWire {
    fn motion(self) -> Result<Motion, ShapeFault> {
        let payload = self.load.map(LoadWire::payload).transpose()?;
        if payload.as_ref().is_some_and(|it| it.load.mass_kg == 0.0 && !it.shapes.is_empty()) {
            let message = "a load without mass has no shapes: state its mass, or remove `shapes`";
            return Err(ShapeFault { shape: None, key: "shapes", message: message.to_owned() });
        }
        Ok(Motion::Load(payload))
    }
}

impl From<&Motion> for MotionWire {
    fn from(motion: &Motion) -> Self {
        match motion {
            Motion::Load(load) => Self::Load(LoadStepWire {
                r#type: LoadTag::Load,
                load: load.as_ref().map(LoadWire::from),
                name: None,
                comment: None,
                group: None,
                source: None,
            }),
            Motion::Io(entry) => match IoWire::from(entry) {
                IoWire::Set(wire) => Self::Set(wire),
                IoWire::WaitFor(wire) => Self::WaitFor(wire),
            },
            Motion::Wait { seconds, overlap } => Self::Wait(WaitWire::new(*seconds, *overlap)),
            Motion::Ptp(ptp) => Self::Ptp(PtpWire::to_joints(ptp)),
            Motion::Cartesian(cartesian) => match &cartesian.course {
                Course::Ptp { to } => Self::Ptp(PtpWire::to_frame(cartesian, to)),
                Course::Lin { to } => Self::Lin(LinWire::new(cartesian, to)),
                Course::LinRel { offset, e1_rad, within } => {
                    Self::LinRel(LinRelWire::new(cartesian, offset, *e1_rad, within.as_ref()))
                }
                Course::Circ(circ) => Self::Circ(CircWire::new(cartesian, circ)),
                Course::Spline(segments) => match segments.as_slice() {
                    [SplineSegment { course: SegmentCourse::Spl { to }, .. }]
                        if cartesian.is_single_spl() =>
                    {
                        Self::Spl(SplWire::new(cartesian, to))
                    }
                    segments => Self::Spline(SplineWire::new(cartesian, segments)),
                },
            },
        }
    }
}
