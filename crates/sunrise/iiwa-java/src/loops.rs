//! Loops.
//!
//! A loop ends when its condition says so. It is endless if the condition is true after a turn in which nothing that outlives
//! the turns changed, or if the loop says so and nothing in it can leave it, unless further answers to its questions are given.
//! The turns up to there are planned: what follows the loop is not reached. A loop without a motion in it is never the
//! application's cycle: it waits for something. It is refused if a given answer keeps it waiting; an input without an answer
//! gets the value that ends the loop, if there is one such value only.

use std::rc::Rc;

use crate::{
    flow::Flow,
    java_lists::CHANGED_MEANWHILE,
    machine::{Machine, Progress},
    stop::Stop,
    syntax::{Expression, Statement, StatementKind, TypeName},
    value::Value,
};

/// What is done between turns.
struct Turn<'s> {
    condition: Option<&'s Expression>,
    update: &'s [Expression],
    body: &'s Statement,
    /// Whether the first turn is taken whatever the condition.
    is_do: bool,
}

impl Machine {
    /// A loop; `label` is the one before it.
    pub(crate) fn repeated(
        &mut self,
        statement: &Statement,
        label: Option<&str>,
    ) -> Result<Flow, Stop> {
        let outside = self.local_count();
        let before = self
            .java
            .activations
            .last_mut()
            .map_or(0, |own| std::mem::replace(&mut own.outside_loop, outside));
        let flow = self.repeated_within(statement, label);
        if let Some(own) = self.java.activations.last_mut() {
            own.outside_loop = before;
        }
        self.forget_locals(outside);
        flow
    }

    fn repeated_within(
        &mut self,
        statement: &Statement,
        label: Option<&str>,
    ) -> Result<Flow, Stop> {
        let turn = match &statement.kind {
            StatementKind::While { condition, body } => {
                Turn { condition: Some(condition), update: &[], body, is_do: false }
            }
            StatementKind::DoWhile { body, condition } => {
                Turn { condition: Some(condition), update: &[], body, is_do: true }
            }
            StatementKind::For { initial, condition, update, body } => {
                for own in initial {
                    self.statement(own)?;
                }
                // The counter outlives the turns.
                let count = self.local_count();
                if let Some(own) = self.java.activations.last_mut() {
                    own.outside_loop = count;
                }
                Turn { condition: condition.as_ref(), update, body, is_do: false }
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
        turn: &Turn<'_>,
        label: Option<&str>,
    ) -> Result<Flow, Stop> {
        let begin = self.host.progress();
        let mut before = (self.java.changes, begin);
        let mut turns = 0;
        loop {
            if !(turns == 0 && turn.is_do)
                && let Some(condition) = turn.condition
            {
                self.here.line = condition.line;
                match self.condition(condition)? {
                    Ok(true) => {}
                    Ok(false) => return Ok(Flow::Next),
                    Err(unknown) => {
                        if self.is_ended_by_input(condition, turn.body, before.1)? {
                            return Ok(Flow::Next);
                        }
                        self.here.line = statement.line;
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
                self.here.line = update.line;
                self.evaluated(update)?;
            }
        }
    }

    /// Ends the evaluation if a loop, whose condition is true after a turn, goes on for ever; `before` are the counts before
    /// that turn.
    fn check_end(
        &mut self,
        statement: &Statement,
        turn: &Turn<'_>,
        turns: usize,
        before: (u64, Progress),
    ) -> Result<(), Stop> {
        let (changes, before) = before;
        let now = self.host.progress();
        // Further answers are given for further turns.
        if now.continued != before.continued {
            return Ok(());
        }
        // What a turn reads of the host's state may end the loop once that is another.
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
            // A turn without a motion may come before one with a motion, unless it changes nothing.
            is_unchanged
        };
        if !is_endless {
            return Ok(());
        }
        self.here.line = statement.line;
        if !moves && !is_without_exit {
            return match self.host.answers_since(before.asked) {
                Some(answers) => self.refuse(format!("the loop waits for {answers}")),
                None => self.refuse(
                    "the loop never ends: nothing that its condition depends on changes in it; what a key, a thread or \
                     an observer would change is not evaluated",
                ),
            };
        }
        if moves {
            let planned = match turns {
                1 => "one turn of it is planned".to_owned(),
                _ => format!("{turns} turns of it are planned"),
            };
            let answers = self.host.answers_since(before.asked);
            let kept = answers.map(|own| format!(" with {own}")).unwrap_or_default();
            self.note(format!("the loop has no end{kept}: {planned}"));
        } else {
            self.note("the loop has no end, and no motion is in it");
        }
        Rc::clone(&self.host).endless(self, before.asked);
        Err(Stop::Ended)
    }

    /// Supposes the value that ends a loop which only waits, if its condition depends on one input and one value alone
    /// ends it. False if there is no such value.
    fn is_ended_by_input(
        &mut self,
        condition: &Expression,
        body: &Statement,
        before: Progress,
    ) -> Result<bool, Stop> {
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
            // A condition that cannot be evaluated with this value says nothing.
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
        // The answer is recorded where it is read.
        Ok(matches!(self.condition(condition)?, Ok(false)))
    }

    /// One turn; `continue` ends it.
    fn turn(&mut self, body: &Statement, label: Option<&str>) -> Result<Flow, Stop> {
        Ok(match self.scoped(body)? {
            Flow::Continue(None) => Flow::Next,
            Flow::Continue(Some(own)) if Some(own.as_str()) == label => Flow::Next,
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
    ) -> Result<Flow, Stop> {
        let values = self.evaluated(iterable)?;
        self.here.line = statement.line;
        if let Value::Unknown(unknown) = &values {
            return self.passed_over(std::iter::once(statement), "loop", unknown);
        }
        if let Value::Null = values {
            return self.throw("NullPointerException", "what a loop goes through is null");
        }
        self.refresh(&values);
        if let Some(unknown) = Self::unknown_contents(&values) {
            return self.passed_over(std::iter::once(statement), "loop", &unknown);
        }
        let Some(elements) = Self::iterated(&values) else {
            return self.refuse(format!("a loop goes through {}", values.kind()));
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
                self.here.line = statement.line;
                return self.refuse(CHANGED_MEANWHILE);
            }
        }
        Ok(Flow::Next)
    }

    /// The number of changes and of elements of what a loop goes through.
    pub(crate) fn structure(values: &Value) -> (usize, usize) {
        match values {
            Value::List(list) => (list.structure.get(), list.borrow().len()),
            Value::Map(map) => (0, map.borrow().entries.len()),
            _ => (0, 0),
        }
    }

    /// The element at a place of what a loop goes through, as it is by now.
    pub(crate) fn current(values: &Value, place: usize) -> Option<Value> {
        match values {
            Value::List(list) => list.borrow().get(place).cloned(),
            Value::Array(array) => array.values.borrow().get(place).cloned(),
            _ => None,
        }
    }
}
