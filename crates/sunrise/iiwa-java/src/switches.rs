//! `switch` statements and expressions.

use crate::{
    flow::Flow,
    java_sorting::Known,
    machine::Machine,
    stop::EvaluationStop,
    syntax::{Expression, ExpressionKind, Label, Statement, SwitchGroup},
    value::Value,
};

impl Machine {
    pub(crate) fn switch(
        &mut self,
        statement: &Statement,
        value: &Expression,
        groups: &[SwitchGroup],
    ) -> Result<Flow, EvaluationStop> {
        let value = self.evaluated(value)?;
        if let Value::Unknown(unknown) = &value {
            self.place.line = statement.line;
            return self.passed_over(std::iter::once(statement), "switch", unknown);
        }
        let flow = match self.switched(&value, groups)? {
            Ok(flow) => flow,
            Err(unknown) => {
                self.place.line = statement.line;
                return self.passed_over(std::iter::once(statement), "switch", &unknown);
            }
        };
        Ok(if matches!(flow, Flow::Break(None)) { Flow::Next } else { flow })
    }

    /// Evaluates a `switch` expression.
    pub(crate) fn value_of_switch(
        &mut self,
        expression: &Expression,
        value: &Expression,
        groups: &[SwitchGroup],
    ) -> Result<Value, EvaluationStop> {
        let value = self.evaluated(value)?;
        self.place.line = expression.line;
        let unknown = match value {
            Value::Unknown(unknown) => unknown,
            value => match self.switched(&value, groups)? {
                Ok(Flow::Yield(value)) => return Ok(value),
                Ok(_) => return self.reject("a switch has no value for this"),
                Err(unknown) => unknown,
            },
        };
        let effects = self.effects_of_expression(expression);
        if effects.acts() {
            return self.reject_unknown("which group of this switch is taken", &unknown);
        }
        self.forget_values(&effects, &unknown);
        Ok(Value::Unknown(unknown))
    }

    /// Runs the groups that a value selects; no group if the selection is unknown.
    fn switched(
        &mut self,
        value: &Value,
        groups: &[SwitchGroup],
    ) -> Result<Known<Flow>, EvaluationStop> {
        let outside = self.local_count();
        let result = match self.matching_group(value, groups)? {
            Ok(None) => Ok(Flow::Next),
            Ok(Some(first)) => self.groups_from(first, groups).map(Ok)?,
            Err(unknown) => Err(unknown),
        };
        self.forget_locals(outside);
        Ok(result)
    }

    fn groups_from(
        &mut self,
        first: usize,
        groups: &[SwitchGroup],
    ) -> Result<Flow, EvaluationStop> {
        for group in &groups[first..] {
            let flow = self.statements(&group.body)?;
            if !matches!(flow, Flow::Next) || !group.falls_through {
                return Ok(flow);
            }
        }
        Ok(Flow::Next)
    }

    /// Returns the index of the group that a value selects; the variables of its pattern are
    /// declared.
    fn matching_group(
        &mut self,
        value: &Value,
        groups: &[SwitchGroup],
    ) -> Result<Known<Option<usize>>, EvaluationStop> {
        let has_null = groups.iter().flat_map(|group| &group.labels).any(|label| {
            matches!(label, Label::Value(value)
                if matches!(value.kind, ExpressionKind::Literal(crate::syntax::Literal::Null)))
        });
        if matches!(value, Value::Null) && !has_null {
            return self.throw("NullPointerException", "the value of a switch is null");
        }
        let mut default = None;
        for (index, group) in groups.iter().enumerate() {
            for label in &group.labels {
                let is_it = match label {
                    Label::Default => {
                        default = Some(index);
                        continue;
                    }
                    Label::Value(label) => self.is_label(value, label)?,
                    Label::Pattern(pattern) => self.matches(value, pattern)?,
                };
                let is_it = match (is_it, &group.guard) {
                    (Value::Boolean(true), Some(guard)) => self.evaluated(guard)?,
                    (other, _) => other,
                };
                match is_it {
                    Value::Boolean(true) => return Ok(Ok(Some(index))),
                    Value::Unknown(unknown) => return Ok(Err(unknown)),
                    _ => {}
                }
            }
        }
        Ok(Ok(default))
    }

    /// Compares a value with a label: a boolean, or unknown.
    fn is_label(&mut self, value: &Value, label: &Expression) -> Result<Value, EvaluationStop> {
        Ok(Value::Boolean(match (value, &label.kind) {
            // Labels name enum constants without their class.
            (Value::Object(object), ExpressionKind::Name(name)) if object.constant.is_some() => {
                object.constant.as_ref().is_some_and(|(constant, _)| **constant == **name)
            }
            (Value::Host(constant), ExpressionKind::Name(name)) => {
                self.host.text(constant) == *name
            }
            _ => match self.evaluated(label)? {
                label @ Value::Unknown(_) => return Ok(label),
                label => value.is_same(&label),
            },
        }))
    }
}
