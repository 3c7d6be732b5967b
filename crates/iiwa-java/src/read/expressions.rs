//! Expressions.

use java_lang::{Span, ast};

use super::{fault::Fault, reader::Reader};
use crate::syntax::{BinaryOperator, Expression, ExpressionKind, Literal, TypeName, UnaryOperator};

/// An expression, and where it begins in the file.
type Placed = (Expression, usize);

impl Reader<'_> {
    pub(super) fn expression(&self, expression: &ast::Expr) -> Result<Expression, Fault> {
        Ok(self.placed(expression)?.0)
    }

    pub(super) fn expressions(&self, expressions: &[ast::Expr]) -> Result<Vec<Expression>, Fault> {
        expressions.iter().map(|expression| self.expression(expression)).collect()
    }

    fn boxed(&self, expression: &ast::Expr) -> Result<Box<Expression>, Fault> {
        Ok(Box::new(self.expression(expression)?))
    }

    fn placed(&self, expression: &ast::Expr) -> Result<Placed, Fault> {
        let span = match expression {
            ast::Expr::Literal(literal) => literal.span(),
            ast::Expr::Ident(name) => name.span(),
            ast::Expr::This(span) | ast::Expr::Super(span) => *span,
            ast::Expr::Paren { paren_span, expr } => {
                return Ok((self.expression(expr)?, self.start(paren_span.0)));
            }
            ast::Expr::ClassLit { type_expr, .. } => type_expr.span(),
            ast::Expr::FieldAccess(field) => return self.field_access(field),
            ast::Expr::MethodCall(call) => return self.call(call),
            ast::Expr::ArrayAccess(access) => return self.array_access(access),
            ast::Expr::ArrayNew(array) => array.new_span,
            ast::Expr::Cast(cast) => cast.paren_span.0,
            ast::Expr::Binary(binary) => return self.binary(binary),
            ast::Expr::Unary(unary) => return self.unary(unary),
            ast::Expr::Instanceof(test) => return self.instance_of(test),
            ast::Expr::Assign(assignment) => return self.assignment(assignment),
            ast::Expr::Conditional(choice) => return self.conditional(choice),
            ast::Expr::Lambda(lambda) => lambda.span,
            ast::Expr::Switch(switch) => switch.switch_span,
            ast::Expr::MethodRef(reference) => reference.span(),
            ast::Expr::NewClass(new) => new.new_span,
            ast::Expr::ArrayInit(array) => array.brace_span.0,
        };
        let kind = match expression {
            ast::Expr::Literal(literal) => self.literal(literal)?,
            ast::Expr::Ident(name) => ExpressionKind::Name(self.name(name)?),
            ast::Expr::This(_) => ExpressionKind::This,
            ast::Expr::Super(_) => ExpressionKind::Super,
            ast::Expr::ClassLit { type_expr, .. } => {
                ExpressionKind::ClassLiteral(self.type_name(type_expr)?)
            }
            ast::Expr::ArrayNew(array) => self.new_array(array)?,
            ast::Expr::Cast(cast) => ExpressionKind::Cast {
                type_name: self.type_name(&cast.target_type)?,
                value: self.boxed(&cast.expr)?,
            },
            ast::Expr::NewClass(new) => self.new_object(new)?,
            ast::Expr::ArrayInit(array) => {
                ExpressionKind::Array(self.expressions(&array.elements)?)
            }
            ast::Expr::Switch(_) => unsupported("a switch expression"),
            ast::Expr::MethodRef(_) => unsupported("a method reference"),
            _ => unsupported("a lambda expression"),
        };
        Ok(self.at(span, kind))
    }

    /// An expression that begins at a span.
    fn at(&self, span: Span, kind: ExpressionKind) -> Placed {
        (Expression { line: self.line(span), kind }, self.start(span))
    }

    /// An expression that begins at a byte of the file.
    fn from(&self, start: usize, kind: ExpressionKind) -> Placed {
        (Expression { line: self.lines.line(start), kind }, start)
    }

    fn field_access(&self, field: &ast::FieldAccessExpr) -> Result<Placed, Fault> {
        let (of, start) = self.placed(&field.target)?;
        let kind = match self.source(field.field.span()) {
            "super" => unsupported("`super` of a class that is named before it"),
            "this" => ExpressionKind::Field { of: Box::new(of), name: "this".to_owned() },
            _ => ExpressionKind::Field { of: Box::new(of), name: self.name(&field.field)? },
        };
        Ok((Expression { line: self.line(field.field.span()), kind }, start))
    }

    fn call(&self, call: &ast::MethodCallExpr) -> Result<Placed, Fault> {
        let name_start = self.start(call.method.span());
        let (on, start) = match &call.receiver {
            Some(receiver) => {
                let (on, start) = self.placed(receiver)?;
                (Some(Box::new(on)), start)
            }
            None => (None, name_start),
        };
        let name = self.name(&call.method)?;
        let arguments = self.expressions(&call.args)?;
        let kind = ExpressionKind::Call { on, name, arguments };
        Ok((Expression { line: self.lines.line(name_start), kind }, start))
    }

    fn array_access(&self, access: &ast::ArrayAccessExpr) -> Result<Placed, Fault> {
        let (of, start) = self.placed(&access.array)?;
        let index = self.boxed(&access.index)?;
        Ok(self.from(start, ExpressionKind::Index { of: Box::new(of), index }))
    }

    fn new_array(&self, array: &ast::ArrayNewExpr) -> Result<ExpressionKind, Fault> {
        let at = self.start(array.new_span);
        let is_given = |dim: &ast::ArrayDim, given: &ast::ArrayDimExpr| {
            dim.bracket_span.0.start() < given.bracket_span.0.start()
        };
        if let (Some(dim), Some(given)) = (array.dims.first(), array.dim_exprs.last())
            && is_given(dim, given)
        {
            return Err(Fault::syntax(at, "an array has its lengths in its first brackets"));
        }
        if array.dim_exprs.is_empty() == array.initializer.is_none() {
            return Err(Fault::syntax(at, "an array needs either its lengths or its values"));
        }
        let TypeName { name, dimensions } = self.type_name(&array.elem_type)?;
        let dimensions = dimensions + array.dim_exprs.len() + array.dims.len();
        let lengths = array.dim_exprs.iter().map(|given| self.expression(&given.expr));
        let values = array.initializer.as_ref().map(|values| self.expressions(&values.elements));
        Ok(ExpressionKind::NewArray {
            type_name: TypeName { name, dimensions },
            lengths: lengths.collect::<Result<_, _>>()?,
            values: values.transpose()?,
        })
    }

    fn new_object(&self, new: &ast::NewClassExpr) -> Result<ExpressionKind, Fault> {
        // The parser drops what is before the dot.
        if self.tokens.text_before(self.token(new.new_span)) == "." {
            return Ok(unsupported("an object that is made within another (`outer.new Inner()`)"));
        }
        let type_name = TypeName { name: self.path(&new.class_type)?, dimensions: 0 };
        if self.source(new.paren_span.0) != "(" {
            let at = self.mended.original(new.class_type.span.end());
            return Err(Fault::syntax(at, "`(` is expected behind the class of a new object"));
        }
        let arguments = self.expressions(&new.args)?;
        let body = match &new.body {
            Some(body) => Some(self.unnamed_class(new.class_type.span, body)?),
            None => None,
        };
        Ok(ExpressionKind::New { type_name, arguments, body })
    }

    fn binary(&self, binary: &ast::BinaryExpr) -> Result<Placed, Fault> {
        let (left, start) = self.placed(&binary.left)?;
        let right = self.boxed(&binary.right)?;
        let operator = binary_operator(&binary.op.op);
        Ok(self.from(start, ExpressionKind::Binary { operator, left: Box::new(left), right }))
    }

    fn unary(&self, unary: &ast::UnaryExpr) -> Result<Placed, Fault> {
        let is_step = matches!(
            unary.op,
            ast::UnaryOp::PreInc
                | ast::UnaryOp::PreDec
                | ast::UnaryOp::PostInc
                | ast::UnaryOp::PostDec
        );
        if is_step {
            let (target, start) = self.placed(&unary.expr)?;
            let is_increment = matches!(unary.op, ast::UnaryOp::PreInc | ast::UnaryOp::PostInc);
            let is_prefix = !unary.is_postfix;
            let start = if is_prefix { self.start(unary.op_span) } else { start };
            if !is_target(&target.kind) {
                return Err(Fault::syntax(start, "only a variable can be counted up or down"));
            }
            let target = Box::new(target);
            return Ok(self.from(start, ExpressionKind::Step { target, is_increment, is_prefix }));
        }
        if let (ast::UnaryOp::Neg, ast::Expr::Literal(ast::Lit::Int(number))) =
            (&unary.op, unary.expr.as_ref())
            && let Ok(value @ (Literal::Int(i32::MIN) | Literal::Long(i64::MIN))) =
                self.integer(number, true)
            && self.integer(number, false).is_err()
        {
            return Ok(self.at(unary.op_span, ExpressionKind::Literal(value)));
        }
        let operator = match unary.op {
            ast::UnaryOp::Not => UnaryOperator::Not,
            ast::UnaryOp::Neg => UnaryOperator::Minus,
            _ if self.mended.pluses.binary_search(&self.start(unary.op_span)).is_ok() => {
                UnaryOperator::Plus
            }
            _ => UnaryOperator::Complement,
        };
        let value = self.boxed(&unary.expr)?;
        Ok(self.at(unary.op_span, ExpressionKind::Unary { operator, value }))
    }

    fn instance_of(&self, test: &ast::InstanceofExpr) -> Result<Placed, Fault> {
        let (value, start) = self.placed(&test.expr)?;
        let kind = match &test.pattern {
            ast::InstanceofPattern::Type(written) => ExpressionKind::InstanceOf {
                value: Box::new(value),
                type_name: self.type_name(written)?,
            },
            ast::InstanceofPattern::Pattern(_) => unsupported("an `instanceof` with a pattern"),
        };
        Ok(self.from(start, kind))
    }

    fn assignment(&self, assignment: &ast::AssignExpr) -> Result<Placed, Fault> {
        let (target, start) = match &assignment.target {
            ast::AssignTarget::Ident(name) => {
                self.at(name.span(), ExpressionKind::Name(self.name(name)?))
            }
            ast::AssignTarget::FieldAccess(field) => self.field_access(field)?,
            ast::AssignTarget::ArrayAccess(access) => self.array_access(access)?,
        };
        let kind = ExpressionKind::Assign {
            operator: assignment_operator(&assignment.op.op),
            target: Box::new(target),
            value: self.boxed(&assignment.value)?,
        };
        Ok(self.from(start, kind))
    }

    fn conditional(&self, choice: &ast::ConditionalExpr) -> Result<Placed, Fault> {
        let (condition, start) = self.placed(&choice.cond)?;
        let kind = ExpressionKind::Conditional {
            condition: Box::new(condition),
            then: self.boxed(&choice.then_expr)?,
            otherwise: self.boxed(&choice.else_expr)?,
        };
        Ok(self.from(start, kind))
    }
}

fn unsupported(what: &str) -> ExpressionKind {
    ExpressionKind::Unsupported(what.to_owned())
}

/// Whether something can be given another value.
fn is_target(kind: &ExpressionKind) -> bool {
    matches!(
        kind,
        ExpressionKind::Name(_) | ExpressionKind::Field { .. } | ExpressionKind::Index { .. }
    )
}

fn binary_operator(operator: &ast::BinOp) -> BinaryOperator {
    match operator {
        ast::BinOp::Add => BinaryOperator::Add,
        ast::BinOp::Sub => BinaryOperator::Subtract,
        ast::BinOp::Mul => BinaryOperator::Multiply,
        ast::BinOp::Div => BinaryOperator::Divide,
        ast::BinOp::Rem => BinaryOperator::Remainder,
        ast::BinOp::And => BinaryOperator::And,
        ast::BinOp::Or => BinaryOperator::Or,
        ast::BinOp::Xor => BinaryOperator::Xor,
        ast::BinOp::LShift => BinaryOperator::ShiftLeft,
        ast::BinOp::RShift => BinaryOperator::ShiftRight,
        ast::BinOp::URShift => BinaryOperator::ShiftRightUnsigned,
        ast::BinOp::Eq => BinaryOperator::Equal,
        ast::BinOp::Ne => BinaryOperator::NotEqual,
        ast::BinOp::Lt => BinaryOperator::Less,
        ast::BinOp::Gt => BinaryOperator::Greater,
        ast::BinOp::Le => BinaryOperator::LessOrEqual,
        ast::BinOp::Ge => BinaryOperator::GreaterOrEqual,
        ast::BinOp::LAnd => BinaryOperator::AndAlso,
        ast::BinOp::LOr => BinaryOperator::OrElse,
    }
}

/// What is done before the value is assigned.
fn assignment_operator(operator: &ast::AssignOp) -> Option<BinaryOperator> {
    Some(match operator {
        ast::AssignOp::Assign => return None,
        ast::AssignOp::AddAssign => BinaryOperator::Add,
        ast::AssignOp::SubAssign => BinaryOperator::Subtract,
        ast::AssignOp::MulAssign => BinaryOperator::Multiply,
        ast::AssignOp::DivAssign => BinaryOperator::Divide,
        ast::AssignOp::RemAssign => BinaryOperator::Remainder,
        ast::AssignOp::AndAssign => BinaryOperator::And,
        ast::AssignOp::OrAssign => BinaryOperator::Or,
        ast::AssignOp::XorAssign => BinaryOperator::Xor,
        ast::AssignOp::LShiftAssign => BinaryOperator::ShiftLeft,
        ast::AssignOp::RShiftAssign => BinaryOperator::ShiftRight,
        ast::AssignOp::URShiftAssign => BinaryOperator::ShiftRightUnsigned,
    })
}
