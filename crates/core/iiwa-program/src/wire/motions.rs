//! JSON form of motions.

use iiwa_json::{JsonObject, JsonStep, are_known, locate, object_or_null, tag, unknown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};
use serde_json::value::RawValue;

use super::{
    cartesian::{CircWire, LinRelWire, LinWire},
    error::{ProgramError, json_error},
    frames::LoadWire,
    ptp::PtpWire,
    source::{SourceWire, source_in},
    spline::{SplWire, SplineWire, WrongSegment},
    wait::WaitWire,
};
use crate::{
    cartesian_motion::{Course, SegmentCourse, SplineSegment},
    motion_index::MotionIndex,
    program::{Motion, Program},
    source::{Source, Sources},
};

/// Writes a motion as in a program, joints in rad.
impl Serialize for Motion {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        MotionWire::from(self).serialize(serializer)
    }
}

/// Program with these motions, checked as far as possible without a robot.
pub(super) fn checked(
    text: &str,
    program: Program,
    motions: &[&RawValue],
) -> Result<Program, ProgramError> {
    let mut read = Vec::with_capacity(motions.len());
    let mut sources = Sources::default();
    for (index, raw) in motions.iter().enumerate() {
        let (motion, source) = motion(text, index, raw.get())
            .map_err(|error| error.with_source(source_in(raw.get())))?;
        read.push(motion);
        if let Some(source) = source {
            sources.insert(MotionIndex::new(index), source);
        }
    }
    let program = Program { motions: read, sources, ..program };
    match program.check_numbers() {
        Ok(()) => Ok(program),
        Err(fault) => {
            let place = fault.place_in(text);
            Err(ProgramError::Fault { fault, sources: program.sources, place })
        }
    }
}

fn motion(text: &str, index: usize, raw: &str) -> Result<(Motion, Option<Source>), ProgramError> {
    let motion = Some(MotionIndex::new(index));
    let fail = |error: serde_json::Error| json_error(text, raw, motion, &error);
    let wrong = |message: String, path: &[JsonStep<'_>]| {
        let path = [&[JsonStep::Key("motions"), JsonStep::Index(index)], path].concat();
        ProgramError::Json { message, motion, made_from: None, place: locate(text, &path) }
    };
    let at_key = |(key, message): (&str, String)| wrong(message, &[JsonStep::Key(key)]);
    let mut wire = match tag(raw).map_err(fail)?.as_deref() {
        Some("ptp") => object(raw).map(MotionWire::Ptp),
        Some("lin") => object(raw).map(MotionWire::Lin),
        Some("lin_rel") => object(raw).map(MotionWire::LinRel),
        Some("circ") => object(raw).map(MotionWire::Circ),
        Some("spl") => object(raw).map(MotionWire::Spl),
        Some("spline") => object(raw).map(MotionWire::Spline),
        Some("wait") => object(raw).map(MotionWire::Wait),
        Some("load") => object(raw).map(MotionWire::Load),
        Some(other) => {
            return Err(wrong(unknown("type", other, &KNOWN_TYPES), &[JsonStep::Key("type")]));
        }
        None => return Err(wrong(format!("it has no `type`; {}", are_known(&KNOWN_TYPES)), &[])),
    }
    .map_err(fail)?;
    let source = wire.source_mut().take().map(SourceWire::source).transpose();
    let source = source.map_err(|message| wrong(message.to_owned(), &[JsonStep::Key("source")]))?;
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
        MotionWire::Load(wire) => Ok(Motion::Load(wire.load.map(Into::into))),
    };
    Ok((motion?, source))
}

/// Reads an object.
fn object<'a, T: Deserialize<'a>>(raw: &'a str) -> Result<T, serde_json::Error> {
    serde_json::from_str::<JsonObject<T>>(raw).map(|JsonObject(wire)| wire)
}

/// Names of the motion types.
const KNOWN_TYPES: [&str; 8] = ["ptp", "lin", "lin_rel", "circ", "spline", "spl", "wait", "load"];

/// An entry of the motion list.
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
}

impl MotionWire {
    /// Converts a motion, with its source, to the JSON form of programs.
    pub(super) fn new(motion: &Motion, source: Option<&Source>) -> Self {
        let mut wire = Self::from(motion);
        *wire.source_mut() = source.map(SourceWire::from);
        wire
    }

    fn source_mut(&mut self) -> &mut Option<SourceWire> {
        match self {
            Self::Ptp(wire) => &mut wire.source,
            Self::Lin(wire) => wire.source_mut(),
            Self::LinRel(wire) => wire.source_mut(),
            Self::Circ(wire) => wire.source_mut(),
            Self::Spline(wire) => wire.source_mut(),
            Self::Spl(wire) => wire.source_mut(),
            Self::Wait(wire) => &mut wire.source,
            Self::Load(wire) => &mut wire.source,
        }
    }
}

/// Converts the motions, with their sources, to the JSON form of programs.
pub(super) fn motions_out(motions: &[Motion], sources: &Sources) -> Vec<MotionWire> {
    let motions = (0..).map(MotionIndex::new).zip(motions);
    motions.map(|(index, motion)| MotionWire::new(motion, sources.of(index))).collect()
}

#[derive(Deserialize, Serialize, JsonSchema)]
#[schemars(inline)]
enum LoadTag {
    #[serde(rename = "load")]
    Load,
}

/// A payload change, for which the robot is at rest. It takes no time.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "LoadStep", extend("required" = ["type", "load"]))]
pub(super) struct LoadStepWire {
    r#type: LoadTag,
    /// Total payload from here on, tool included; null to return to the tool's payload.
    #[serde(deserialize_with = "object_or_null")]
    load: Option<LoadWire>,
    /// Source line of the motion.
    #[serde(default, deserialize_with = "object_or_null", skip_serializing_if = "Option::is_none")]
    source: Option<SourceWire>,
}

impl From<&Motion> for MotionWire {
    fn from(motion: &Motion) -> Self {
        match motion {
            Motion::Load(load) => Self::Load(LoadStepWire {
                r#type: LoadTag::Load,
                load: load.as_ref().map(LoadWire::from),
                source: None,
            }),
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
