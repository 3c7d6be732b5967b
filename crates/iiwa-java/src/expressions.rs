//! Expressions and their values.

use std::{cell::RefCell, rc::Rc};

use crate::{
    java_state::MAX_STEPS,
    machine::Machine,
    stop::Stop,
    syntax::{BinaryOperator, Expression, ExpressionKind, Literal, TypeName},
    value::{Array, Value},
};

/// Elements of an array: more would fill memory, and no program has them.
const MAX_ELEMENTS: usize = 1_000_000;

impl Machine {
    /// The value of an expression.
    pub(crate) fn evaluated(&mut self, expression: &Expression) -> Result<Value, Stop> {
        self.deeper(|machine| machine.value_of(expression))
    }

    fn value_of(&mut self, expression: &Expression) -> Result<Value, Stop> {
        self.here.line = expression.line;
        match &expression.kind {
            ExpressionKind::Literal(literal) => Ok(of_literal(literal)),
            ExpressionKind::Name(name) => self.named(name),
            ExpressionKind::Field { of, name } => {
                if let Some(class) = self.qualified(expression) {
                    return Ok(class);
                }
                let of = self.evaluated(of)?;
                self.here.line = expression.line;
                self.member(&of, name)
            }
            ExpressionKind::Call { on, name, arguments } => {
                self.call(expression, on.as_deref(), name, arguments)
            }
            // They are taken out where constructors are run.
            ExpressionKind::ThisCall(_) | ExpressionKind::SuperCall(_) => {
                self.refuse("a constructor is called where none can be")
            }
            ExpressionKind::New { type_name, arguments, body } => {
                self.new_object(expression, type_name, arguments, body.as_ref())
            }
            ExpressionKind::NewArray { type_name, lengths, values } => {
                if let Some(values) = values {
                    self.array_of(values, type_name)
                } else {
                    let lengths = self.evaluated_all(lengths)?;
                    self.here.line = expression.line;
                    self.new_array(type_name, &lengths)
                }
            }
            ExpressionKind::Array(_) => self.refuse("an array stands where its type is not known"),
            ExpressionKind::Index { of, index } => self.element(expression, of, index),
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
                let new = self.keep(&slot, like(&old, sum));
                Ok(if *is_prefix { new } else { old })
            }
            ExpressionKind::Binary { operator, left, right } => {
                self.of_operator(expression, *operator, left, right)
            }
            ExpressionKind::Assign { operator, target, value } => {
                self.assign(expression, *operator, target, value)
            }
            ExpressionKind::Conditional { condition, then, otherwise } => {
                self.conditional(condition, then, otherwise)
            }
            ExpressionKind::Cast { type_name, value } => {
                Ok(self.evaluated(value)?.cast_to(type_name))
            }
            ExpressionKind::InstanceOf { value, type_name } => {
                let value = self.evaluated(value)?;
                Ok(self.is_instance(&value, type_name))
            }
            ExpressionKind::This | ExpressionKind::Super => Ok(self.this()),

            ExpressionKind::ClassLiteral(type_name) => {
                let class = self.java.activation().map(|own| own.class);
                let found = class.and_then(|own| self.java.classes.find(&type_name.name, own));
                let simple = crate::classes::simple(&type_name.name);
                Ok(found.map_or_else(|| Value::ForeignClass(Rc::from(simple)), Value::Class))
            }
            ExpressionKind::Switch { value, groups } => {
                self.value_of_switch(expression, value, groups)
            }
            ExpressionKind::Lambda(body) => {
                let effects = self.effects_of(body);
                if effects.acts() {
                    let acts = self.host.acts();
                    return self
                        .refuse(format!("a lambda expression, in which {acts}, is not evaluated"));
                }
                let value = self.unknown("a lambda expression, which is not evaluated");
                if let Value::Unknown(unknown) = &value {
                    // It may be run at any time.
                    self.forget_values(&effects, unknown);
                }
                Ok(value)
            }
            ExpressionKind::Unsupported(what) => {
                Ok(self.unknown(format!("{what}, which is not evaluated")))
            }
        }
    }

    fn element(
        &mut self,
        expression: &Expression,
        of: &Expression,
        index: &Expression,
    ) -> Result<Value, Stop> {
        let (of, index) = (self.evaluated(of)?, self.evaluated(index)?);
        self.here.line = expression.line;
        match (&of, &index) {
            (Value::Unknown(_), _) => Ok(of),
            (_, Value::Unknown(_)) => Ok(index),
            (Value::Array(array), _) => {
                let index = self.index(&index, array.values.borrow().len())?;
                let values = array.values.borrow();
                Ok(values.get(index).cloned().unwrap_or(Value::Null))
            }
            (Value::Null, _) => self.throw("NullPointerException", "an element of null is used"),
            _ => self.refuse(format!("{} has no elements", of.kind())),
        }
    }

    fn assign(
        &mut self,
        expression: &Expression,
        operator: Option<BinaryOperator>,
        target: &Expression,
        value: &Expression,
    ) -> Result<Value, Stop> {
        let slot = self.slot(target)?;
        let value = match operator {
            None => self.evaluated(value)?,
            Some(operator) => {
                let old = self.kept(&slot);
                let right = self.evaluated(value)?;
                self.here.line = expression.line;
                let result = self.binary(operator, &old, &right)?;
                like(&old, result)
            }
        };
        Ok(self.keep(&slot, value))
    }

    fn conditional(
        &mut self,
        condition: &Expression,
        then: &Expression,
        otherwise: &Expression,
    ) -> Result<Value, Stop> {
        match self.condition(condition)? {
            Ok(true) => self.evaluated(then),
            Ok(false) => self.evaluated(otherwise),
            Err(unknown) => {
                for side in [then, otherwise] {
                    let effects = self.effects_of_expression(side);
                    if effects.acts() {
                        return self.refuse_unknown("which side is taken here", &unknown);
                    }
                    self.forget_values(&effects, &unknown);
                }
                Ok(Value::Unknown(unknown))
            }
        }
    }

    /// `this`, or null outside of an object.
    fn this(&self) -> Value {
        let this = self.java.activation().and_then(|own| own.this.clone());
        this.map_or(Value::Null, Value::Object)
    }

    pub(crate) fn evaluated_all(&mut self, all: &[Expression]) -> Result<Vec<Value>, Stop> {
        all.iter().map(|own| self.evaluated(own)).collect()
    }

    /// The first value of a variable of this type; an array may be given by its elements alone.
    pub(crate) fn initial_value(
        &mut self,
        initial: &Expression,
        type_name: &TypeName,
    ) -> Result<Value, Stop> {
        match &initial.kind {
            ExpressionKind::Array(values) => self.array_of(values, type_name),
            _ => Ok(self.evaluated(initial)?.converted_to(type_name)),
        }
    }

    fn array_of(&mut self, values: &[Expression], type_name: &TypeName) -> Result<Value, Stop> {
        let dimensions = type_name.dimensions.saturating_sub(1);
        let element = TypeName { name: type_name.name.clone(), dimensions };
        let values = values.iter().map(|own| self.initial_value(own, &element));
        let values = RefCell::new(values.collect::<Result<Vec<_>, _>>()?);
        Ok(Value::Array(Rc::new(Array { element, values })))
    }

    fn new_array(&mut self, type_name: &TypeName, lengths: &[Value]) -> Result<Value, Stop> {
        let Some((first, others)) = lengths.split_first() else { return Ok(Value::Null) };
        if let Value::Unknown(_) = first {
            return Ok(first.clone());
        }
        let length = first.integer().unwrap_or(-1);
        let Ok(length) = usize::try_from(length) else {
            return self.throw("NegativeArraySizeException", length.to_string());
        };
        if length > MAX_ELEMENTS {
            return self.refuse(format!("an array of {length} elements is too large"));
        }
        self.java.steps += u32::try_from(length / 100).unwrap_or(MAX_STEPS);
        if self.java.steps > MAX_STEPS {
            return self.refuse("arrays take too much memory");
        }
        let dimensions = type_name.dimensions.saturating_sub(1);
        let element = TypeName { name: type_name.name.clone(), dimensions };
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
    ) -> Result<Value, Stop> {
        let first = self.evaluated(left)?;
        let decides = match operator {
            BinaryOperator::AndAlso => false,
            BinaryOperator::OrElse => true,
            _ => {
                let second = self.evaluated(right)?;
                self.here.line = expression.line;
                return self.binary(operator, &first, &second);
            }
        };
        match first {
            Value::Boolean(value) if value == decides => Ok(Value::Boolean(decides)),
            Value::Boolean(_) => self.evaluated(right),
            Value::Unknown(unknown) => {
                // Whether the right side is evaluated is not known.
                let effects = self.effects_of_expression(right);
                if effects.acts() {
                    return self.refuse_unknown("whether the right side is evaluated", &unknown);
                }
                let second = self.evaluated(right)?;
                self.forget_values(&effects, &unknown);
                Ok(match second {
                    Value::Boolean(value) if value == decides => Value::Boolean(decides),
                    _ => Value::Unknown(unknown),
                })
            }
            other => self.refuse(format!("a condition is {}", other.kind())),
        }
    }

    /// The class that a name with its package stands for, if it is such a name.
    fn qualified(&mut self, expression: &Expression) -> Option<Value> {
        let mut names = Vec::new();
        let mut at = expression;
        loop {
            match &at.kind {
                ExpressionKind::Field { of, name } => {
                    names.push(name.as_str());
                    at = of;
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
            // A member of a class: the class is found first.
            return None;
        }
        let id = self.java.classes.by_qualified_name(&names.join("."));
        Some(id.map_or_else(|| Value::ForeignClass(Rc::from(*last)), Value::Class))
    }

    fn is_instance(&mut self, value: &Value, type_name: &TypeName) -> Value {
        let simple = crate::classes::simple(&type_name.name);
        match value {
            Value::Unknown(_) => value.clone(),
            Value::Null => Value::Boolean(false),
            Value::Object(object) => {
                let class = self.java.activation().map_or(object.class, |own| own.class);
                let is_it = match self.java.classes.find(&type_name.name, class) {
                    Some(id) => self.java.classes.is_a(object.class, id),
                    None => {
                        simple == "Object"
                            || self.java.classes.foreign_parent(object.class) == Some(simple)
                    }
                };
                Value::Boolean(is_it)
            }
            Value::Text(_) => {
                Value::Boolean(matches!(simple, "String" | "Object" | "CharSequence"))
            }
            Value::Int(_) => Value::Boolean(matches!(simple, "Integer" | "Number" | "Object")),
            Value::Double(_) => Value::Boolean(matches!(simple, "Double" | "Number" | "Object")),
            Value::Boolean(_) => Value::Boolean(matches!(simple, "Boolean" | "Object")),
            _ => self.unknown(format!("whether {} is a {simple}", value.kind())),
        }
    }
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

/// `new` as a compound assignment to a variable that held `old` keeps it.
fn like(old: &Value, new: Value) -> Value {
    let name = match old {
        Value::Char(_) => "char",
        Value::Int(_) => "int",
        Value::Long(_) => "long",
        Value::Float(_) => "float",
        Value::Double(_) => "double",
        _ => return new,
    };
    new.cast_to(&TypeName { name: name.to_owned(), dimensions: 0 })
}
