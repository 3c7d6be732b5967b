//! Motions in JSON.

use iiwa_json::{Object, Step, are_known, locate, tag, unknown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};
use serde_json::value::RawValue;

use super::{
    cartesian::{CircWire, LinRelWire, LinWire},
    error::{ProgramError, json_error},
    ptp::PtpWire,
    spline::{SplWire, SplineWire, WrongSegment},
};
use crate::{
    cartesian_motion::{Course, SegmentCourse, SplineSegment},
    motion_index::MotionIndex,
    program::{Motion, Program},
};

/// As in a program, joints in rad.
impl Serialize for Motion {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        MotionWire::from(self).serialize(serializer)
    }
}

/// The program with these motions, checked as far as it can be without a robot.
pub(super) fn checked(
    text: &str,
    program: Program,
    motions: &[&RawValue],
) -> Result<Program, ProgramError> {
    let motions = motions.iter().enumerate().map(|(index, raw)| motion(text, index, raw.get()));
    let program = Program { motions: motions.collect::<Result<_, _>>()?, ..program };
    match program.check_numbers() {
        Ok(()) => Ok(program),
        Err(fault) => Err(ProgramError::Fault { place: fault.place_in(text), fault }),
    }
}

fn motion(text: &str, index: usize, raw: &str) -> Result<Motion, ProgramError> {
    let motion = Some(MotionIndex::new(index));
    let fail = |error: serde_json::Error| json_error(text, raw, motion, &error);
    let wrong = |what: String, key: Option<&str>| {
        let path = [Step::Key("motions"), Step::Index(index)].into_iter().chain(key.map(Step::Key));
        let place = locate(text, &path.collect::<Vec<_>>());
        ProgramError::Json { what, motion, place }
    };
    match tag(raw).map_err(fail)?.as_deref() {
        Some("ptp") => {
            let Object(wire) = serde_json::from_str::<Object<PtpWire>>(raw).map_err(fail)?;
            wire.motion().map_err(|what| wrong(what, None))
        }
        Some("lin") => {
            let Object(wire) = serde_json::from_str::<Object<LinWire>>(raw).map_err(fail)?;
            wire.motion().map_err(|(key, what)| wrong(what, Some(key)))
        }
        Some("lin_rel") => {
            let Object(wire) = serde_json::from_str::<Object<LinRelWire>>(raw).map_err(fail)?;
            wire.motion().map_err(|(key, what)| wrong(what, Some(key)))
        }
        Some("circ") => {
            let Object(wire) = serde_json::from_str::<Object<CircWire>>(raw).map_err(fail)?;
            wire.motion().map_err(|(key, what)| wrong(what, Some(key)))
        }
        Some("spl") => {
            let Object(wire) = serde_json::from_str::<Object<SplWire>>(raw).map_err(fail)?;
            wire.motion().map_err(|(key, what)| wrong(what, Some(key)))
        }
        Some("spline") => {
            let Object(wire) = serde_json::from_str::<Object<SplineWire>>(raw).map_err(fail)?;
            wire.motion().map_err(|WrongSegment { index: segment, key, what }| {
                let path = [Step::Key("motions"), Step::Index(index), Step::Key("segments")];
                let path = [&path[..], &[Step::Index(segment), Step::Key(key)]].concat();
                let what = format!("segment {}: {what}", segment + 1);
                ProgramError::Json { what, motion, place: locate(text, &path) }
            })
        }
        Some("wait") => {
            let Object(wire) = serde_json::from_str::<Object<WaitWire>>(raw).map_err(fail)?;
            Ok(Motion::Wait { seconds: wire.seconds })
        }
        Some(other) => Err(wrong(unknown("type", other, &KNOWN_TYPES), Some("type"))),
        None => Err(wrong(format!("it has no `type`; {}", are_known(&KNOWN_TYPES)), None)),
    }
}

/// The types of motions.
const KNOWN_TYPES: [&str; 7] = ["ptp", "lin", "lin_rel", "circ", "spline", "spl", "wait"];

/// One entry of the list of motions.
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
}

#[derive(Deserialize, Serialize, JsonSchema)]
#[schemars(inline)]
enum WaitTag {
    #[serde(rename = "wait")]
    Wait,
}

/// The arm stands still.
#[derive(Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Wait")]
pub(super) struct WaitWire {
    r#type: WaitTag,
    /// For how long, in s: at most a day.
    #[schemars(range(min = 0, max = 86_400))]
    seconds: f64,
}

impl From<&Motion> for MotionWire {
    fn from(motion: &Motion) -> Self {
        match motion {
            Motion::Wait { seconds } => {
                Self::Wait(WaitWire { r#type: WaitTag::Wait, seconds: *seconds })
            }
            Motion::Ptp(ptp) => {
                let shares = [ptp.velocity_rel, ptp.acceleration_rel, ptp.jerk_rel];
                Self::Ptp(PtpWire::to_joints(&ptp.target_rad, shares, ptp.blend))
            }
            Motion::Cartesian(own) => match &own.course {
                Course::Ptp { to } => Self::Ptp(PtpWire::to_frame(own, to)),
                Course::Lin { to } => Self::Lin(LinWire::new(own, to)),
                Course::LinRel { offset, e1_rad, within } => {
                    Self::LinRel(LinRelWire::new(own, offset, *e1_rad, within.as_ref()))
                }
                Course::Circ(circ) => Self::Circ(CircWire::new(own, circ)),
                Course::Spline(segments) => match segments.as_slice() {
                    [SplineSegment { course: SegmentCourse::Spl { to }, .. }]
                        if own.is_single_spl() =>
                    {
                        Self::Spl(SplWire::new(own, to))
                    }
                    segments => Self::Spline(SplineWire::new(own, segments)),
                },
            },
        }
    }
}
