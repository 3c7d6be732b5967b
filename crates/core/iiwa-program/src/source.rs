//! Sources, labels, repeat blocks and tasks of a program's motions.

use std::{collections::BTreeMap, fmt};

use iiwa_json::excerpt;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{
    motion_index::MotionIndex,
    motion_label::{MotionLabel, text_fault},
    repeat_block::{RepeatBlock, Round, in_first_rounds, reordered_blocks, rounds_of},
    task::Task,
};

/// Source line of the motion, for messages.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// File name.
    #[schemars(length(max = 4096))]
    pub file: String,
    /// Line number, from 1.
    #[schemars(range(min = 1))]
    pub line: u32,
}

/// Longest file name of a source, in characters.
const MAX_FILE: usize = 4096;

impl Source {
    /// Key of the first unsuitable value, with the reason.
    pub(crate) fn fault(&self) -> Option<(&'static str, String)> {
        if self.line == 0 {
            return Some(("line", "the first line of a source is line 1".to_owned()));
        }
        Some(("file", text_fault("source.file", &self.file, MAX_FILE, |_| false)?))
    }
}

/// Writes `Welding.java:84`, as compilers do.
impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, line } = self;
        write!(f, "{file}:{line}")
    }
}

/// Known sources, labels, repeat blocks and tasks of a program's motions. Sources are those of a
/// program generated from another program, such as a Java robot application.
///
/// ```
/// use iiwa_program::{MotionIndex, MotionLabel, Source, Sources};
///
/// let mut sources = Sources::default();
/// let fourth = MotionIndex::new(3);
/// sources.insert(fourth, Source { file: "Welding.java".to_owned(), line: 84 });
/// assert_eq!(sources.of(fourth).map(ToString::to_string).as_deref(), Some("Welding.java:84"));
/// let message = sources.in_message("motion 4: joint A4 is at 130 deg");
/// assert_eq!(message, "motion 4 (Welding.java:84): joint A4 is at 130 deg");
///
/// sources.insert_label(fourth, MotionLabel::named("seam"));
/// let message = sources.in_message("motion 4: joint A4 is at 130 deg");
/// assert_eq!(message, "motion 4 \"seam\" (Welding.java:84): joint A4 is at 130 deg");
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sources(Box<SourceLists>);

/// Sources, labels, blocks and tasks. On the heap, because errors contain them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct SourceLists {
    notes: BTreeMap<MotionIndex, MotionNotes>,
    repeats: Vec<RepeatBlock>,
    tasks: Vec<Task>,
}

/// Source and label of a motion.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct MotionNotes {
    source: Option<Source>,
    label: MotionLabel,
}

impl Sources {
    /// Source of a motion, if known.
    #[must_use]
    pub fn of(&self, motion: MotionIndex) -> Option<&Source> {
        self.0.notes.get(&motion)?.source.as_ref()
    }

    /// Name, comment and group of a motion, if it has any of them.
    #[must_use]
    pub fn label(&self, motion: MotionIndex) -> Option<&MotionLabel> {
        self.0.notes.get(&motion).map(|notes| &notes.label).filter(|label| !label.is_empty())
    }

    /// Sets the source of a motion.
    pub fn insert(&mut self, motion: MotionIndex, source: Source) {
        self.0.notes.entry(motion).or_default().source = Some(source);
    }

    /// Sets the label of a motion.
    pub fn insert_label(&mut self, motion: MotionIndex, label: MotionLabel) {
        if !label.is_empty() || self.0.notes.contains_key(&motion) {
            self.0.notes.entry(motion).or_default().label = label;
        }
    }

    /// Returns true if no source, no label, no repeat block and no task is known.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let has_lists = !self.0.repeats.is_empty() || !self.0.tasks.is_empty();
        !has_lists && self.iter().next().is_none() && self.labels().next().is_none()
    }

    /// Repeat blocks in order, without the inner ones.
    #[must_use]
    pub fn repeats(&self) -> &[RepeatBlock] {
        &self.0.repeats
    }

    /// Sets the repeat blocks, in order. They state which motions belong together; the motions of
    /// all rounds are in the program's list.
    pub fn set_repeats(&mut self, repeats: Vec<RepeatBlock>) {
        self.0.repeats = repeats;
    }

    /// Tasks as listed in the program; [`Program::tasks`](crate::Program::tasks) returns them with
    /// their motions.
    #[must_use]
    pub fn tasks(&self) -> &[Task] {
        &self.0.tasks
    }

    /// Sets the tasks.
    pub fn set_tasks(&mut self, tasks: Vec<Task>) {
        self.0.tasks = tasks;
    }

    /// Returns the sources, labels and blocks of motions in another order. `origins` has the former
    /// index of each motion.
    pub(crate) fn reordered(&self, origins: &[usize]) -> Self {
        let SourceLists { notes, repeats, tasks } = self.0.as_ref();
        let notes = origins.iter().enumerate().filter_map(|(index, origin)| {
            let notes = notes.get(&MotionIndex::new(*origin))?;
            Some((MotionIndex::new(index), notes.clone()))
        });
        Self(Box::new(SourceLists {
            notes: notes.collect(),
            repeats: reordered_blocks(repeats, origins),
            tasks: tasks.clone(),
        }))
    }

    /// Rounds of a motion in the repeat blocks that contain the motion, the outermost block first.
    #[must_use]
    pub fn rounds(&self, motion: MotionIndex) -> Vec<Round> {
        rounds_of(&self.0.repeats, motion)
    }

    /// Counterpart of a motion in the first rounds of its enclosing repeat blocks; the motion
    /// itself outside of blocks.
    #[must_use]
    pub fn in_first_rounds(&self, motion: MotionIndex) -> MotionIndex {
        in_first_rounds(&self.0.repeats, motion)
    }

    /// Known sources, in the order of the motions.
    pub fn iter(&self) -> impl Iterator<Item = (MotionIndex, &Source)> {
        self.0.notes.keys().filter_map(|motion| Some((*motion, self.of(*motion)?)))
    }

    /// Labels, in the order of the motions.
    pub fn labels(&self) -> impl Iterator<Item = (MotionIndex, &MotionLabel)> {
        self.0.notes.keys().filter_map(|motion| Some((*motion, self.label(*motion)?)))
    }

    /// Name, source and rounds after a motion number: ` "seam" (Welding.java:84, round 2 of 5)`. A
    /// long name is shortened.
    pub(crate) fn suffix(&self, motion: MotionIndex) -> String {
        let name = self.label(motion).and_then(|label| label.name.as_deref());
        motion_origin(name, self.of(motion), &self.rounds(motion))
    }

    /// Adds name, source and rounds after each motion number in a message:
    /// `motion 4 "seam" (Welding.java:84)`.
    #[must_use]
    pub fn in_message(&self, message: &str) -> String {
        with_motions(message, |motion| format!("{motion}{}", self.suffix(motion)))
    }
}

impl FromIterator<(MotionIndex, Source)> for Sources {
    fn from_iter<I: IntoIterator<Item = (MotionIndex, Source)>>(sources: I) -> Self {
        let with_notes = |(motion, source)| {
            (motion, MotionNotes { source: Some(source), label: MotionLabel::default() })
        };
        let notes = sources.into_iter().map(with_notes).collect();
        Self(Box::new(SourceLists { notes, ..SourceLists::default() }))
    }
}

/// Replaces each motion number in a message, but not in texts of the program, which are between
/// backquotes.
///
/// ```
/// use iiwa_program::{MotionIndex, with_motions};
///
/// let text = with_motions("motion 2 and `motion 3`", |motion| format!("{}", motion.index()));
/// assert_eq!(text, "motion 1 and `motion 3`");
/// ```
#[must_use]
pub fn with_motions(message: &str, replacement: impl Fn(MotionIndex) -> String) -> String {
    const WORD: &str = "motion ";
    let mut text = String::with_capacity(message.len());
    let mut rest = message;
    let mut is_quoted = false;
    while let Some(offset) = rest.find(WORD) {
        let (before, after) = rest.split_at(offset + WORD.len());
        text.push_str(before);
        is_quoted ^= before.matches('`').count() % 2 == 1;
        let digits = after.len() - after.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let (number, after) = after.split_at(digits);
        match number.parse().ok().and_then(MotionIndex::from_number).filter(|_| !is_quoted) {
            Some(motion) => text.push_str(&replacement(motion)),
            None => text.push_str(number),
        }
        rest = after;
    }
    text.push_str(rest);
    text
}

/// Name, source and rounds of a motion as they follow its number in messages:
/// ` "seam" (Welding.java:84, round 2 of 5)`; rounds of nested blocks are
/// `round 1 of 3, 2 of 5`. A long name is shortened.
///
/// ```
/// use iiwa_program::{Round, motion_origin};
///
/// let rounds = [Round { number: 1, count: 3 }, Round { number: 2, count: 5 }];
/// assert_eq!(motion_origin(Some("seam"), None, &rounds), " \"seam\" (round 1 of 3, 2 of 5)");
/// assert_eq!(motion_origin(None, None, &[]), "");
/// ```
#[must_use]
pub fn motion_origin(name: Option<&str>, source: Option<&Source>, rounds: &[Round]) -> String {
    let name = name.map(|name| format!(" \"{}\"", excerpt(name))).unwrap_or_default();
    let rounds: Vec<_> =
        rounds.iter().map(|Round { number, count }| format!("{number} of {count}")).collect();
    let rounds = (!rounds.is_empty()).then(|| format!("round {}", rounds.join(", ")));
    let parts: Vec<_> = source.map(ToString::to_string).into_iter().chain(rounds).collect();
    if parts.is_empty() { name } else { format!("{name} ({})", parts.join(", ")) }
}
