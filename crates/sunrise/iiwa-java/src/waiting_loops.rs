//! Loops that only wait for one answer: the condition reads nothing else, and the body only sleeps.

use crate::{
    loops::LoopIteration,
    machine::Machine,
    syntax::{BinaryOperator, Expression, ExpressionKind, StatementKind, UnaryOperator},
};

/// Library methods without an effect on the loop and on the robot: output of text, and the usual
/// handling of an interrupt.
const HARMLESS: [&str; 11] = [
    "currentThread",
    "error",
    "fine",
    "format",
    "info",
    "interrupt",
    "print",
    "printStackTrace",
    "println",
    "warn",
    "yield",
];

/// Maximum nesting of methods in a condition.
const MAX_DEPTH: usize = 8;

impl Machine {
    /// Returns the reason why a loop does more than wait for one answer, if any.
    pub(crate) fn more_than_wait(&mut self, turn: &LoopIteration<'_>) -> Option<&'static str> {
        if !turn.condition.is_some_and(|condition| self.is_one_reading(condition, 0)) {
            return Some("its condition is more than the value of the input");
        }
        let effects = self.effects_of(std::iter::once(turn.body));
        let is_sleep = turn.update.is_empty()
            && !effects.leaves
            && !effects.moves()
            && effects.assigns.is_empty()
            && effects.changes.is_empty()
            && effects.calls.iter().all(|name| self.is_harmless(name));
        (!is_sleep).then_some("its body does more than sleep")
    }

    /// Returns true if calls of this name pause, read or print. The calls within methods of the
    /// project are judged by themselves.
    fn is_harmless(&self, name: &str) -> bool {
        let methods = self.java.classes.named_methods(name);
        if !methods.is_empty() {
            return methods.iter().all(|method| method.body.is_some());
        }
        self.host.pausing().contains(&name)
            || HARMLESS.contains(&name)
            || name.starts_with("get")
            || name.starts_with("is")
    }

    /// Returns true if an expression is one call with constant arguments, possibly negated or
    /// compared with a literal. Methods of the project have to return such an expression.
    fn is_one_reading(&self, expression: &Expression, depth: usize) -> bool {
        let is_reading = |expression| self.is_one_reading(expression, depth);
        match &expression.kind {
            ExpressionKind::Unary { operator: UnaryOperator::Not, value } => is_reading(value),
            ExpressionKind::Binary {
                operator: BinaryOperator::Equal | BinaryOperator::NotEqual,
                left,
                right,
            } => is_literal(left) && is_reading(right) || is_literal(right) && is_reading(left),
            ExpressionKind::Call { on, name, arguments } => {
                depth < MAX_DEPTH
                    && on.as_deref().is_none_or(is_path)
                    && arguments.iter().all(|argument| is_literal(argument) || is_path(argument))
                    && self.java.classes.named_methods(name).iter().all(|method| {
                        let Some(body) = &method.body else { return true };
                        match body.as_slice() {
                            [statement] => match &statement.kind {
                                StatementKind::Return(Some(value)) => {
                                    self.is_one_reading(value, depth + 1)
                                }
                                _ => false,
                            },
                            _ => false,
                        }
                    })
            }
            _ => false,
        }
    }
}

fn is_literal(expression: &Expression) -> bool {
    matches!(expression.kind, ExpressionKind::Literal(_))
}

/// Returns true for access paths without a calculation, such as `this.io` and `cell.getIo()`.
fn is_path(expression: &Expression) -> bool {
    match &expression.kind {
        ExpressionKind::Name(_) | ExpressionKind::This | ExpressionKind::Super => true,
        ExpressionKind::Field { object, .. } => is_path(object),
        ExpressionKind::Call { on, arguments, .. } => {
            on.as_deref().is_none_or(is_path) && arguments.iter().all(is_literal)
        }
        _ => false,
    }
}
