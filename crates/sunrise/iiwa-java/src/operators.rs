//! Java operators on values.

use crate::{
    java_strings::MAX_LETTERS,
    machine::Machine,
    stop::EvaluationStop,
    syntax::{BinaryOperator, UnaryOperator},
    value::Value,
};

/// Operands in their promoted type.
enum Promoted {
    Ints(i32, i32),
    Longs(i64, i64),
    Floats(f32, f32),
    Doubles(f64, f64),
}

#[expect(clippy::cast_possible_truncation, reason = "values of int and float are within these")]
fn promoted(left: &Value, right: &Value) -> Option<Promoted> {
    if let (Some(a), Some(b)) = (left.integer(), right.integer()) {
        let is_long = [left, right].iter().any(|value| matches!(value, Value::Long(_)));
        return Some(if is_long {
            Promoted::Longs(a, b)
        } else {
            Promoted::Ints(a as i32, b as i32)
        });
    }
    let (a, b) = (left.number()?, right.number()?);
    let is_double = [left, right].iter().any(|value| matches!(value, Value::Double(_)));
    Some(if is_double { Promoted::Doubles(a, b) } else { Promoted::Floats(a as f32, b as f32) })
}

impl Machine {
    pub(crate) fn unary(
        &mut self,
        operator: UnaryOperator,
        value: &Value,
    ) -> Result<Value, EvaluationStop> {
        if let Value::Unknown(_) = value {
            return Ok(value.clone());
        }
        let result = match (operator, value) {
            (UnaryOperator::Not, Value::Boolean(value)) => Value::Boolean(!value),
            (UnaryOperator::Plus, Value::Char(code)) => Value::Int(i32::from(*code)),
            (UnaryOperator::Minus, Value::Char(code)) => Value::Int(-i32::from(*code)),
            (UnaryOperator::Plus, _) if value.number().is_some() => value.clone(),
            (UnaryOperator::Minus, Value::Int(value)) => Value::Int(value.wrapping_neg()),
            (UnaryOperator::Minus, Value::Long(value)) => Value::Long(value.wrapping_neg()),
            (UnaryOperator::Minus, Value::Float(value)) => Value::Float(-value),
            (UnaryOperator::Minus, Value::Double(value)) => Value::Double(-value),
            (UnaryOperator::Complement, Value::Char(code)) => Value::Int(!i32::from(*code)),
            (UnaryOperator::Complement, Value::Int(value)) => Value::Int(!value),
            (UnaryOperator::Complement, Value::Long(value)) => Value::Long(!value),
            (_, Value::Null) => return self.throw("NullPointerException", "a value is null"),
            _ => return self.no_operation("this operator", &[value]),
        };
        Ok(result)
    }

    /// Evaluates all binary operators except `&&` and `||`, whose right side may be skipped.
    pub(crate) fn binary(
        &mut self,
        operator: BinaryOperator,
        left: &Value,
        right: &Value,
    ) -> Result<Value, EvaluationStop> {
        use BinaryOperator as Op;
        if let (Op::And | Op::Or, Value::Boolean(known), other)
        | (Op::And | Op::Or, other, Value::Boolean(known)) = (operator, left, right)
            && matches!(other, Value::Unknown(_))
            && *known == (operator == Op::Or)
        {
            return Ok(Value::Boolean(*known));
        }
        if let Some(unknown) = left.unknown().or(right.unknown()) {
            return Ok(Value::Unknown(std::rc::Rc::clone(unknown)));
        }
        match operator {
            Op::Equal | Op::NotEqual => {
                let is_same = match promoted(left, right) {
                    Some(Promoted::Floats(a, b)) => a == b,
                    _ => left.is_same(right),
                };
                return Ok(Value::Boolean(is_same == (operator == Op::Equal)));
            }
            Op::Add if matches!(left, Value::Text(_)) || matches!(right, Value::Text(_)) => {
                return self.concatenated(left, right);
            }
            _ => {}
        }
        if let (Value::Boolean(a), Value::Boolean(b)) = (left, right) {
            return Ok(Value::Boolean(match operator {
                Op::And => a & b,
                Op::Or => a | b,
                Op::Xor => a ^ b,
                _ => return self.no_operation("this operator", &[left, right]),
            }));
        }
        if let Op::ShiftLeft | Op::ShiftRight | Op::ShiftRightUnsigned = operator {
            return self.shift(operator, left, right);
        }
        if matches!(left, Value::Null) || matches!(right, Value::Null) {
            return self.throw("NullPointerException", "a value is null");
        }
        match promoted(left, right) {
            Some(Promoted::Ints(a, b)) => {
                self.of_integers(operator, i64::from(a), i64::from(b), |v| {
                    #[expect(clippy::cast_possible_truncation, reason = "int wraps")]
                    Value::Int(v as i32)
                })
            }
            Some(Promoted::Longs(a, b)) => self.of_integers(operator, a, b, Value::Long),
            Some(Promoted::Floats(a, b)) => match operator {
                // Rounded to float after each operation.
                Op::Add => Ok(Value::Float(a + b)),
                Op::Subtract => Ok(Value::Float(a - b)),
                Op::Multiply => Ok(Value::Float(a * b)),
                Op::Divide => Ok(Value::Float(a / b)),
                Op::Remainder => Ok(Value::Float(a % b)),
                _ => self.compared(operator, f64::from(a), f64::from(b)),
            },
            Some(Promoted::Doubles(a, b)) => match operator {
                Op::Add => Ok(Value::Double(a + b)),
                Op::Subtract => Ok(Value::Double(a - b)),
                Op::Multiply => Ok(Value::Double(a * b)),
                Op::Divide => Ok(Value::Double(a / b)),
                Op::Remainder => Ok(Value::Double(a % b)),
                _ => self.compared(operator, a, b),
            },
            None => self.no_operation("this operator", &[left, right]),
        }
    }

    /// Concatenates the texts of both values.
    pub(crate) fn concatenated(
        &mut self,
        left: &Value,
        right: &Value,
    ) -> Result<Value, EvaluationStop> {
        let [left, right] = [self.text_of(left)?, self.text_of(right)?];
        Ok(match (left, right) {
            (Ok(left), Ok(right)) if left.len() + right.len() > MAX_LETTERS => {
                return self.reject("a string is longer than a million letters");
            }
            (Ok(left), Ok(right)) => Value::text(left + &right),
            (Err(unknown), _) | (_, Err(unknown)) => Value::Unknown(unknown),
        })
    }

    fn of_integers(
        &mut self,
        operator: BinaryOperator,
        a: i64,
        b: i64,
        made: impl Fn(i64) -> Value,
    ) -> Result<Value, EvaluationStop> {
        use BinaryOperator as Op;
        if matches!(operator, Op::Divide | Op::Remainder) && b == 0 {
            return self.throw("ArithmeticException", "/ by zero");
        }
        Ok(made(match operator {
            Op::Add => a.wrapping_add(b),
            Op::Subtract => a.wrapping_sub(b),
            Op::Multiply => a.wrapping_mul(b),
            Op::Divide => a.wrapping_div(b),
            Op::Remainder => a.wrapping_rem(b),
            Op::And => a & b,
            Op::Or => a | b,
            Op::Xor => a ^ b,
            Op::Less => return Ok(Value::Boolean(a < b)),
            Op::LessOrEqual => return Ok(Value::Boolean(a <= b)),
            Op::Greater => return Ok(Value::Boolean(a > b)),
            Op::GreaterOrEqual => return Ok(Value::Boolean(a >= b)),
            _ => return self.no_operation("this operator", &[made(a), made(b)].each_ref()),
        }))
    }

    fn compared(
        &mut self,
        operator: BinaryOperator,
        a: f64,
        b: f64,
    ) -> Result<Value, EvaluationStop> {
        use BinaryOperator as Op;
        Ok(Value::Boolean(match operator {
            Op::Less => a < b,
            Op::LessOrEqual => a <= b,
            Op::Greater => a > b,
            Op::GreaterOrEqual => a >= b,
            _ => {
                return self.no_operation("this operator", &[&Value::Double(a), &Value::Double(b)]);
            }
        }))
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap,
        reason = "as Java does"
    )]
    fn shift(
        &mut self,
        operator: BinaryOperator,
        left: &Value,
        right: &Value,
    ) -> Result<Value, EvaluationStop> {
        use BinaryOperator as Op;
        let (Some(value), Some(by)) = (left.integer(), right.integer()) else {
            return self.no_operation("a shift", &[left, right]);
        };
        if matches!(left, Value::Long(_)) {
            let by = (by & 63) as u32;
            return Ok(Value::Long(match operator {
                Op::ShiftLeft => value << by,
                Op::ShiftRight => value >> by,
                _ => (value as u64 >> by) as i64,
            }));
        }
        let (value, by) = (value as i32, (by & 31) as u32);
        Ok(Value::Int(match operator {
            Op::ShiftLeft => value << by,
            Op::ShiftRight => value >> by,
            _ => (value as u32 >> by) as i32,
        }))
    }

    fn no_operation<T>(&self, operation: &str, values: &[&Value]) -> Result<T, EvaluationStop> {
        let kinds: Vec<_> = values.iter().map(|value| value.kind()).collect();
        self.reject(format!("{operation} is not for {}", kinds.join(" and ")))
    }
}
