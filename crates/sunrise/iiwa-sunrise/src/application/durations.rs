//! Durations that the sources do not state: holds that the operator ends, grippers, platforms.

use crate::{Answers, QuestionKind};
use iiwa_java::{EvaluationStop, Value};

use crate::application::{motion_value::HoldTime, robotics::Robotics};

/// Durations from here on mean an unlimited hold: applications write `-1` or `60, TimeUnit.DAYS`.
const LONGEST_HOLD_S: f64 = 86400.0;

/// Returns the duration of a hold from its seconds; negative numbers mean an unlimited hold.
pub(crate) fn hold_time(seconds: f64) -> HoldTime {
    if (0.0..LONGEST_HOLD_S).contains(&seconds) {
        HoldTime::Seconds(seconds)
    } else {
        HoldTime::UntilEnded
    }
}

impl Robotics<'_> {
    /// Returns the given duration in s for this line; otherwise 0, with a note. `event` is a clause
    /// such as "the platform drives".
    pub(crate) fn given_seconds(&mut self, event: &str) -> Result<f64, EvaluationStop> {
        let asked = self.place.to_string();
        let given = self.time_of_line(&asked)?;
        let seconds = given.unwrap_or(0.0);
        if given.is_none() {
            self.note(format!(
                "{event}: its time is not in the plan; an answer, `[times]`, adds it"
            ));
        }
        let (answer, is_given) = (seconds.to_string(), given.is_some());
        self.record(QuestionKind::Time, &asked, Vec::new(), answer, is_given);
        Ok(seconds)
    }

    /// Returns the given duration in s for this line; otherwise 0, without a note.
    pub(crate) fn stated_seconds(&mut self) -> Result<f64, EvaluationStop> {
        let asked = self.place.to_string();
        let Some(seconds) = self.time_of_line(&asked)? else { return Ok(0.0) };
        self.record(QuestionKind::Time, &asked, Vec::new(), seconds.to_string(), true);
        Ok(seconds)
    }

    /// Returns the given duration for a line, in s.
    fn time_of_line(&self, asked: &str) -> Result<Option<f64>, EvaluationStop> {
        // The file matches with or without its folders; the longest matching key has priority.
        let is_here = |key: &str| asked == key || asked.ends_with(&format!("/{key}"));
        let given = self.station.answers.times.iter().filter(|(key, _)| is_here(key));
        let given = given.max_by_key(|(key, _)| key.len()).map(|(_, seconds)| *seconds);
        let seconds = given.unwrap_or(0.0);
        if Answers::seconds(seconds).is_none() {
            return self.reject(format!("`{asked}` is given as {seconds}: {}", Answers::SECONDS));
        }
        Ok(given)
    }

    /// Waits for the time given for this line.
    pub(crate) fn take_given_time(&mut self, event: &str) -> Result<(), EvaluationStop> {
        let seconds = self.given_seconds(event)?;
        if seconds > 0.0 {
            self.wait(seconds)?;
        }
        Ok(())
    }

    /// Holds the robot's position while the program continues.
    pub(crate) fn hold(&mut self, time: HoldTime) -> Result<(), EvaluationStop> {
        let seconds = match time {
            HoldTime::Seconds(seconds) => seconds,
            HoldTime::UntilEnded => {
                self.given_seconds("the arm holds its position until this is ended")?
            }
        };
        self.station.schedule.await_all();
        self.check_wait(seconds)?;
        let is_fixed = time == HoldTime::UntilEnded;
        self.station.schedule.hold(seconds, is_fixed, self.place.clone());
        Ok(())
    }

    /// Evaluates `grip` and `release` of KUKA's gripper toolbox. The result is measured, and
    /// therefore unknown.
    pub(crate) fn grip(&mut self, name: &str) -> Result<Value, EvaluationStop> {
        let event =
            if name.starts_with("grip") { "the gripper grips" } else { "the gripper opens" };
        self.take_given_time(event)?;
        Ok(self.unknown("the state of the gripper"))
    }
}
