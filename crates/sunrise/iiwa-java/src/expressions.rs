//! Evaluation of expressions.

use std::{cell::RefCell, rc::Rc};

use crate::{
    java_state::MAX_STEPS,
    machine::Machine,
    stop::EvaluationStop,
    syntax::{BinaryOperator, Expression, ExpressionKind, Literal, TypeName},
    type_names::{is_cached, is_primitive, is_text},
    value::{Array, Value},
    variables::{Slot, is_hidden},
};

/// Maximum number of array elements: larger arrays would fill memory, and do not occur in robot
/// programs.
const MAX_ELEMENTS: usize = 1_000_000;

impl Machine {
    /// Evaluates an expression.
    pub(crate) fn evaluated(&mut self, expression: &Expression) -> Result<Value, EvaluationStop> {
        self.deeper(|machine| machine.value_of(expression))
    }

    fn value_of(&mut self, expression: &Expression) -> Result<Value, EvaluationStop> {
        self.place.line = expression.line;
        match &expression.kind {
            ExpressionKind::Literal(Literal::String(text)) => Ok(self.literal_text(text)),
            ExpressionKind::Literal(literal) => Ok(of_literal(literal)),
            ExpressionKind::Name(name) => self.named(name),
            ExpressionKind::Field { object, name } => {
                if let Some(class) = self.qualified(expression) {
                    return Ok(class);
                }
                self.field_value(expression, object, name)
            }
            ExpressionKind::Call { on, name, arguments } => {
                self.call(expression, on.as_deref(), name, arguments)
            }
            // Handled where constructors are run.
            ExpressionKind::ThisCall(_) | ExpressionKind::SuperCall(_) => {
                self.reject("a constructor cannot be called here")
            }
            ExpressionKind::New { type_name, arguments, body } => {
                self.new_object(expression, type_name, arguments, body.as_ref())
            }
            ExpressionKind::NewArray { type_name, lengths, values } => {
                if let Some(values) = values {
                    self.array_of(values, type_name)
                } else {
                    let lengths = self.evaluated_all(lengths)?;
                    self.place.line = expression.line;
                    self.new_array(type_name, &lengths)
                }
            }
            ExpressionKind::Array(_) => self.reject("an array whose type is not known"),
            ExpressionKind::Index { array, index } => self.element(expression, array, index),
            ExpressionKind::Unary { operator, value } => {
                let value = self.evaluated(value)?;
                self.unary(*operator, &value)
            }
            ExpressionKind::Step { target, is_increment, is_prefix } => {
                let slot = self.slot(target)?;
                let old = self.kept(&slot);
                let operator =
                    if *is_increment { BinaryOperator::Add } else { BinaryOperator::Subtract };
                let sum = self.binary(operator, &old, &Value::Int(1))?;
                let new = self.narrowed(&slot, &old, sum);
                let new = self.keep(&slot, new)?;
                Ok(if *is_prefix { new } else { old })
            }
            ExpressionKind::Binary { operator, left, right } => {
                self.of_operator(expression, *operator, left, right)
            }
            ExpressionKind::Assign { operator, target, value } => {
                self.assign(expression, *operator, target, value)
            }
            ExpressionKind::Conditional { condition, then_value, otherwise } => {
                self.conditional(condition, then_value, otherwise)
            }
            ExpressionKind::Cast { type_name, value } => {
                let inner = self.evaluated(value)?;
                self.place.line = expression.line;
                let from = self.static_type(value);
                self.cast(inner, from.as_ref(), type_name)
            }
            ExpressionKind::InstanceOf { value, pattern } => {
                let value = self.evaluated(value)?;
                self.place.line = expression.line;
                self.matches(&value, pattern)
            }
            ExpressionKind::This | ExpressionKind::Super | ExpressionKind::SuperOf(_) => {
                Ok(self.this())
            }

            ExpressionKind::ClassLiteral(type_name) => {
                let class = self.java.activation().map(|activation| activation.class);
                let class_id =
                    class.and_then(|class| self.java.classes.find(&type_name.name, class));
                let simple = crate::classes::simple(&type_name.name);
                Ok(class_id.map_or_else(|| Value::ForeignClass(Rc::from(simple)), Value::Class))
            }
            ExpressionKind::Switch { value, groups } => {
                self.value_of_switch(expression, value, groups)
            }
            ExpressionKind::Lambda(lambda) => Ok(self.lambda(lambda)),
            ExpressionKind::Reference(reference) => self.reference(reference),
            ExpressionKind::Unsupported(construct) => {
                Ok(self.unknown(format!("{construct}, which is not evaluated")))
            }
        }
    }

    /// Returns the object of a string literal: equal literals are the same object.
    fn literal_text(&mut self, text: &str) -> Value {
        if let Some(known) = self.java.literals.get(text) {
            return Value::Text(Rc::clone(known));
        }
        let object: Rc<str> = Rc::from(text);
        self.java.literals.insert(text.to_owned(), Rc::clone(&object));
        Value::Text(object)
    }

    fn field_value(
        &mut self,
        expression: &Expression,
        receiver: &Expression,
        name: &str,
    ) -> Result<Value, EvaluationStop> {
        let value = self.evaluated(receiver)?;
        self.place.line = expression.line;
        match &value {
            // Fields are not overridden: the static type of the receiver selects the field.
            Value::Object(object) if is_hidden(object, name) => {
                let Some(from) = self.class_of(receiver) else {
                    return Ok(self.unknown(format!("which of several fields `{name}`")));
                };
                Ok(self.field_of(object, from, name).unwrap_or(Value::Null))
            }
            _ => self.member(&value, name),
        }
    }

    fn element(
        &mut self,
        expression: &Expression,
        array: &Expression,
        index: &Expression,
    ) -> Result<Value, EvaluationStop> {
        let (array, index) = (self.evaluated(array)?, self.evaluated(index)?);
        self.place.line = expression.line;
        match (&array, &index) {
            (Value::Unknown(_), _) => Ok(array),
            (_, Value::Unknown(_)) => Ok(index),
            (Value::Array(array), _) => {
                let index = self.index(&index, array.values.borrow().len())?;
                let values = array.values.borrow();
                Ok(values.get(index).cloned().unwrap_or(Value::Null))
            }
            (Value::Null, _) => self.throw("NullPointerException", "an element of null is used"),
            _ => self.reject(format!("{} has no elements", array.kind())),
        }
    }

    fn assign(
        &mut self,
        expression: &Expression,
        operator: Option<BinaryOperator>,
        target: &Expression,
        value: &Expression,
    ) -> Result<Value, EvaluationStop> {
        let slot = self.slot(target)?;
        let value = match operator {
            None => self.evaluated(value)?,
            Some(operator) => {
                let old = self.kept(&slot);
                let right = self.evaluated(value)?;
                self.place.line = expression.line;
                let is_text = self.type_of(&slot).as_ref().is_some_and(is_text);
                let result = if operator == BinaryOperator::Add && is_text {
                    self.concatenated(&old, &right)?
                } else {
                    self.binary(operator, &old, &right)?
                };
                self.narrowed(&slot, &old, result)
            }
        };
        self.keep(&slot, value)
    }

    fn conditional(
        &mut self,
        condition: &Expression,
        then_value: &Expression,
        otherwise: &Expression,
    ) -> Result<Value, EvaluationStop> {
        match self.condition(condition)? {
            Ok(is_true) => {
                let value = self.evaluated(if is_true { then_value } else { otherwise })?;
                let wanted = match value {
                    Value::Null
                    | Value::Char(_)
                    | Value::Int(_)
                    | Value::Long(_)
                    | Value::Float(_) => self.type_of_conditional(then_value, otherwise),
                    _ => None,
                };
                match wanted {
                    Some(wanted) if is_primitive(&wanted) => self.for_variable(value, &wanted),
                    _ => Ok(value),
                }
            }
            Err(unknown) => {
                for side in [then_value, otherwise] {
                    let effects = self.effects_of_expression(side);
                    if effects.acts() {
                        return self.reject_unknown("which side is taken here", &unknown);
                    }
                    self.forget_values(&effects, &unknown);
                }
                Ok(Value::Unknown(unknown))
            }
        }
    }

    /// Returns `this`, or null outside of an object.
    fn this(&self) -> Value {
        let this = self.java.activation().and_then(|activation| activation.this.clone());
        this.map_or(Value::Null, Value::Object)
    }

    pub(crate) fn evaluated_all(
        &mut self,
        all: &[Expression],
    ) -> Result<Vec<Value>, EvaluationStop> {
        all.iter().map(|expression| self.evaluated(expression)).collect()
    }

    /// Returns the initial value of a variable of this type; an array may be given by its elements
    /// alone.
    pub(crate) fn initial_value(
        &mut self,
        initial: &Expression,
        type_name: &TypeName,
    ) -> Result<Value, EvaluationStop> {
        if let ExpressionKind::Array(values) = &initial.kind {
            return self.array_of(values, type_name);
        }
        let value = self.evaluated(initial)?;
        self.for_variable(value, type_name)
    }

    /// Converts the result of a compound assignment to the type of the variable that held `old`.
    fn narrowed(&self, slot: &Slot, old: &Value, new: Value) -> Value {
        match self.type_of(slot) {
            Some(type_name) if is_primitive(&type_name) => new.cast_to(&type_name),
            _ => like(old, new),
        }
    }

    fn array_of(
        &mut self,
        values: &[Expression],
        type_name: &TypeName,
    ) -> Result<Value, EvaluationStop> {
        let element = type_name.element();
        let values = values.iter().map(|value| self.initial_value(value, &element));
        let values = RefCell::new(values.collect::<Result<Vec<_>, _>>()?);
        Ok(Value::Array(Rc::new(Array { element, values })))
    }

    pub(crate) fn new_array(
        &mut self,
        type_name: &TypeName,
        lengths: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let Some((first, others)) = lengths.split_first() else { return Ok(Value::Null) };
        if let Value::Unknown(_) = first {
            return Ok(first.clone());
        }
        let length = first.integer().unwrap_or(-1);
        let Ok(length) = usize::try_from(length) else {
            return self.throw("NegativeArraySizeException", length.to_string());
        };
        if length > MAX_ELEMENTS {
            return self.reject(format!("an array of {length} elements is too large"));
        }
        self.java.steps += u32::try_from(length / 100).unwrap_or(MAX_STEPS);
        if self.java.steps > MAX_STEPS {
            return self.reject("arrays take too much memory");
        }
        let element = type_name.element();
        let values = if others.is_empty() {
            vec![Value::default_of(&element); length]
        } else {
            (0..length).map(|_| self.new_array(&element, others)).collect::<Result<_, _>>()?
        };
        Ok(Value::Array(Rc::new(Array { element, values: RefCell::new(values) })))
    }

    fn of_operator(
        &mut self,
        expression: &Expression,
        operator: BinaryOperator,
        left: &Expression,
        right: &Expression,
    ) -> Result<Value, EvaluationStop> {
        let first = self.evaluated(left)?;
        let decides = match operator {
            BinaryOperator::AndAlso => false,
            BinaryOperator::OrElse => true,
            _ => {
                let second = self.evaluated(right)?;
                self.place.line = expression.line;
                return self.of_values(operator, (left, &first), (right, &second));
            }
        };
        match first {
            Value::Boolean(value) if value == decides => Ok(Value::Boolean(decides)),
            Value::Boolean(_) => self.evaluated(right),
            Value::Unknown(unknown) => {
                // The evaluation of the right side depends on an unknown value.
                let effects = self.effects_of_expression(right);
                if effects.acts() {
                    return self.reject_unknown("whether the right side is evaluated", &unknown);
                }
                let second = self.evaluated(right)?;
                self.forget_values(&effects, &unknown);
                Ok(match second {
                    Value::Boolean(value) if value == decides => Value::Boolean(decides),
                    _ => Value::Unknown(unknown),
                })
            }
            other => self.reject(format!("a condition is {}", other.kind())),
        }
    }

    /// Evaluates an operator that depends on the static types of its operands: `==` of objects, and
    /// `+` of `null`.
    fn of_values(
        &mut self,
        operator: BinaryOperator,
        (left, first): (&Expression, &Value),
        (right, second): (&Expression, &Value),
    ) -> Result<Value, EvaluationStop> {
        match operator {
            BinaryOperator::Equal | BinaryOperator::NotEqual
                if !first.is_same(second) && may_be_same(first, second) =>
            {
                Ok(self.unknown("whether two lambda expressions of a place are the same object"))
            }
            BinaryOperator::Equal | BinaryOperator::NotEqual if first.is_same(second) => {
                let is_same = match (first, second) {
                    // Equal texts may be different objects.
                    (Value::Text(a), Value::Text(b)) if !Rc::ptr_eq(a, b) => {
                        return Ok(self.unknown("whether two equal strings are the same object"));
                    }
                    _ if is_cached(first) || first.number().is_none() => true,
                    _ => {
                        let is_variable = matches!((&left.kind, &right.kind),
                            (ExpressionKind::Name(a), ExpressionKind::Name(b)) if a == b);
                        if !is_variable && self.may_be_boxed(left) && self.may_be_boxed(right) {
                            return Ok(
                                self.unknown("whether two equal numbers are the same object")
                            );
                        }
                        true
                    }
                };
                Ok(Value::Boolean(is_same == (operator == BinaryOperator::Equal)))
            }
            BinaryOperator::Add
                if matches!(first, Value::Null) || matches!(second, Value::Null) =>
            {
                let is_text = [left, right]
                    .into_iter()
                    .any(|operand| self.static_type(operand).as_ref().is_some_and(is_text));
                if is_text {
                    self.concatenated(first, second)
                } else {
                    self.binary(operator, first, second)
                }
            }
            _ => self.binary(operator, first, second),
        }
    }

    /// Resolves a class name with its package.
    fn qualified(&mut self, expression: &Expression) -> Option<Value> {
        let mut names = Vec::new();
        let mut current = expression;
        loop {
            match &current.kind {
                ExpressionKind::Field { object, name } => {
                    names.push(name.as_str());
                    current = object;
                }
                ExpressionKind::Name(name) => {
                    names.push(name.as_str());
                    break;
                }
                _ => return None,
            }
        }
        names.reverse();
        let (first, last) = (names.first()?, names.last()?);
        let is_package = |name: &str| name.starts_with(|letter: char| letter.is_lowercase());
        if !is_package(first) || is_package(last) || self.variable(first).ok()?.is_some() {
            return None;
        }
        let is_class = |name: &&str| !is_package(name);
        if names.iter().filter(|name| is_class(name)).count() > 1 {
            // A member of a class: the class is resolved first.
            return None;
        }
        let id = self.java.classes.by_qualified_name(&names.join("."));
        Some(id.map_or_else(|| Value::ForeignClass(Rc::from(*last)), Value::Class))
    }
}

/// Returns true for functions that a JVM may represent by one object.
pub(crate) fn may_be_same(a: &Value, b: &Value) -> bool {
    a.function().zip(b.function()).is_some_and(|(a, b)| a.may_be_same(b))
}

fn of_literal(literal: &Literal) -> Value {
    match literal {
        Literal::Null => Value::Null,
        Literal::Boolean(value) => Value::Boolean(*value),
        Literal::Char(value) => Value::Char(*value),
        Literal::Int(value) => Value::Int(*value),
        Literal::Long(value) => Value::Long(*value),
        Literal::Float(value) => Value::Float(*value),
        Literal::Double(value) => Value::Double(*value),
        Literal::String(value) => Value::text(value),
    }
}

/// Converts `new` to the type of `old` in a compound assignment.
fn like(old: &Value, new: Value) -> Value {
    let name = match old {
        Value::Char(_) => "char",
        Value::Int(_) => "int",
        Value::Long(_) => "long",
        Value::Float(_) => "float",
        Value::Double(_) => "double",
        _ => return new,
    };
    new.cast_to(&TypeName::new(name, 0))
}
