//! Syntax as short texts, with all of its parts except the lines.

use crate::syntax::{
    BinaryOperator, Class, ClassKind, Expression, ExpressionKind, Label, Literal, Member, Method,
    Pattern, ReferenceTarget, Statement, StatementKind, SwitchGroup, TypeName, UnaryOperator,
};

pub(super) fn type_name(name: &TypeName) -> String {
    format!("{}{}", name.name, "[]".repeat(name.dimensions))
}

fn list<T>(parts: &[T], shown: impl Fn(&T) -> String) -> String {
    parts.iter().map(shown).collect::<Vec<_>>().join(" ")
}

fn optional<T>(part: Option<&T>, shown: impl Fn(&T) -> String) -> String {
    part.map_or("-".to_owned(), shown)
}

pub(super) fn expression(shown: &Expression) -> String {
    let boxed = |inner: &Expression| expression(inner);
    match &shown.kind {
        ExpressionKind::Literal(Literal::Null) => "null".to_owned(),
        ExpressionKind::Literal(Literal::Boolean(value)) => format!("{value}"),
        ExpressionKind::Literal(Literal::Char(unit)) => format!("c{unit}"),
        ExpressionKind::Literal(Literal::Int(value)) => format!("{value}"),
        ExpressionKind::Literal(Literal::Long(value)) => format!("{value}L"),
        ExpressionKind::Literal(Literal::Float(value)) => format!("{value:?}f"),
        ExpressionKind::Literal(Literal::Double(value)) => format!("{value:?}"),
        ExpressionKind::Literal(Literal::String(text)) => format!("{text:?}"),
        ExpressionKind::Name(name) => name.clone(),
        ExpressionKind::Field { object, name } => format!("{}.{name}", boxed(object)),
        ExpressionKind::Call { on, name, arguments } => {
            let on = on.as_ref().map_or(String::new(), |on| format!("{}.", boxed(on)));
            format!("{on}{name}({})", list(arguments, expression))
        }
        ExpressionKind::ThisCall(arguments) => format!("this({})", list(arguments, expression)),
        ExpressionKind::SuperCall(arguments) => format!("super({})", list(arguments, expression)),
        ExpressionKind::New { type_name: created, arguments, body } => {
            let body = body.as_ref().map_or(String::new(), |body| class(body));
            format!("new {}({}){body}", type_name(created), list(arguments, expression))
        }
        ExpressionKind::NewArray { type_name: element, lengths, values } => {
            let values = optional(values.as_ref(), |values| list(values, expression));
            format!("new {} [{}] {{{values}}}", type_name(element), list(lengths, expression))
        }
        ExpressionKind::Array(values) => format!("{{{}}}", list(values, expression)),
        ExpressionKind::Index { array, index } => format!("{}[{}]", boxed(array), boxed(index)),
        ExpressionKind::Unary { operator, value } => {
            let operator = match operator {
                UnaryOperator::Plus => "+",
                UnaryOperator::Minus => "-",
                UnaryOperator::Not => "!",
                UnaryOperator::Complement => "~",
            };
            format!("({operator} {})", boxed(value))
        }
        ExpressionKind::Step { target, is_increment, is_prefix } => {
            let operator = if *is_increment { "++" } else { "--" };
            let target = boxed(target);
            if *is_prefix {
                format!("({operator}{target})")
            } else {
                format!("({target}{operator})")
            }
        }
        ExpressionKind::Binary { operator, left, right } => {
            format!("({} {} {})", boxed(left), binary(*operator), boxed(right))
        }
        ExpressionKind::Assign { operator, target, value } => {
            let operator = operator.map_or("", binary);
            format!("({} {operator}= {})", boxed(target), boxed(value))
        }
        ExpressionKind::Conditional { condition, then_value, otherwise } => {
            format!("({} ? {} : {})", boxed(condition), boxed(then_value), boxed(otherwise))
        }
        ExpressionKind::Cast { type_name: to, value } => {
            format!("(({}) {})", type_name(to), boxed(value))
        }
        ExpressionKind::InstanceOf { value, pattern: tested } => {
            format!("({} instanceof {})", boxed(value), pattern(tested))
        }
        ExpressionKind::This => "this".to_owned(),
        ExpressionKind::Super => "super".to_owned(),
        ExpressionKind::SuperOf(class) => format!("{}.super", type_name(class)),
        ExpressionKind::ClassLiteral(class) => format!("{}.class", type_name(class)),
        ExpressionKind::Switch { value, groups } => {
            format!("(switch {} {})", expression(value), list(groups, group))
        }
        ExpressionKind::Lambda(lambda) => {
            let parameters = list(&lambda.parameters, |parameter| {
                format!("{} {}", type_name(&parameter.type_name), parameter.name)
            });
            format!("({parameters} -> {})", block(&lambda.body))
        }
        ExpressionKind::Reference(reference) => {
            let target = match &reference.target {
                ReferenceTarget::Expression(object) => expression(object),
                ReferenceTarget::Type(named_type) => format!("type {}", type_name(named_type)),
            };
            format!("({target}::{})", reference.name.as_deref().unwrap_or("new"))
        }
        ExpressionKind::Unsupported(construct) => format!("<{construct}>"),
    }
}

fn pattern(shown: &Pattern) -> String {
    match shown {
        Pattern::Type { type_name: matched, name: None } => type_name(matched),
        Pattern::Type { type_name: matched, name: Some(name) } => {
            format!("{} {name}", type_name(matched))
        }
        Pattern::Record { type_name: matched, parts } => {
            format!("{}({})", type_name(matched), list(parts, pattern))
        }
        Pattern::Any => "_".to_owned(),
    }
}

fn binary(operator: BinaryOperator) -> &'static str {
    match operator {
        BinaryOperator::Add => "+",
        BinaryOperator::Subtract => "-",
        BinaryOperator::Multiply => "*",
        BinaryOperator::Divide => "/",
        BinaryOperator::Remainder => "%",
        BinaryOperator::ShiftLeft => "<<",
        BinaryOperator::ShiftRight => ">>",
        BinaryOperator::ShiftRightUnsigned => ">>>",
        BinaryOperator::Less => "<",
        BinaryOperator::LessOrEqual => "<=",
        BinaryOperator::Greater => ">",
        BinaryOperator::GreaterOrEqual => ">=",
        BinaryOperator::Equal => "==",
        BinaryOperator::NotEqual => "!=",
        BinaryOperator::And => "&",
        BinaryOperator::Xor => "^",
        BinaryOperator::Or => "|",
        BinaryOperator::AndAlso => "&&",
        BinaryOperator::OrElse => "||",
    }
}

pub(super) fn block(statements: &[Statement]) -> String {
    format!("{{{}}}", list(statements, statement))
}

pub(super) fn statement(shown: &Statement) -> String {
    match &shown.kind {
        StatementKind::Block(statements) => block(statements),
        StatementKind::Local { type_name: declared, variables } => {
            let variables = list(variables, |variable| {
                let initial = optional(variable.initial.as_ref(), expression);
                format!("{}{}={initial}", variable.name, "[]".repeat(variable.dimensions))
            });
            format!("{} {variables};", type_name(declared))
        }
        StatementKind::LocalClass(local) => class(local),
        StatementKind::Expression(value) => format!("{};", expression(value)),
        StatementKind::If { condition, then_branch, otherwise } => {
            let otherwise = optional(otherwise.as_ref(), |otherwise| statement(otherwise));
            format!("if {} {} else {otherwise}", expression(condition), statement(then_branch))
        }
        StatementKind::While { condition, body } => {
            format!("while {} {}", expression(condition), statement(body))
        }
        StatementKind::DoWhile { body, condition } => {
            format!("do {} while {}", statement(body), expression(condition))
        }
        StatementKind::For { initial, condition, update, body } => {
            let (initial, update) = (list(initial, statement), list(update, expression));
            let condition = optional(condition.as_ref(), expression);
            format!("for ({initial} | {condition} | {update}) {}", statement(body))
        }
        StatementKind::ForEach { type_name: element, name, iterable, body } => {
            format!(
                "for ({} {name} : {}) {}",
                type_name(element),
                expression(iterable),
                statement(body)
            )
        }
        StatementKind::Switch { value, groups } => {
            format!("switch {} {}", expression(value), list(groups, group))
        }
        StatementKind::Yield(value) => format!("yield {};", expression(value)),
        StatementKind::Break(label) => {
            format!("break {};", optional(label.as_ref(), String::clone))
        }
        StatementKind::Continue(label) => {
            format!("continue {};", optional(label.as_ref(), String::clone))
        }
        StatementKind::Return(value) => format!("return {};", optional(value.as_ref(), expression)),
        StatementKind::Throw(value) => format!("throw {};", expression(value)),
        StatementKind::Try { resources, body, catches, finally } => {
            let catches = list(catches, |clause| {
                format!(
                    "catch {} {} {}",
                    list(&clause.types, type_name),
                    clause.name,
                    block(&clause.body)
                )
            });
            let finally = optional(finally.as_ref(), |finally| block(finally));
            format!(
                "try ({}) {} {catches} finally {finally}",
                list(resources, statement),
                block(body)
            )
        }
        StatementKind::Labelled { label, body } => format!("{label}: {}", statement(body)),
        StatementKind::Synchronized { body } => format!("synchronized {}", block(body)),
        StatementKind::Assert => "assert;".to_owned(),
        StatementKind::Empty => ";".to_owned(),
        StatementKind::Unsupported(construct) => format!("<{construct}>;"),
    }
}

fn group(shown: &SwitchGroup) -> String {
    let labels = list(&shown.labels, |label| match label {
        Label::Default => "default".to_owned(),
        Label::Value(value) => expression(value),
        Label::Pattern(label) => pattern(label),
    });
    let guard =
        shown.guard.as_ref().map_or(String::new(), |guard| format!(" when {}", expression(guard)));
    let arrow = if shown.falls_through { ":" } else { "->" };
    format!("[{labels}{guard}]{arrow}{}", block(&shown.body))
}

pub(super) fn class(shown: &Class) -> String {
    let kind = match shown.kind {
        ClassKind::Class => "class",
        ClassKind::Interface => "interface",
        ClassKind::Enum => "enum",
        ClassKind::Record => "record",
    };
    let is_abstract = if shown.is_abstract { "abstract " } else { "" };
    let extends = optional(shown.extends.as_ref(), type_name);
    let mut parts = vec![format!(
        "{is_abstract}{kind} {} extends {extends} implements [{}]",
        shown.name,
        list(&shown.implements, type_name)
    )];
    for constant in &shown.constants {
        let body = constant.body.as_ref().map_or(String::new(), |body| class(body));
        parts.push(format!("{}({}){body}", constant.name, list(&constant.arguments, expression)));
    }
    for member in &shown.members {
        parts.push(match member {
            Member::Field(field) => {
                let is_static = if field.is_static { "static " } else { "" };
                let annotations = list(&field.annotations, |annotation| {
                    format!(
                        "@{}={} ",
                        annotation.name,
                        optional(annotation.value.as_ref(), String::clone)
                    )
                });
                let annotations = annotations.replace("  ", " ");
                let initial = optional(field.initial.as_ref(), expression);
                format!(
                    "{annotations}{is_static}{} {}={initial}",
                    type_name(&field.type_name),
                    field.name
                )
            }
            Member::Initializer { is_static, body } => {
                format!("{}{}", if *is_static { "static " } else { "" }, block(body))
            }
        });
    }
    parts.extend(shown.methods.iter().map(|declared| method(declared)));
    parts.extend(shown.constructors.iter().map(|declared| format!("new {}", method(declared))));
    parts.extend(shown.classes.iter().map(|inner| class(inner)));
    format!("<{}>", parts.join(", "))
}

fn method(shown: &Method) -> String {
    let is_static = if shown.is_static { "static " } else { "" };
    let annotations: String =
        shown.annotations.iter().flat_map(|annotation| ["@", &annotation.name, " "]).collect();
    let parameters = list(&shown.parameters, |parameter| {
        format!("{} {}", type_name(&parameter.type_name), parameter.name)
    });
    let any_number = if shown.is_variadic { "..." } else { "" };
    let body = optional(shown.body.as_ref(), |body| block(body));
    format!(
        "{annotations}{is_static}{} {}({parameters}{any_number}) {body}",
        type_name(&shown.returns),
        shown.name
    )
}
