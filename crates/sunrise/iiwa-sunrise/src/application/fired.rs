//! Conditions that are monitored during a motion: an answer states whether a condition became true.

use crate::QuestionKind;
use iiwa_java::Value;

use crate::application::{asked::Asked, robotics::Robotics};

impl Robotics<'_> {
    /// Returns the answer to the query at this file and line; `condition` names the condition, such
    /// as "the break condition of a motion".
    pub(crate) fn answer_condition(&mut self, condition: &str) -> Value {
        let place = self.place.to_string();
        if let Some(is_fired) = self.given_fired(&place) {
            self.record(QuestionKind::Fired, &place, Vec::new(), is_fired.to_string(), true);
            if is_fired {
                self.note(format!(
                    "{condition} is taken to have come true, and the arm to be where it would be \
                     otherwise: where it stops is measured"
                ));
            }
            return Value::Boolean(is_fired);
        }
        self.station.asked.push(Asked {
            kind: QuestionKind::Fired,
            subject: place.clone(),
            choices: Vec::new(),
            answer: None,
            is_given: false,
        });
        self.unknown(format!("{condition} at `{place}`, for which no answer is given"))
    }

    /// Returns the given answer for a place, by its file with or without folders, and its line; the
    /// n-th query gets the n-th answer.
    fn given_fired(&mut self, place: &str) -> Option<bool> {
        let fired = &self.station.answers.fired;
        let is_it = |key: &&String| {
            place == key.as_str()
                || place.strip_suffix(key.as_str()).is_some_and(|folder| folder.ends_with('/'))
        };
        // The longest matching key is the most specific.
        let key = fired.keys().filter(is_it).max_by_key(|key| key.len())?.clone();
        let answers = fired.get(&key)?;
        let count = self.station.fired.entry(key).or_default();
        let answer = answers.get(*count).or(answers.last()).copied();
        *count += 1;
        self.station.continued += usize::from(*count < answers.len());
        answer
    }
}
