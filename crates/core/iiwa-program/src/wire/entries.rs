//! Motion lists with repeat blocks: reading with the motions of all rounds, and writing.

use std::ops::Range;

use iiwa_json::{JsonObject, JsonStep, locate};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use super::{
    block_size::{BlockSize, EntryPlace},
    error::{ProgramError, json_error},
    motions::{EntryType, MotionWire, entry_type, motion as read_motion, sources_in},
    repeat::RepeatWire,
};
use crate::{
    motion_index::MotionIndex,
    motion_label::MotionLabel,
    program::{Motion, Program, Ptp},
    repeat_block::{MAX_REPEAT_DEPTH, MAX_REPEATED, RepeatBlock},
    source::{Source, Sources},
};

/// An entry of a motion list.
#[derive(Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "Entry")]
pub(super) enum EntryWire {
    Motion(Box<MotionWire>),
    Repeat(RepeatWire<EntryWire>),
}

/// Program with these motions, checked as far as possible without a robot.
pub(super) fn checked(
    text: &str,
    program: Program,
    motions: &[&RawValue],
) -> Result<Program, ProgramError> {
    let mut reader = EntryReader::new(text, 1);
    let program = reader.program(program, motions);
    if let Some(error) = reader.errors.pop() {
        return Err(error);
    }
    match program.check_numbers() {
        Ok(()) => Ok(program),
        Err(fault) => {
            let place = fault.place_in(text);
            Err(ProgramError::Fault { fault, sources: program.sources, place })
        }
    }
}

/// Motion of a round, with the place where the motion is written.
#[derive(Clone)]
struct ReadMotion {
    motion: Motion,
    label: MotionLabel,
    source: Option<Source>,
    written: usize,
}

/// Motions of a list with the motions of all rounds, and its blocks.
#[derive(Default)]
struct ReadList {
    motions: Vec<ReadMotion>,
    blocks: Vec<RepeatBlock>,
    size: BlockSize,
}

/// Reader of motion lists.
pub(super) struct EntryReader<'t> {
    text: &'t str,
    /// Errors found, in order.
    pub(super) errors: Vec<ProgramError>,
    max_errors: usize,
    /// Paths to readable motions as written; empty if only one error is reported.
    pub(super) paths: Vec<Vec<JsonStep<'static>>>,
    /// For each motion of the program, its index in `paths`, or [`UNREADABLE`].
    pub(super) written: Vec<usize>,
    /// Size of all blocks so far.
    used: BlockSize,
}

/// Index of a motion that cannot be read.
pub(super) const UNREADABLE: usize = usize::MAX;

impl<'t> EntryReader<'t> {
    /// Reader that stops after a number of errors.
    pub(super) fn new(text: &'t str, max_errors: usize) -> Self {
        Self {
            text,
            errors: Vec::new(),
            max_errors,
            paths: Vec::new(),
            written: Vec::new(),
            used: BlockSize::default(),
        }
    }

    /// Adds the motions of a list to a program without motions. A placeholder replaces each entry
    /// that cannot be read.
    pub(super) fn program(&mut self, mut program: Program, list: &[&RawValue]) -> Program {
        let ReadList { motions, blocks, .. } = self.list(list, None, 0, None);
        program.sources.set_repeats(blocks);
        program.motions.reserve(motions.len());
        for (index, read) in motions.into_iter().enumerate() {
            let ReadMotion { motion, label, source, written } = read;
            program.motions.push(motion);
            program.sources.insert_label(MotionIndex::new(index), label);
            if let Some(source) = source {
                program.sources.insert(MotionIndex::new(index), source);
            }
            if self.max_errors > 1 {
                self.written.push(written);
            }
        }
        program
    }

    /// Returns true if no further errors are reported. Each error reads the text again to find its
    /// place, which takes long for many errors.
    pub(super) fn is_full(&self) -> bool {
        self.errors.len() >= self.max_errors
    }

    /// Reads the list of a block, or of the program. `first` is the index of its first motion in
    /// the program, `group` the group of motions that state none.
    fn list(
        &mut self,
        list: &[&RawValue],
        block: Option<&EntryPlace<'_>>,
        first: usize,
        group: Option<&str>,
    ) -> ReadList {
        let mut read = ReadList::default();
        if block.is_none() {
            read.motions.reserve(list.len());
        }
        for (index, raw) in list.iter().enumerate() {
            let is_too_large = || block.is_some() && self.used.fault().is_some();
            if self.is_full() || is_too_large() {
                break;
            }
            let place = EntryPlace { block, index };
            let motion = MotionIndex::new(first + read.motions.len());
            let added = match entry_type(self.text, &place, motion, raw.get()) {
                Ok(EntryType::Repeat) => self.block(&place, motion, raw.get(), group, &mut read),
                Ok(EntryType::Motion(motion_type)) => {
                    read_motion(self.text, &place, motion, raw.get(), motion_type)
                        .map(|entry| self.motion(&place, entry, group, &mut read))
                }
                Err(error) => Err(error),
            };
            if let Err(error) = added {
                self.errors.push(error.with_sources(sources_in(motion, raw.get())));
                read.motions.push(placeholder());
            }
        }
        read
    }

    fn motion(
        &mut self,
        place: &EntryPlace<'_>,
        (motion, mut label, source): (Motion, MotionLabel, Option<Source>),
        group: Option<&str>,
        list: &mut ReadList,
    ) {
        if label.group.is_none() {
            label.group = group.map(str::to_owned);
        }
        if place.block.is_some() {
            let size = BlockSize::of(&motion, &label, source.as_ref());
            list.size = list.size.plus(size);
            self.used = self.used.plus(size);
        }
        let written = self.paths.len();
        if self.max_errors > 1 {
            self.paths.push(place.path());
        }
        list.motions.push(ReadMotion { motion, label, source, written });
    }

    /// Reads a block whose first motion is `motion`, and adds the motions of all its rounds. A
    /// count with an error is assumed to be 1.
    fn block(
        &mut self,
        place: &EntryPlace<'_>,
        motion: MotionIndex,
        raw: &str,
        group: Option<&str>,
        list: &mut ReadList,
    ) -> Result<(), ProgramError> {
        let text = self.text;
        let wrong = |key: Option<&'static str>, message: String| {
            let path = [place.path(), key.map(JsonStep::Key).into_iter().collect()].concat();
            let place = locate(text, &path);
            ProgramError::Json { message, motion: Some(motion), sources: Sources::default(), place }
        };
        if place.depth() >= MAX_REPEAT_DEPTH {
            return Err(wrong(
                None,
                format!(
                    "repeat blocks are nested more than {MAX_REPEAT_DEPTH} deep; write out one"
                ),
            ));
        }
        let read = serde_json::from_str::<JsonObject<RepeatWire<&RawValue>>>(raw);
        let (block, error) = match read {
            Ok(JsonObject(block)) => {
                let error = block_fault(&block);
                (block, error.map(|(key, message)| wrong(Some(key), message)))
            }
            Err(error) => {
                let error = json_error(text, raw, Some(motion), &error);
                // The motions may be readable, and may have further errors.
                let Ok(JsonObject(MotionsOnly { motions })) = serde_json::from_str(raw) else {
                    return Err(error);
                };
                (RepeatWire::new(1, MotionLabel::default(), motions), Some(error))
            }
        };
        let is_readable = error.is_none();
        let with_name = |error: ProgramError| error.with_sources(sources_in(motion, raw));
        self.errors.extend(error.map(with_name));
        let label = block.label();
        let first = list.motions.len();
        let inner_group = label.group.as_deref().or(group);
        let round = self.list(&block.motions, Some(place), motion.index(), inner_group);
        // A count that does not fit is larger than the bound.
        let mut count =
            if is_readable { usize::try_from(block.count).unwrap_or(usize::MAX) } else { 1 };
        let further = round.size.times(count.saturating_sub(1));
        if let Some(message) = self.used.plus(further).fault() {
            if !self.is_full() {
                self.errors.push(with_name(wrong(Some("count"), message)));
            }
            count = 1;
        } else {
            self.used = self.used.plus(further);
        }
        list.size = list.size.plus(round.size.times(count));
        let motions = round.motions.len();
        list.motions.reserve(motions * count);
        for _ in 1..count {
            list.motions.extend_from_slice(&round.motions);
        }
        list.motions.extend(round.motions);
        if motions > 0 {
            list.blocks.push(RepeatBlock { first, motions, count, label, inner: round.blocks });
        }
        Ok(())
    }
}

/// The motions of a block with errors in other keys.
#[derive(Deserialize)]
struct MotionsOnly<'a> {
    #[serde(borrow)]
    motions: Vec<&'a RawValue>,
}

/// A motion in place of an unreadable entry. Any motion may be before or after a PTP, so that
/// neighbours get no errors because of it.
fn placeholder() -> ReadMotion {
    ReadMotion {
        motion: Motion::Ptp(Ptp::to([0.0; 7])),
        label: MotionLabel::default(),
        source: None,
        written: UNREADABLE,
    }
}

/// Key of a block with the first fault, and the fault.
fn block_fault(block: &RepeatWire<&RawValue>) -> Option<(&'static str, String)> {
    if let Some(fault) = block.label().fault() {
        return Some(fault);
    }
    let count = block.count;
    if !(1..=MAX_REPEATED as u64).contains(&count) {
        let message =
            format!("the repeat block's count is {count}; it must be from 1 to {MAX_REPEATED}");
        return Some(("count", message));
    }
    let message = "the repeat block has no motions; add at least one".to_owned();
    block.motions.is_empty().then_some(("motions", message))
}

/// Converts motions, with their labels and sources, to the JSON form of programs. Blocks whose
/// rounds are the same are written as blocks.
pub(super) fn entries_out(motions: &[Motion], sources: &Sources) -> Vec<EntryWire> {
    let writer = EntryWriter { motions, sources };
    let blocks = sources.repeats();
    let blocks = if writer.is_readable(blocks) { blocks } else { &[] };
    writer.entries(0..motions.len(), blocks, None)
}

/// Converts all motions, those of each round too, to the JSON form of programs.
pub(super) fn motions_out(motions: &[Motion], sources: &Sources) -> Vec<EntryWire> {
    EntryWriter { motions, sources }.entries(0..motions.len(), &[], None)
}

/// Writer of motion lists.
struct EntryWriter<'a> {
    motions: &'a [Motion],
    sources: &'a Sources,
}

impl EntryWriter<'_> {
    /// Returns true if the reader accepts blocks of this size.
    fn is_readable(&self, blocks: &[RepeatBlock]) -> bool {
        let repeated = blocks.iter().flat_map(|block| block.range(0).take(self.motions.len()));
        let sizes = repeated.filter_map(|index| {
            let label = self.label(index).cloned().unwrap_or_default();
            let source = self.sources.of(MotionIndex::new(index));
            Some(BlockSize::of(self.motions.get(index)?, &label, source))
        });
        blocks.iter().all(|block| block.depth() <= MAX_REPEAT_DEPTH)
            && sizes.fold(BlockSize::default(), BlockSize::plus).fault().is_none()
    }

    /// Entries of the motions in `range`, in which the places of `blocks` count from its start.
    fn entries(
        &self,
        range: Range<usize>,
        blocks: &[RepeatBlock],
        group: Option<&str>,
    ) -> Vec<EntryWire> {
        let mut entries = Vec::with_capacity(range.len());
        let mut next = range.start;
        for block in blocks {
            let Range { start, end } = block.range(range.start);
            if start < next || end > range.end {
                // The program has been changed since.
                continue;
            }
            entries.extend((next..start).map(|index| self.entry(index, group)));
            next = end;
            if block.is_intact(range.start, self.motions.len(), &|a, b| self.is_same(a, b)) {
                entries.push(self.block(block, start, group));
            } else {
                let rounds = (start..end).step_by(block.motions.max(1));
                entries.extend(rounds.flat_map(|round| {
                    self.entries(round..round + block.motions, &block.inner, group)
                }));
            }
        }
        entries.extend((next..range.end).map(|index| self.entry(index, group)));
        entries
    }

    fn block(&self, block: &RepeatBlock, start: usize, outer_group: Option<&str>) -> EntryWire {
        let round = start..start + block.motions;
        let mut label = block.label.clone();
        let has_group = |index| self.label(index).is_some_and(|label| label.group.is_some());
        if !round.clone().all(has_group) {
            // A motion has lost its group since.
            label.group = None;
        }
        let group = label.group.as_deref().or(outer_group);
        let motions = self.entries(round, &block.inner, group);
        EntryWire::Repeat(RepeatWire::new(block.count, label, motions))
    }

    /// Entry of a motion in a block whose motions have the group `group` if they state none.
    fn entry(&self, index: usize, group: Option<&str>) -> EntryWire {
        let (motion, source) = (&self.motions[index], self.sources.of(MotionIndex::new(index)));
        let label = self.label(index).cloned().map(|label| MotionLabel {
            group: label.group.filter(|stated| Some(stated.as_str()) != group),
            ..label
        });
        EntryWire::Motion(Box::new(MotionWire::new(motion, label.as_ref(), source)))
    }

    fn label(&self, index: usize) -> Option<&MotionLabel> {
        self.sources.label(MotionIndex::new(index))
    }

    fn is_same(&self, a: usize, b: usize) -> bool {
        let [source, other] = [a, b].map(|index| self.sources.of(MotionIndex::new(index)));
        self.motions[a] == self.motions[b] && self.label(a) == self.label(b) && source == other
    }
}
