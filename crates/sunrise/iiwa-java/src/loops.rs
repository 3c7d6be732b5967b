//! Loops.
//!
//! A loop ends when its condition is false. A loop is endless if its condition is true after an
//! iteration that changed no state outliving the iteration, or, after an iteration with a motion,
//! if the condition is constantly true and no statement can leave the loop, unless further answers
//! to its questions are given. The iterations up to there are planned, and the code after the loop
//! is not reached. An endless loop without a motion is not the main cycle of the application, but a
//! wait: it is refused, unless no statement can leave it. An input without an answer gets the value
//! that ends the loop, if exactly one value does.

use std::rc::Rc;

use crate::{
    flow::Flow,
    java_lists::CHANGED_MEANWHILE,
    machine::{HostCounts, Machine},
    stop::EvaluationStop,
    syntax::{Expression, Statement, StatementKind, TypeName},
    value::Value,
};

/// Parts of a loop iteration.
pub(crate) struct LoopIteration<'s> {
    pub(crate) condition: Option<&'s Expression>,
    pub(crate) update: &'s [Expression],
    pub(crate) body: &'s Statement,
    /// `true` if the first iteration runs before the condition is tested.
    is_do: bool,
}

impl Machine {
    /// Runs a loop; `label` is its label.
    pub(crate) fn repeated(
        &mut self,
        statement: &Statement,
        label: Option<&str>,
    ) -> Result<Flow, EvaluationStop> {
        let outside = self.local_count();
        let before = self
            .java
            .activations
            .last_mut()
            .map_or(0, |activation| std::mem::replace(&mut activation.outside_loop, outside));
        let flow = self.repeated_within(statement, label);
        if let Some(activation) = self.java.activations.last_mut() {
            activation.outside_loop = before;
        }
        self.forget_locals(outside);
        flow
    }

    fn repeated_within(
        &mut self,
        statement: &Statement,
        label: Option<&str>,
    ) -> Result<Flow, EvaluationStop> {
        let turn = match &statement.kind {
            StatementKind::While { condition, body } => {
                LoopIteration { condition: Some(condition), update: &[], body, is_do: false }
            }
            StatementKind::DoWhile { body, condition } => {
                LoopIteration { condition: Some(condition), update: &[], body, is_do: true }
            }
            StatementKind::For { initial, condition, update, body } => {
                for statement in initial {
                    self.statement(statement)?;
                }
                // The counter outlives the iterations.
                let count = self.local_count();
                if let Some(activation) = self.java.activations.last_mut() {
                    activation.outside_loop = count;
                }
                LoopIteration { condition: condition.as_ref(), update, body, is_do: false }
            }
            StatementKind::ForEach { type_name, name, iterable, body } => {
                return self.for_each(statement, (type_name, name), iterable, body, label);
            }
            _ => return Ok(Flow::Next),
        };
        self.while_true(statement, &turn, label)
    }

    fn while_true(
        &mut self,
        statement: &Statement,
        turn: &LoopIteration<'_>,
        label: Option<&str>,
    ) -> Result<Flow, EvaluationStop> {
        let begin = self.host.progress();
        let mut before = (self.java.changes, begin);
        let mut turns = 0;
        // Iterations before the first test of the condition.
        let untested = usize::from(turn.is_do);
        loop {
            if !(turns == 0 && turn.is_do)
                && let Some(condition) = turn.condition
            {
                self.place.line = condition.line;
                match self.condition(condition)? {
                    // The value that ended an earlier loop may not end this one.
                    Ok(true) => {
                        if turns == untested
                            && self.is_ended_by_input(condition, turn.body, before.1)?
                        {
                            return self.passed_loop(turn, before.1);
                        }
                    }
                    Ok(false) if turns == untested => return self.passed_loop(turn, before.1),
                    Ok(false) => return Ok(Flow::Next),
                    Err(unknown) => {
                        if self.is_ended_by_input(condition, turn.body, before.1)? {
                            return if turns == untested {
                                self.passed_loop(turn, before.1)
                            } else {
                                Ok(Flow::Next)
                            };
                        }
                        self.place.line = statement.line;
                        return self.passed_over(std::iter::once(statement), "loop", &unknown);
                    }
                }
            }
            if turns > 0 {
                self.check_end(statement, turn, turns, before)?;
            }
            before = (self.java.changes, self.host.progress());
            turns += 1;
            match self.turn(turn.body, label)? {
                Flow::Next => {}
                Flow::Break(None) => return Ok(Flow::Next),
                other => return Ok(other),
            }
            for update in turn.update {
                self.place.line = update.line;
                self.evaluated(update)?;
            }
        }
    }

    /// Ends a loop at the first test of its condition.
    fn passed_loop(
        &mut self,
        turn: &LoopIteration<'_>,
        before: HostCounts,
    ) -> Result<Flow, EvaluationStop> {
        if self.host.progress().asked > before.asked
            && !self.effects_of(std::iter::once(turn.body)).moves()
        {
            let hindrance = self.more_than_wait(turn);
            Rc::clone(&self.host).passed_loop(self, before.asked, hindrance)?;
        }
        Ok(Flow::Next)
    }

    /// Ends the evaluation if a loop, whose condition is true after an iteration, is endless;
    /// `before` are the counts before that iteration.
    fn check_end(
        &mut self,
        statement: &Statement,
        turn: &LoopIteration<'_>,
        turns: usize,
        before: (u64, HostCounts),
    ) -> Result<(), EvaluationStop> {
        let (changes, before) = before;
        let now = self.host.progress();
        // Further answers are given for further iterations.
        if now.continued != before.continued {
            return Ok(());
        }
        // A state that the iteration reads and changes may end the loop later.
        let is_followed = (0..now.state.len()).any(|part| {
            now.readings[part] != before.readings[part] && now.state[part] != before.state[part]
        });
        let is_unchanged = self.java.changes == changes && !is_followed;
        let says_so = Self::is_always_true(turn.condition);
        let moves = now.actions != before.actions;
        let is_without_exit = says_so && !self.effects_of(std::iter::once(turn.body)).leaves;
        let is_endless = if moves {
            is_unchanged || is_without_exit
        } else {
            // An iteration without a motion may precede one with a motion, unless it changes
            // nothing.
            is_unchanged
        };
        if !is_endless {
            return Ok(());
        }
        self.place.line = statement.line;
        if !moves && !is_without_exit {
            return match self.host.answers_since(before.asked) {
                Some(answers) => self.reject(format!("the loop waits for {answers}")),
                None => self.reject(
                    "the loop never ends: nothing that its condition depends on changes in it; \
                     changes by a key, a thread or an observer are not evaluated",
                ),
            };
        }
        if moves {
            let planned = match turns {
                1 => "one turn of it is planned".to_owned(),
                _ => format!("{turns} turns of it are planned"),
            };
            let answers = self.host.answers_since(before.asked);
            let kept = answers.map(|answer| format!(" with {answer}")).unwrap_or_default();
            self.note(format!("the loop has no end{kept}: {planned}"));
        } else {
            self.note("the loop has no end, and no motion is in it");
        }
        Rc::clone(&self.host).endless(self, before.asked);
        Err(EvaluationStop::Ended)
    }

    /// Supposes the value that ends a waiting loop, if its condition depends on one input and
    /// exactly one value ends the loop. Returns false if no such value exists.
    fn is_ended_by_input(
        &mut self,
        condition: &Expression,
        body: &Statement,
        before: HostCounts,
    ) -> Result<bool, EvaluationStop> {
        let is_about_an_input = self.host.suppose(before.asked, Some(true));
        self.host.suppose(before.asked, None);
        if !is_about_an_input {
            return Ok(false);
        }
        let effects = self.effects_of_expression(condition);
        let is_pure = !effects.acts() && effects.assigns.is_empty() && effects.changes.is_empty();
        if !is_pure || self.effects_of(std::iter::once(body)).moves() {
            return Ok(false);
        }
        let mut repeats = [None; 2];
        for (repeats, value) in repeats.iter_mut().zip([false, true]) {
            if !self.host.suppose(before.asked, Some(value)) {
                return Ok(false);
            }
            // A condition that cannot be evaluated with this value is undecided.
            *repeats = self.condition(condition).ok().and_then(Result::ok);
            self.host.suppose(before.asked, None);
        }
        let ends_by = match repeats {
            [Some(true), Some(false)] => true,
            [Some(false), Some(true)] => false,
            _ => return Ok(false),
        };
        self.host.suppose(before.asked, Some(ends_by));
        self.host.settle();
        // The answer is recorded when it is read.
        Ok(matches!(self.condition(condition)?, Ok(false)))
    }

    /// Runs one iteration; `continue` ends it.
    fn turn(&mut self, body: &Statement, label: Option<&str>) -> Result<Flow, EvaluationStop> {
        Ok(match self.scoped(body)? {
            Flow::Continue(None) => Flow::Next,
            Flow::Continue(Some(target)) if Some(target.as_str()) == label => Flow::Next,
            other => other,
        })
    }

    fn for_each(
        &mut self,
        statement: &Statement,
        (type_name, name): (&TypeName, &str),
        iterable: &Expression,
        body: &Statement,
        label: Option<&str>,
    ) -> Result<Flow, EvaluationStop> {
        let values = self.evaluated(iterable)?;
        self.place.line = statement.line;
        if let Value::Unknown(unknown) = &values {
            return self.passed_over(std::iter::once(statement), "loop", unknown);
        }
        if let Value::Null = values {
            return self.throw("NullPointerException", "a loop iterates over null");
        }
        self.refresh(&values);
        if let Some(unknown) = Self::unknown_contents(&values) {
            return self.passed_over(std::iter::once(statement), "loop", &unknown);
        }
        let Some(elements) = Self::iterated(&values) else {
            return self.reject(format!("a loop iterates over {}", values.kind()));
        };
        let begin = Self::structure(&values);
        let type_name = match type_name.name.as_str() {
            "var" => self.type_of_element(iterable).unwrap_or_else(|| type_name.clone()),
            _ => type_name.clone(),
        };
        for (place, element) in elements.into_iter().enumerate() {
            let element = Self::current(&values, place).unwrap_or(element);
            let outside = self.local_count();
            let element = self.for_variable(element, &type_name)?;
            self.java.declare(name, Some(&type_name), element);
            let flow = self.turn(body, label);
            self.forget_locals(outside);
            match flow? {
                Flow::Next => {}
                Flow::Break(None) => return Ok(Flow::Next),
                other => return Ok(other),
            }
            self.refresh(&values);
            if Self::structure(&values) != begin {
                self.place.line = statement.line;
                return self.reject(CHANGED_MEANWHILE);
            }
        }
        Ok(Flow::Next)
    }

    /// Returns the number of structural changes and the number of elements of an iterated
    /// collection.
    pub(crate) fn structure(values: &Value) -> (usize, usize) {
        match values {
            Value::List(list) => (list.structure.get(), list.borrow().len()),
            Value::Map(map) => (0, map.borrow().entries.len()),
            _ => (0, 0),
        }
    }

    /// Returns the current element at an index of an iterated collection.
    pub(crate) fn current(values: &Value, place: usize) -> Option<Value> {
        match values {
            Value::List(list) => list.borrow().get(place).cloned(),
            Value::Array(array) => array.values.borrow().get(place).cloned(),
            _ => None,
        }
    }
}
