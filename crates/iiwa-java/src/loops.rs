//! Loops.
//!
//! A loop is endless if nothing that outlives its turns changed in a turn, or if it says so and nothing in it can leave it.
//! One turn of it is planned: what follows it is not reached.

use crate::{
    flow::Flow,
    machine::Machine,
    stop::Stop,
    syntax::{Expression, Statement, StatementKind},
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
            StatementKind::ForEach { name, iterable, body } => {
                return self.for_each(statement, name, iterable, body, label);
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
        let mut is_first = true;
        loop {
            if !(is_first && turn.is_do)
                && let Some(condition) = turn.condition
            {
                self.here.line = condition.line;
                match self.condition(condition)? {
                    Ok(true) => {}
                    Ok(false) => return Ok(Flow::Next),
                    Err(unknown) => {
                        self.here.line = statement.line;
                        return self.passed_over(std::iter::once(statement), "loop", &unknown);
                    }
                }
            }
            is_first = false;
            let changes = self.java.changes;
            match self.turn(turn.body, label)? {
                Flow::Next => {}
                Flow::Break(None) => return Ok(Flow::Next),
                other => return Ok(other),
            }
            for update in turn.update {
                self.here.line = update.line;
                self.evaluated(update)?;
            }
            let says_so = Self::is_always_true(turn.condition);
            let is_unchanged = self.java.changes == changes;
            if (is_unchanged || says_so) && self.is_endless(turn.body, is_unchanged) {
                self.here.line = statement.line;
                self.note("the loop has no end: one turn of it is planned");
                return Err(Stop::Ended);
            }
        }
    }

    /// One turn; `continue` ends it.
    fn turn(&mut self, body: &Statement, label: Option<&str>) -> Result<Flow, Stop> {
        Ok(match self.scoped(body)? {
            Flow::Continue(None) => Flow::Next,
            Flow::Continue(Some(own)) if Some(own.as_str()) == label => Flow::Next,
            other => other,
        })
    }

    /// Whether a loop that nothing is known to end has no end. One that does nothing ends by the number of steps.
    fn is_endless(&mut self, body: &Statement, is_unchanged: bool) -> bool {
        let effects = self.effects_of(std::iter::once(body));
        effects.acts && (is_unchanged || !effects.leaves)
    }

    fn for_each(
        &mut self,
        statement: &Statement,
        name: &str,
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
        let Some(elements) = Self::iterated(&values) else {
            return self.refuse(format!("a loop goes through {}", values.kind()));
        };
        for element in elements {
            let outside = self.local_count();
            self.java.declare(name, None, element);
            let flow = self.turn(body, label);
            self.forget_locals(outside);
            match flow? {
                Flow::Next => {}
                Flow::Break(None) => return Ok(Flow::Next),
                other => return Ok(other),
            }
        }
        Ok(Flow::Next)
    }
}
