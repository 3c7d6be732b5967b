//! Lambda expressions and method references.

use std::sync::Arc;

use super::{
    expressions::unsupported,
    fault::SyntaxFault,
    reader::{TreeReader, children, named},
    tree::SyntaxNode,
};
use crate::syntax::{
    Expression, ExpressionKind, Lambda, Parameter, Reference, ReferenceTarget, Statement,
    StatementKind, TypeName,
};

impl TreeReader<'_> {
    pub(super) fn lambda(&self, node: SyntaxNode<'_>) -> Result<Lambda, SyntaxFault> {
        let line = self.line(node);
        let parameters = self.lambda_parameters(self.field(node, "parameters")?)?;
        let written = self.field(node, "body")?;
        let names = self.names(written);
        if written.kind() != "block" {
            let expression = self.expression(written)?;
            let is_void_compatible = is_statement_expression(&expression.kind);
            let kind = StatementKind::Return(Some(expression));
            let body = vec![Statement { line: self.line(written), kind }];
            let is_value_compatible = true;
            return Ok(Lambda {
                line,
                parameters,
                body,
                names,
                is_void_compatible,
                is_value_compatible,
            });
        }
        let body = self.block(written)?;
        let mut returns = Returns::default();
        returns.of_all(&body);
        Ok(Lambda {
            line,
            parameters,
            is_void_compatible: !returns.a_value,
            // JLS 15.27.2: the body cannot complete normally, and each `return` has a value.
            is_value_compatible: !returns.nothing && !can_complete(&body),
            body,
            names,
        })
    }

    fn lambda_parameters(&self, node: SyntaxNode<'_>) -> Result<Vec<Parameter>, SyntaxFault> {
        let inferred = |node: SyntaxNode<'_>| {
            Ok(Parameter { name: self.name(node)?, type_name: TypeName::new("var", 0) })
        };
        match node.kind() {
            "formal_parameters" => Ok(self.parameters(node)?.0),
            "inferred_parameters" => named(node).into_iter().map(inferred).collect(),
            _ => Ok(vec![inferred(node)?]),
        }
    }

    pub(super) fn reference(&self, node: SyntaxNode<'_>) -> Result<ExpressionKind, SyntaxFault> {
        let parts = children(node);
        let (Some(before), Some(last)) = (parts.first(), parts.last()) else {
            return Err(self.misread(node));
        };
        let name = match last.kind() {
            "new" => None,
            _ => Some(self.name(*last)?),
        };
        let target = match before.kind() {
            "super" => return Ok(unsupported("a method reference to `super`")),
            "generic_type"
            | "array_type"
            | "integral_type"
            | "floating_point_type"
            | "boolean_type"
            | "annotated_type" => ReferenceTarget::Type(self.type_name(*before)?),
            _ if name.is_none() => ReferenceTarget::Type(self.type_name_of(*before)?),
            _ => ReferenceTarget::Expression(self.expression(*before)?),
        };
        let (line, names) = (self.line(node), self.names(node));
        Ok(ExpressionKind::Reference(Arc::new(Reference { line, target, name, names })))
    }

    /// Returns the names in a node, in order, without duplicates.
    fn names(&self, node: SyntaxNode<'_>) -> Vec<String> {
        let mut names = Vec::new();
        let mut open = vec![node];
        while let Some(node) = open.pop() {
            if matches!(node.kind(), "identifier" | "type_identifier") {
                names.push(self.source(node).to_owned());
            }
            open.extend(named(node));
        }
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Reads the type before `::new`, which the grammar may parse as a value.
    fn type_name_of(&self, node: SyntaxNode<'_>) -> Result<TypeName, SyntaxFault> {
        match node.kind() {
            "field_access" => Ok(TypeName::new(self.source(node), 0)),
            _ => self.type_name(node),
        }
    }
}

/// Returns true for a statement expression (JLS 14.8).
pub(super) fn is_statement_expression(kind: &ExpressionKind) -> bool {
    matches!(
        kind,
        ExpressionKind::Assign { .. }
            | ExpressionKind::Step { .. }
            | ExpressionKind::Call { .. }
            | ExpressionKind::New { .. }
    )
}

/// The `return` statements of a lambda body.
#[derive(Default)]
struct Returns {
    a_value: bool,
    nothing: bool,
}

impl Returns {
    fn of_all<'s>(&mut self, statements: impl IntoIterator<Item = &'s Statement>) {
        for statement in statements {
            self.of(statement);
        }
    }

    fn of(&mut self, statement: &Statement) {
        match &statement.kind {
            StatementKind::Return(Some(_)) => self.a_value = true,
            StatementKind::Return(None) => self.nothing = true,
            StatementKind::Block(body) | StatementKind::Synchronized { body } => self.of_all(body),
            StatementKind::If { then_branch, otherwise, .. } => {
                self.of(then_branch);
                self.of_all(otherwise.as_deref());
            }
            StatementKind::While { body, .. }
            | StatementKind::DoWhile { body, .. }
            | StatementKind::For { body, .. }
            | StatementKind::ForEach { body, .. }
            | StatementKind::Labelled { body, .. } => self.of(body),
            StatementKind::Switch { groups, .. } => {
                self.of_all(groups.iter().flat_map(|group| &group.body));
            }
            StatementKind::Try { body, catches, finally, .. } => {
                self.of_all(body);
                self.of_all(catches.iter().flat_map(|catch| &catch.body));
                self.of_all(finally.iter().flatten());
            }
            _ => {}
        }
    }
}

fn can_complete(statements: &[Statement]) -> bool {
    statements.last().is_none_or(completes)
}

/// Returns true if a statement may complete normally (JLS 14.22), without regard to `break`.
pub(crate) fn completes(statement: &Statement) -> bool {
    let is_true = |condition: &Expression| {
        matches!(condition.kind, ExpressionKind::Literal(crate::syntax::Literal::Boolean(true)))
    };
    match &statement.kind {
        StatementKind::Return(_)
        | StatementKind::Throw(_)
        | StatementKind::Yield(_)
        | StatementKind::Break(_)
        | StatementKind::Continue(_) => false,
        StatementKind::Block(body) | StatementKind::Synchronized { body } => can_complete(body),
        StatementKind::If { then_branch, otherwise: Some(otherwise), .. } => {
            completes(then_branch) || completes(otherwise)
        }
        StatementKind::While { condition, .. } | StatementKind::DoWhile { condition, .. } => {
            !is_true(condition)
        }
        StatementKind::For { condition, .. } => {
            condition.as_ref().is_some_and(|condition| !is_true(condition))
        }
        StatementKind::Labelled { body, .. } => completes(body),
        StatementKind::Switch { groups, .. } => {
            let has_default = groups
                .iter()
                .flat_map(|group| &group.labels)
                .any(|label| matches!(label, crate::syntax::Label::Default));
            !has_default || groups.iter().any(|group| can_complete(&group.body))
        }
        StatementKind::Try { body, catches, finally, .. } => {
            finally.as_ref().is_none_or(|finally| can_complete(finally))
                && (can_complete(body) || catches.iter().any(|catch| can_complete(&catch.body)))
        }
        _ => true,
    }
}
