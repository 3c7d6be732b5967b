//! Operators and their operands.
//!
//! The grammar parses `-a++` as `(-a)++`, and `(a) - b` as either a difference or a cast of `-b`.
//! Operators and operands are therefore listed in file order, and reassembled by the rules of Java
//! (JLS 15): by rank, from the left except for assignments and conditional expressions; and the
//! operand of a cast to a class never begins with `+` or `-`.

use std::iter::Peekable;

use super::{
    expressions::PlacedExpression,
    fault::SyntaxFault,
    reader::{TreeReader, children},
    tree::SyntaxNode,
};
use crate::syntax::{
    BinaryOperator, Expression, ExpressionKind, Literal, Pattern, TypeName, UnaryOperator,
};

/// Part of an expression, in file order.
enum OperandPart<'n> {
    Operand(SyntaxNode<'n>),
    /// Unary operator, with the offset of its sign.
    Unary(UnaryOperator, usize),
    StepBefore(bool, usize),
    StepBehind(bool),
    Cast(TypeName, usize),
    Binary(BinaryOperator),
    InstanceOf(Pattern),
    Question,
    Colon,
    Assign(Option<BinaryOperator>),
}

/// Operator ranks, from the weakest.
const ASSIGNMENT: u8 = 1;
const CONDITION: u8 = 2;
const COMPARISON: u8 = 9;

type OperandParts<'n> = Peekable<std::vec::IntoIter<OperandPart<'n>>>;

impl TreeReader<'_> {
    pub(super) fn expression(&self, node: SyntaxNode<'_>) -> Result<Expression, SyntaxFault> {
        Ok(self.placed(node)?.0)
    }

    pub(super) fn placed(&self, node: SyntaxNode<'_>) -> Result<PlacedExpression, SyntaxFault> {
        if !has_operator(node) {
            return self.operand(node);
        }
        let mut parts = Vec::new();
        self.write_out(node, &mut parts)?;
        let mut parts = parts.into_iter().peekable();
        let whole = self.ranked(&mut parts, ASSIGNMENT, node)?;
        match parts.next() {
            None => Ok(whole),
            Some(OperandPart::Assign(_)) => Err(no_variable(whole.1)),
            Some(_) => Err(self.misread(node)),
        }
    }

    fn write_out<'n>(
        &self,
        node: SyntaxNode<'n>,
        parts: &mut Vec<OperandPart<'n>>,
    ) -> Result<(), SyntaxFault> {
        match node.kind() {
            "binary_expression" => {
                self.write_out(self.field(node, "left")?, parts)?;
                let operator = self.field(node, "operator")?;
                let operator = binary_operator(operator.kind());
                parts.push(OperandPart::Binary(operator.ok_or_else(|| self.misread(node))?));
                self.write_out(self.field(node, "right")?, parts)
            }
            "assignment_expression" => {
                self.write_out(self.field(node, "left")?, parts)?;
                let operator = self.field(node, "operator")?.kind();
                let before = operator.strip_suffix('=').unwrap_or(operator);
                parts.push(OperandPart::Assign(binary_operator(before)));
                self.write_out(self.field(node, "right")?, parts)
            }
            "ternary_expression" => {
                self.write_out(self.field(node, "condition")?, parts)?;
                parts.push(OperandPart::Question);
                self.write_out(self.field(node, "consequence")?, parts)?;
                parts.push(OperandPart::Colon);
                self.write_out(self.field(node, "alternative")?, parts)
            }
            "instanceof_expression" => {
                self.write_out(self.field(node, "left")?, parts)?;
                let pattern = if let Some(right) = node.field("right") {
                    let name = node.field("name");
                    let name = name.map(|name| self.name(name)).transpose()?;
                    Pattern::Type { type_name: self.type_name(right)?, name }
                } else {
                    self.pattern(self.field(node, "pattern")?)?
                };
                parts.push(OperandPart::InstanceOf(pattern));
                Ok(())
            }
            "unary_expression" => {
                let operator = match self.field(node, "operator")?.kind() {
                    "+" => UnaryOperator::Plus,
                    "-" => UnaryOperator::Minus,
                    "!" => UnaryOperator::Not,
                    _ => UnaryOperator::Complement,
                };
                parts.push(OperandPart::Unary(operator, node.start()));
                self.write_out(self.field(node, "operand")?, parts)
            }
            "update_expression" => match children(node)[..] {
                [step, target] if matches!(step.kind(), "++" | "--") => {
                    parts.push(OperandPart::StepBefore(step.kind() == "++", node.start()));
                    self.write_out(target, parts)
                }
                [target, step] => {
                    self.write_out(target, parts)?;
                    parts.push(OperandPart::StepBehind(step.kind() == "++"));
                    Ok(())
                }
                _ => Err(self.misread(node)),
            },
            "cast_expression" => self.write_out_cast(node, parts),
            _ => {
                parts.push(OperandPart::Operand(node));
                Ok(())
            }
        }
    }

    fn write_out_cast<'n>(
        &self,
        node: SyntaxNode<'n>,
        parts: &mut Vec<OperandPart<'n>>,
    ) -> Result<(), SyntaxFault> {
        let types: Vec<_> = node.fields("type").collect();
        let Some(first) = types.first() else { return Err(self.misread(node)) };
        let is_name = matches!(first.kind(), "type_identifier" | "scoped_type_identifier");
        let cast = parts.len();
        // The first type of `(A & B) value` determines the cast.
        parts.push(OperandPart::Cast(self.type_name(*first)?, node.start()));
        self.write_out(self.field(node, "value")?, parts)?;
        let sign = match parts.get(cast + 1) {
            Some(OperandPart::Unary(UnaryOperator::Plus, _)) => BinaryOperator::Add,
            Some(OperandPart::Unary(UnaryOperator::Minus, _)) => BinaryOperator::Subtract,
            _ => return Ok(()),
        };
        if is_name && types.len() == 1 {
            parts[cast] = OperandPart::Operand(*first);
            parts[cast + 1] = OperandPart::Binary(sign);
        }
        Ok(())
    }

    /// Reads an expression up to the first operator below a rank.
    fn ranked<'n>(
        &self,
        parts: &mut OperandParts<'n>,
        min_rank: u8,
        node: SyntaxNode<'n>,
    ) -> Result<PlacedExpression, SyntaxFault> {
        let (mut left, start) = self.unary(parts, node)?;
        let line = self.lines.line(start);
        loop {
            let is_lambda = matches!(left.kind, ExpressionKind::Lambda(_));
            if is_lambda && !matches!(parts.peek(), None | Some(OperandPart::Colon)) {
                return Err(self.misread(node));
            }
            let kind = match parts.peek() {
                Some(OperandPart::Binary(operator)) if rank(*operator) >= min_rank => {
                    let operator = *operator;
                    parts.next();
                    let right = Box::new(self.ranked(parts, rank(operator) + 1, node)?.0);
                    ExpressionKind::Binary { operator, left: Box::new(left), right }
                }
                Some(OperandPart::InstanceOf(_)) if COMPARISON >= min_rank => {
                    let Some(OperandPart::InstanceOf(pattern)) = parts.next() else {
                        return Err(self.misread(node));
                    };
                    ExpressionKind::InstanceOf { value: Box::new(left), pattern }
                }
                Some(OperandPart::Question) if CONDITION >= min_rank => {
                    parts.next();
                    let then_value = Box::new(self.ranked(parts, ASSIGNMENT, node)?.0);
                    let Some(OperandPart::Colon) = parts.next() else {
                        return Err(self.misread(node));
                    };
                    let otherwise = Box::new(self.ranked(parts, CONDITION, node)?.0);
                    ExpressionKind::Conditional { condition: Box::new(left), then_value, otherwise }
                }
                Some(OperandPart::Assign(operator)) if ASSIGNMENT >= min_rank => {
                    let operator = *operator;
                    parts.next();
                    if !is_target(&left.kind) {
                        return Err(no_variable(start));
                    }
                    let value = Box::new(self.ranked(parts, ASSIGNMENT, node)?.0);
                    ExpressionKind::Assign { operator, target: Box::new(left), value }
                }
                _ => return Ok((left, start)),
            };
            left = Expression { line, kind };
        }
    }

    fn unary<'n>(
        &self,
        parts: &mut OperandParts<'n>,
        node: SyntaxNode<'n>,
    ) -> Result<PlacedExpression, SyntaxFault> {
        let (start, kind) = match parts.next() {
            Some(OperandPart::Operand(operand)) => return self.stepped(parts, operand),
            Some(OperandPart::Unary(operator, start)) => {
                if operator == UnaryOperator::Minus
                    && let Some(minimum) = self.least_number(parts)
                {
                    (start, ExpressionKind::Literal(minimum))
                } else {
                    let value = Box::new(self.unary(parts, node)?.0);
                    (start, ExpressionKind::Unary { operator, value })
                }
            }
            Some(OperandPart::StepBefore(is_increment, start)) => {
                let target = Box::new(self.unary(parts, node)?.0);
                check_counted(&target.kind, start)?;
                (start, ExpressionKind::Step { target, is_increment, is_prefix: true })
            }
            Some(OperandPart::Cast(type_name, start)) => {
                let value = Box::new(self.unary(parts, node)?.0);
                (start, ExpressionKind::Cast { type_name, value })
            }
            _ => return Err(self.misread(node)),
        };
        Ok((Expression { line: self.lines.line(start), kind }, start))
    }

    /// Reads an operand with postfix `++` or `--`.
    fn stepped<'n>(
        &self,
        parts: &mut OperandParts<'n>,
        operand: SyntaxNode<'n>,
    ) -> Result<PlacedExpression, SyntaxFault> {
        let (mut read, start) = self.operand(operand)?;
        while let Some(OperandPart::StepBehind(is_increment)) = parts.peek() {
            let is_increment = *is_increment;
            parts.next();
            check_counted(&read.kind, start)?;
            let target = Box::new(read);
            let kind = ExpressionKind::Step { target, is_increment, is_prefix: false };
            read = Expression { line: self.lines.line(start), kind };
        }
        Ok((read, start))
    }

    /// Reads the minimum `int` or `long`, whose sign is part of the number.
    fn least_number(&self, parts: &mut OperandParts<'_>) -> Option<Literal> {
        let Some(OperandPart::Operand(operand)) = parts.peek() else { return None };
        if operand.kind() != "decimal_integer_literal" {
            return None;
        }
        let magnitude = self.integer(*operand, true).ok()?;
        matches!(magnitude, Literal::Int(i32::MIN) | Literal::Long(i64::MIN)).then(|| {
            parts.next();
            magnitude
        })
    }
}

fn has_operator(node: SyntaxNode<'_>) -> bool {
    matches!(
        node.kind(),
        "binary_expression"
            | "assignment_expression"
            | "ternary_expression"
            | "instanceof_expression"
            | "unary_expression"
            | "update_expression"
            | "cast_expression"
    )
}

/// Returns true if an expression can be assigned to.
fn is_target(kind: &ExpressionKind) -> bool {
    matches!(
        kind,
        ExpressionKind::Name(_) | ExpressionKind::Field { .. } | ExpressionKind::Index { .. }
    )
}

fn no_variable(start: usize) -> SyntaxFault {
    SyntaxFault::syntax(start, "only a variable can be given another value")
}

fn check_counted(kind: &ExpressionKind, start: usize) -> Result<(), SyntaxFault> {
    if is_target(kind) {
        return Ok(());
    }
    Err(SyntaxFault::syntax(start, "only a variable can be counted up or down"))
}

fn rank(operator: BinaryOperator) -> u8 {
    use BinaryOperator as Op;
    match operator {
        Op::OrElse => 3,
        Op::AndAlso => 4,
        Op::Or => 5,
        Op::Xor => 6,
        Op::And => 7,
        Op::Equal | Op::NotEqual => 8,
        Op::Less | Op::LessOrEqual | Op::Greater | Op::GreaterOrEqual => COMPARISON,
        Op::ShiftLeft | Op::ShiftRight | Op::ShiftRightUnsigned => 10,
        Op::Add | Op::Subtract => 11,
        Op::Multiply | Op::Divide | Op::Remainder => 12,
    }
}

fn binary_operator(written: &str) -> Option<BinaryOperator> {
    use BinaryOperator as Op;
    Some(match written {
        "+" => Op::Add,
        "-" => Op::Subtract,
        "*" => Op::Multiply,
        "/" => Op::Divide,
        "%" => Op::Remainder,
        "&" => Op::And,
        "|" => Op::Or,
        "^" => Op::Xor,
        "<<" => Op::ShiftLeft,
        ">>" => Op::ShiftRight,
        ">>>" => Op::ShiftRightUnsigned,
        "==" => Op::Equal,
        "!=" => Op::NotEqual,
        "<" => Op::Less,
        ">" => Op::Greater,
        "<=" => Op::LessOrEqual,
        ">=" => Op::GreaterOrEqual,
        "&&" => Op::AndAlso,
        "||" => Op::OrElse,
        _ => return None,
    })
}
