//! Dialogs with the operator.

use crate::{Question, QuestionKind};
use iiwa_java::{EvaluationStop, Value};

use crate::application::{arguments::flattened, asked::Asked, robotics::Robotics};

impl Robotics<'_> {
    /// Evaluates `displayModalDialog(type, text, buttons...)`: returns the number of the given
    /// button, or the first button.
    pub(crate) fn answer_dialog(&mut self, arguments: &[Value]) -> Result<Value, EvaluationStop> {
        let [_, text, buttons @ ..] = arguments else {
            return Ok(self.not_known("IApplicationUI.displayModalDialog"));
        };
        let text = match text {
            Value::Text(text) => text.to_string(),
            Value::Null => "null".to_owned(),
            Value::Unknown(_) => format!("a dialog at {}", self.place),
            other => other.kind(),
        };
        let choices = flattened(buttons);
        let choices: Vec<String> = choices
            .iter()
            .map(|choice| match choice {
                Value::Text(text) => text.to_string(),
                other => other.kind(),
            })
            .collect();
        let given = self.given_button(&text);
        let answer = given.unwrap_or(0);
        if answer >= choices.len().max(1) {
            return self.reject(format!(
                "the dialog `{text}` is answered by button {answer}, and it has {}: the first one \
                 is 0",
                choices.len()
            ));
        }
        self.record(QuestionKind::Dialog, &text, choices, answer.to_string(), given.is_some());
        let answer = i32::try_from(answer).unwrap_or_default();
        Ok(Value::Int(answer))
    }

    /// Returns the given button for a dialog, by its text or a part of it; the n-th occurrence gets
    /// the n-th button.
    fn given_button(&mut self, text: &str) -> Option<usize> {
        let dialogs = &self.station.answers.dialogs;
        let mut parts = dialogs.keys().filter(|part| text.contains(part.as_str()));
        let key = match (dialogs.contains_key(text), parts.next(), parts.next()) {
            (true, ..) => text.to_owned(),
            (false, Some(part), None) => part.clone(),
            _ => return None,
        };
        let buttons = dialogs.get(&key)?;
        let count = self.station.answered.entry(key).or_default();
        let button = buttons.get(*count).or(buttons.last()).copied();
        *count += 1;
        self.station.continued += usize::from(*count < buttons.len());
        button
    }

    /// Records a question with its answer.
    pub(crate) fn record(
        &mut self,
        kind: QuestionKind,
        asked: &str,
        choices: Vec<String>,
        answer: String,
        is_given: bool,
    ) {
        let (file, line) = (self.place.file.to_string(), self.place.line);
        let asked = asked.to_owned();
        // Durations and tools do not end loops.
        if !matches!(kind, QuestionKind::Time | QuestionKind::Tool) {
            self.station.asked.push(Asked {
                kind,
                subject: asked.clone(),
                choices: choices.clone(),
                answer: Some(answer.clone()),
                is_given,
            });
        }
        let question = Question { kind, subject: asked, choices, answer, is_given, file, line };
        // An input is read repeatedly and recorded once; each dialog and each break condition is a
        // separate question.
        if matches!(kind, QuestionKind::Dialog | QuestionKind::Fired)
            || !self.station.questions.contains(&question)
        {
            self.station.questions.push(question);
        }
    }
}
