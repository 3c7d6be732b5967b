//! Statements.

use super::{
    declarations::is_class,
    fault::SyntaxFault,
    functions::is_statement_expression,
    reader::{TreeReader, brackets, child_of_kind, children, named},
    tree::SyntaxNode,
};
use crate::syntax::{
    Catch, Expression, ExpressionKind, Label, LocalVariable, Pattern, Statement, StatementKind,
    SwitchGroup,
};

impl TreeReader<'_> {
    pub(super) fn block(&self, block: SyntaxNode<'_>) -> Result<Vec<Statement>, SyntaxFault> {
        self.statements(&children(block))
    }

    /// Reads statements; the nodes may include the surrounding braces and other symbols.
    fn statements(&self, nodes: &[SyntaxNode<'_>]) -> Result<Vec<Statement>, SyntaxFault> {
        let is_statement = |node: &&SyntaxNode<'_>| node.is_named() || node.kind() == ";";
        nodes.iter().filter(is_statement).map(|node| self.statement(*node)).collect()
    }

    fn boxed_statement(&self, node: SyntaxNode<'_>) -> Result<Box<Statement>, SyntaxFault> {
        Ok(Box::new(self.statement(node)?))
    }

    pub(super) fn statement(&self, node: SyntaxNode<'_>) -> Result<Statement, SyntaxFault> {
        let kind = match node.kind() {
            ";" => StatementKind::Empty,
            "block" => StatementKind::Block(self.block(node)?),
            "labeled_statement" => {
                let [label, body] = children_of_label(node).ok_or_else(|| self.misread(node))?;
                let label = self.name(label)?;
                StatementKind::Labelled { label, body: self.boxed_statement(body)? }
            }
            "expression_statement" => {
                let expression = self.only(node)?;
                let read = self.expression(expression)?;
                if !is_statement(&read.kind) {
                    let message = "expected a statement: this expression has no effect";
                    return Err(SyntaxFault::syntax(expression.start(), message));
                }
                StatementKind::Expression(read)
            }
            "local_variable_declaration" => return self.local(node),
            "if_statement" => StatementKind::If {
                condition: self.expression(self.field(node, "condition")?)?,
                then_branch: self.boxed_statement(self.field(node, "consequence")?)?,
                otherwise: match node.field("alternative") {
                    Some(otherwise) => Some(self.boxed_statement(otherwise)?),
                    None => None,
                },
            },
            "assert_statement" => StatementKind::Assert,
            "switch_expression" => {
                let (value, groups) = self.switch(node, false)?;
                StatementKind::Switch { value, groups }
            }
            "while_statement" => StatementKind::While {
                condition: self.expression(self.field(node, "condition")?)?,
                body: self.boxed_statement(self.field(node, "body")?)?,
            },
            "do_statement" => StatementKind::DoWhile {
                body: self.boxed_statement(self.field(node, "body")?)?,
                condition: self.expression(self.field(node, "condition")?)?,
            },
            "for_statement" => self.count(node)?,
            "enhanced_for_statement" => {
                let type_name = self.type_name(self.field(node, "type")?)?;
                let more = node.field("dimensions").map_or(0, brackets);
                StatementKind::ForEach {
                    type_name: type_name.with_dimensions(type_name.dimensions + more),
                    name: self.name(self.field(node, "name")?)?,
                    iterable: self.expression(self.field(node, "value")?)?,
                    body: self.boxed_statement(self.field(node, "body")?)?,
                }
            }
            "break_statement" => StatementKind::Break(self.label(node)?),
            "continue_statement" => StatementKind::Continue(self.label(node)?),
            "return_statement" => {
                let value = named(node).into_iter().next();
                StatementKind::Return(value.map(|value| self.expression(value)).transpose()?)
            }
            "throw_statement" => StatementKind::Throw(self.expression(self.only(node)?)?),
            "yield_statement" => StatementKind::Yield(self.expression(self.only(node)?)?),
            "synchronized_statement" => {
                StatementKind::Synchronized { body: self.block(self.field(node, "body")?)? }
            }
            "try_statement" | "try_with_resources_statement" => self.attempt(node)?,
            _ if is_class(node) => {
                let kind = match self.class(node)? {
                    Some(class) => StatementKind::LocalClass(class),
                    None => StatementKind::Unsupported("an annotation type".to_owned()),
                };
                return Ok(Statement { line: self.line(node), kind });
            }
            _ => return Err(self.misread(node)),
        };
        Ok(Statement { line: self.line(node), kind })
    }

    /// Returns the only child other than symbols and keywords.
    pub(super) fn only<'n>(&self, node: SyntaxNode<'n>) -> Result<SyntaxNode<'n>, SyntaxFault> {
        match named(node)[..] {
            [only] => Ok(only),
            _ => Err(self.misread(node)),
        }
    }

    fn local(&self, node: SyntaxNode<'_>) -> Result<Statement, SyntaxFault> {
        let type_name = self.type_name(self.field(node, "type")?)?;
        let mut variables = Vec::new();
        for variable in node.fields("declarator") {
            variables.push(self.variable(variable)?);
        }
        let kind = StatementKind::Local { type_name, variables };
        Ok(Statement { line: self.line(node), kind })
    }

    /// Reads a variable or a field, from its name on.
    pub(super) fn variable(&self, node: SyntaxNode<'_>) -> Result<LocalVariable, SyntaxFault> {
        let initial = node.field("value");
        Ok(LocalVariable {
            name: self.name(self.field(node, "name")?)?,
            dimensions: node.field("dimensions").map_or(0, brackets),
            initial: initial.map(|initial| self.expression(initial)).transpose()?,
        })
    }

    fn label(&self, node: SyntaxNode<'_>) -> Result<Option<String>, SyntaxFault> {
        named(node).into_iter().next().map(|label| self.name(label)).transpose()
    }

    fn count(&self, node: SyntaxNode<'_>) -> Result<StatementKind, SyntaxFault> {
        let mut initial = Vec::new();
        for initial_node in node.fields("init") {
            initial.push(if initial_node.kind() == "local_variable_declaration" {
                self.local(initial_node)?
            } else {
                let kind = StatementKind::Expression(self.expression(initial_node)?);
                Statement { line: self.line(initial_node), kind }
            });
        }
        let condition = node.field("condition");
        let update: Vec<_> = node.fields("update").collect();
        Ok(StatementKind::For {
            initial,
            condition: condition.map(|condition| self.expression(condition)).transpose()?,
            update: self.expressions(&update)?,
            body: self.boxed_statement(self.field(node, "body")?)?,
        })
    }

    /// Reads the value and the groups of a switch; with `has_value`, expressions after `->` are
    /// values.
    pub(super) fn switch(
        &self,
        node: SyntaxNode<'_>,
        has_value: bool,
    ) -> Result<(Expression, Vec<SwitchGroup>), SyntaxFault> {
        let value = self.expression(self.field(node, "condition")?)?;
        let groups = named(self.field(node, "body")?);
        let groups = groups.into_iter().map(|group| self.switch_group(group, has_value));
        Ok((value, groups.collect::<Result<_, _>>()?))
    }

    fn switch_group(
        &self,
        node: SyntaxNode<'_>,
        has_value: bool,
    ) -> Result<SwitchGroup, SyntaxFault> {
        let mut labels = Vec::new();
        let mut guard = None;
        let mut body = Vec::new();
        for child in children(node) {
            if child.kind() == "switch_label" {
                self.switch_labels(child, &mut labels)?;
                if let Some(written) = child_of_kind(child, "guard") {
                    guard = Some(self.expression(self.only(written)?)?);
                }
            } else if child.is_named() || child.kind() == ";" {
                let is_value = has_value && child.kind() == "expression_statement";
                body.push(if is_value && node.kind() == "switch_rule" {
                    let kind = StatementKind::Yield(self.expression(self.only(child)?)?);
                    Statement { line: self.line(child), kind }
                } else {
                    self.statement(child)?
                });
            }
        }
        Ok(SwitchGroup { labels, guard, body, falls_through: node.kind() != "switch_rule" })
    }

    fn switch_labels(
        &self,
        node: SyntaxNode<'_>,
        labels: &mut Vec<Label>,
    ) -> Result<(), SyntaxFault> {
        let values = named(node);
        if values.is_empty() {
            labels.push(Label::Default);
        }
        for value in values {
            match value.kind() {
                "pattern" => labels.push(Label::Pattern(self.pattern(self.only(value)?)?)),
                "guard" => {}
                // Label of `case null, default`.
                "identifier" if self.source(value) == "default" => labels.push(Label::Default),
                _ => labels.push(Label::Value(self.expression(value)?)),
            }
        }
        Ok(())
    }

    /// Reads a pattern of `case`, or a record pattern of `instanceof`.
    pub(super) fn pattern(&self, node: SyntaxNode<'_>) -> Result<Pattern, SyntaxFault> {
        match (node.kind(), &named(node)[..]) {
            ("underscore_pattern", _) => Ok(Pattern::Any),
            ("record_pattern_component", [only]) => self.pattern(*only),
            ("type_pattern" | "record_pattern_component", [type_node, name]) => {
                let name = Some(self.name(*name)?);
                Ok(Pattern::Type { type_name: self.type_name(*type_node)?, name })
            }
            ("record_pattern", [type_node, body]) => {
                let parts = named(*body).into_iter().map(|node| self.pattern(node));
                let parts = parts.collect::<Result<_, _>>()?;
                Ok(Pattern::Record { type_name: self.type_name(*type_node)?, parts })
            }
            _ => Err(self.misread(node)),
        }
    }

    fn attempt(&self, node: SyntaxNode<'_>) -> Result<StatementKind, SyntaxFault> {
        let mut resources = Vec::new();
        let written = node.field("resources").map_or(Vec::new(), named);
        for resource in written {
            let line = self.line(resource);
            let kind = match resource.field("type") {
                Some(type_node) => {
                    let value = self.field(resource, "value")?;
                    let variable = LocalVariable {
                        name: self.name(self.field(resource, "name")?)?,
                        dimensions: 0,
                        initial: Some(self.expression(value)?),
                    };
                    let type_name = self.type_name(type_node)?;
                    StatementKind::Local { type_name, variables: vec![variable] }
                }
                None => StatementKind::Expression(self.expression(self.only(resource)?)?),
            };
            resources.push(Statement { line, kind });
        }
        let mut catches = Vec::new();
        let mut finally = None;
        for child in named(node) {
            match child.kind() {
                "catch_clause" => catches.push(self.catch(child)?),
                "finally_clause" => finally = Some(self.block(self.only(child)?)?),
                _ => {}
            }
        }
        let body = self.block(self.field(node, "body")?)?;
        Ok(StatementKind::Try { resources, body, catches, finally })
    }

    fn catch(&self, node: SyntaxNode<'_>) -> Result<Catch, SyntaxFault> {
        let parameter =
            child_of_kind(node, "catch_formal_parameter").ok_or_else(|| self.misread(node))?;
        let types = child_of_kind(parameter, "catch_type").ok_or_else(|| self.misread(node))?;
        Ok(Catch {
            types: self.type_names(&named(types))?,
            name: self.name(self.field(parameter, "name")?)?,
            body: self.block(self.field(node, "body")?)?,
        })
    }
}

/// Returns a label with its statement.
fn children_of_label(node: SyntaxNode<'_>) -> Option<[SyntaxNode<'_>; 2]> {
    let [label, _, body] = children(node)[..] else { return None };
    Some([label, body])
}

/// Returns true if an expression is accepted as a statement: a statement expression, a switch, or
/// an unsupported expression.
fn is_statement(kind: &ExpressionKind) -> bool {
    is_statement_expression(kind)
        || matches!(kind, ExpressionKind::Switch { .. } | ExpressionKind::Unsupported(_))
}
