//! Entries of motion lists: their places, and the size of repeat blocks, which is bounded.

use iiwa_json::JsonStep;

use crate::{
    cartesian_motion::{CartesianMotion, Circ, Course, SegmentCourse},
    motion_label::MotionLabel,
    program::Motion,
    repeat_block::{MAX_REPEATED, MAX_REPEATED_TEXT},
    source::Source,
    target::TargetRef,
};

/// Place of an entry of a motion list, which may be the list of a repeat block.
#[derive(Clone, Copy)]
pub(super) struct EntryPlace<'a> {
    /// Place of the block; `None` in the list of the program.
    pub(super) block: Option<&'a EntryPlace<'a>>,
    /// Index in the list.
    pub(super) index: usize,
}

impl EntryPlace<'_> {
    /// Path from the program to the entry.
    pub(super) fn path(&self) -> Vec<JsonStep<'static>> {
        let mut path = self.block.map(EntryPlace::path).unwrap_or_default();
        path.extend([JsonStep::Key("motions"), JsonStep::Index(self.index)]);
        path
    }

    /// Number of blocks that contain the entry.
    pub(super) fn depth(&self) -> usize {
        self.block.map_or(0, |block| 1 + block.depth())
    }
}

/// Size of motions in blocks, which is bounded.
#[derive(Clone, Copy, Default)]
pub(super) struct BlockSize {
    /// Number of motions, where each segment of a spline and each shape of a load counts.
    motions: usize,
    /// Length of labels, sources and names, in bytes. All rounds share the mesh files of loads.
    text: usize,
}

impl BlockSize {
    pub(super) fn of(motion: &Motion, label: &MotionLabel, source: Option<&Source>) -> Self {
        let motions = match motion {
            Motion::Cartesian(cartesian) => match &cartesian.course {
                Course::Spline(segments) => segments.len(),
                _ => 1,
            },
            Motion::Load(Some(payload)) => 1 + payload.shapes.len(),
            Motion::Ptp(_) | Motion::Wait { .. } | Motion::Io(_) | Motion::Load(None) => 1,
        };
        let MotionLabel { name, comment, group } = label;
        let notes: usize =
            [name, comment, group].into_iter().map(|text| length(text.as_deref())).sum();
        let names = match motion {
            Motion::Cartesian(cartesian) => names(cartesian),
            Motion::Io(entry) => entry.io.len(),
            Motion::Ptp(_) | Motion::Wait { .. } | Motion::Load(_) => 0,
        };
        Self { motions, text: notes + source.map_or(0, |source| source.file.len()) + names }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            motions: self.motions.saturating_add(other.motions),
            text: self.text.saturating_add(other.text),
        }
    }

    pub(super) fn times(self, count: usize) -> Self {
        Self { motions: self.motions.saturating_mul(count), text: self.text.saturating_mul(count) }
    }

    /// Reason why blocks of this size are not accepted.
    pub(super) fn fault(self) -> Option<String> {
        let Self { motions, text } = self;
        let too_large = |found: usize, unit: &str, max: usize| {
            format!(
                "written out, the repeat blocks have {found} {unit}; at most {max} are allowed; \
                 repeat fewer motions or rounds"
            )
        };
        if motions > MAX_REPEATED {
            let unit = "motions, spline segments and load shapes";
            Some(too_large(motions, unit, MAX_REPEATED))
        } else if text > MAX_REPEATED_TEXT {
            Some(too_large(text, "bytes of names, comments and other texts", MAX_REPEATED_TEXT))
        } else {
            None
        }
    }
}

fn length(text: Option<&str>) -> usize {
    text.map_or(0, str::len)
}

/// Length of the names of tools, bases and frames.
fn names(motion: &CartesianMotion) -> usize {
    let circle = |circ: &Circ| target(&circ.aux) + target(&circ.to);
    let course = match &motion.course {
        Course::Ptp { to } | Course::Lin { to } => target(to),
        Course::LinRel { within, .. } => within.as_ref().map_or(0, target),
        Course::Circ(circ) => circle(circ),
        Course::Spline(segments) => {
            let of_segment = |course: &SegmentCourse| match course {
                SegmentCourse::Spl { to } | SegmentCourse::Lin { to } => target(to),
                SegmentCourse::Circ(circ) => circle(circ),
            };
            segments.iter().map(|segment| of_segment(&segment.course)).sum()
        }
    };
    length(motion.tool.as_deref()) + length(motion.base.as_deref()) + course
}

fn target(target: &TargetRef) -> usize {
    match target {
        TargetRef::Named(name) => name.len(),
        TargetRef::Given(target) => length(target.base.as_deref()),
    }
}
