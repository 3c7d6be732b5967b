//! Questions to a station: supposed answers, and the answers and states that keep loops running.

use std::hash::{DefaultHasher, Hash, Hasher};

use crate::QuestionKind;
use iiwa_java::SourceLine;

use crate::application::{
    asked::{Asked, EndlessLoop},
    station::Station,
};

impl Station {
    /// Returns hashes of the robot position, and of outputs and process data.
    pub(crate) fn state(&self) -> [u64; 2] {
        let mut position = DefaultHasher::new();
        for joint in self.at_rad {
            joint.to_bits().hash(&mut position);
        }
        let mut values = DefaultHasher::new();
        for (id, value) in self.outputs.iter().chain(&self.changed_data) {
            id.hash(&mut values);
            format!("{value:?}").hash(&mut values);
        }
        [position.finish(), values.finish()]
    }

    /// Supposes a value for the only input since `since` without a given value; false if the
    /// questions without a given answer are not one input. Without `value`, only ends the trial.
    pub(crate) fn suppose(&mut self, since: usize, value: Option<bool>) -> bool {
        self.trial = None;
        let Some(value) = value else { return true };
        let asked = self.asked.get(since..).unwrap_or_default();
        let is_open = |question: &&Asked| question.answer.is_none();
        let only_supposed = !asked.iter().any(|question| is_open(&question));
        let mut open = asked
            .iter()
            .filter(|question| if only_supposed { !question.is_given } else { is_open(question) });
        match (open.next(), open.next_back()) {
            (Some(first), last)
                if first.kind == QuestionKind::Input
                    && last.is_none_or(|last| last.subject == first.subject) =>
            {
                self.trial = Some((first.subject.clone(), value));
                true
            }
            _ => false,
        }
    }

    /// Keeps the supposed value from here on.
    pub(crate) fn settle(&mut self) {
        self.supposed.extend(self.trial.take());
    }

    /// Formats the inputs and dialogs since `since`, with their answers.
    pub(crate) fn answers_since(&self, since: usize) -> Option<String> {
        let mut answers: Vec<String> = Vec::new();
        for question in self.asked.get(since..).unwrap_or_default() {
            let Some(answer) = &question.answer else { continue };
            let answer =
                match answer.parse().ok().and_then(|button: usize| question.choices.get(button)) {
                    Some(choice) => format!("{answer} ({choice})"),
                    None => answer.clone(),
                };
            let kind = match question.kind {
                QuestionKind::Dialog => "the dialog",
                QuestionKind::Input => "the input",
                QuestionKind::Fired => "the condition at",
                _ => "the value of",
            };
            let is_given = if question.is_given { "given as" } else { "taken as" };
            let text = format!("{kind} `{}`, which is {is_given} {answer}", question.subject);
            if !answers.contains(&text) {
                answers.push(text);
            }
        }
        (!answers.is_empty()).then(|| answers.join(", and "))
    }

    /// Records the endless loop in which the evaluation ended.
    pub(crate) fn ended_in_loop(&mut self, place: &SourceLine, since: usize) {
        let asked = self.asked.get(since..).unwrap_or_default();
        let dialogs = asked.iter().filter(|question| question.kind == QuestionKind::Dialog);
        let mut dialogs_by_text: Vec<Asked> = Vec::new();
        for dialog in dialogs {
            if !dialogs_by_text.iter().any(|known| known.subject == dialog.subject) {
                dialogs_by_text.push(dialog.clone());
            }
        }
        self.endless = Some(EndlessLoop { place: place.clone(), dialogs: dialogs_by_text });
    }
}
