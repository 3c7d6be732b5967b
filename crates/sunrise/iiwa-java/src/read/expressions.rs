//! Expressions without binary operators.

use std::sync::Arc;

use super::{
    fault::SyntaxFault,
    reader::{TreeReader, brackets, child_of_kind, children, is_annotation, named},
    tree::SyntaxNode,
};
use crate::syntax::{Expression, ExpressionKind, TypeName};

/// Expression with its offset in the file.
pub(super) type PlacedExpression = (Expression, usize);

impl TreeReader<'_> {
    pub(super) fn expressions(
        &self,
        nodes: &[SyntaxNode<'_>],
    ) -> Result<Vec<Expression>, SyntaxFault> {
        nodes.iter().map(|node| self.expression(*node)).collect()
    }

    fn boxed(&self, node: SyntaxNode<'_>) -> Result<Box<Expression>, SyntaxFault> {
        Ok(Box::new(self.expression(node)?))
    }

    /// Reads an operand.
    pub(super) fn operand(&self, node: SyntaxNode<'_>) -> Result<PlacedExpression, SyntaxFault> {
        let start = node.start();
        let kind = match node.kind() {
            "parenthesized_expression" => match named(node)[..] {
                [inner] => return Ok((self.expression(inner)?, start)),
                _ => return Err(self.misread(node)),
            },
            "identifier" | "type_identifier" => ExpressionKind::Name(self.name(node)?),
            "this" => ExpressionKind::This,
            "super" => ExpressionKind::Super,
            "class_literal" => {
                let written = named(node).into_iter().next().ok_or_else(|| self.misread(node))?;
                ExpressionKind::ClassLiteral(self.type_name(written)?)
            }
            "field_access" => return self.field_access(node),
            // A name that the parser has read as a type.
            "scoped_type_identifier" => return self.qualified_name(node),
            "method_invocation" => return self.call(node),
            "array_access" => {
                let (array, start) = self.placed(self.field(node, "array")?)?;
                let index = self.boxed(self.field(node, "index")?)?;
                let kind = ExpressionKind::Index { array: Box::new(array), index };
                return Ok((Expression { line: self.lines.line(start), kind }, start));
            }
            "array_creation_expression" => self.new_array(node)?,
            "array_initializer" => ExpressionKind::Array(self.expressions(&named(node))?),
            "object_creation_expression" => self.new_object(node)?,
            "lambda_expression" => ExpressionKind::Lambda(Arc::new(self.lambda(node)?)),
            "method_reference" => self.reference(node)?,
            "template_expression" => unsupported("a string template"),
            "switch_expression" => {
                let (value, groups) = self.switch(node, true)?;
                ExpressionKind::Switch { value: Box::new(value), groups }
            }
            kind if kind.ends_with("_literal") || matches!(kind, "true" | "false") => {
                self.literal(node)?
            }
            _ => return Err(self.misread(node)),
        };
        Ok((Expression { line: self.line(node), kind }, start))
    }

    fn field_access(&self, node: SyntaxNode<'_>) -> Result<PlacedExpression, SyntaxFault> {
        let object = self.field(node, "object")?;
        let (mut receiver, start) = self.placed(object)?;
        if let Some(above) = super_behind(node, object) {
            receiver = Expression { line: self.line(above), kind: super_of_named_class() };
        }
        let field = self.field(node, "field")?;
        let name = match field.kind() {
            "this" => "this".to_owned(),
            _ => self.name(field)?,
        };
        let kind = ExpressionKind::Field { object: Box::new(receiver), name };
        Ok((Expression { line: self.line(field), kind }, start))
    }

    fn qualified_name(&self, node: SyntaxNode<'_>) -> Result<PlacedExpression, SyntaxFault> {
        let [object, name] = named(node)[..] else { return Err(self.misread(node)) };
        let (object, start) = self.operand(object)?;
        let kind = ExpressionKind::Field { object: Box::new(object), name: self.name(name)? };
        Ok((Expression { line: self.line(name), kind }, start))
    }

    fn call(&self, node: SyntaxNode<'_>) -> Result<PlacedExpression, SyntaxFault> {
        let written = self.field(node, "name")?;
        let (on, start) = match node.field("object") {
            Some(object) => {
                let (mut on, start) = self.placed(object)?;
                if let Some(above) = super_behind(node, object) {
                    let kind = ExpressionKind::SuperOf(TypeName::new(self.source(object), 0));
                    on = Expression { line: self.line(above), kind };
                }
                (Some(Box::new(on)), start)
            }
            None => (None, written.start()),
        };
        let name = self.name(written)?;
        let arguments = self.expressions(&named(self.field(node, "arguments")?))?;
        let kind = ExpressionKind::Call { on, name, arguments };
        Ok((Expression { line: self.line(written), kind }, start))
    }

    fn new_array(&self, node: SyntaxNode<'_>) -> Result<ExpressionKind, SyntaxFault> {
        let element = self.type_name(self.field(node, "type")?)?;
        let mut dimensions = element.dimensions;
        let mut lengths = Vec::new();
        for part in node.fields("dimensions") {
            dimensions += brackets(part);
            if part.kind() == "dimensions_expr" {
                let length = named(part).into_iter().find(|node| !is_annotation(*node));
                lengths.push(self.expression(length.ok_or_else(|| self.misread(part))?)?);
            }
        }
        let values = node.field("value");
        Ok(ExpressionKind::NewArray {
            type_name: element.with_dimensions(dimensions),
            lengths,
            values: values.map(|values| self.expressions(&named(values))).transpose()?,
        })
    }

    fn new_object(&self, node: SyntaxNode<'_>) -> Result<ExpressionKind, SyntaxFault> {
        if children(node).first().is_none_or(|first| first.kind() != "new") {
            return Ok(unsupported("an object that is made within another (`outer.new Inner()`)"));
        }
        let written = self.field(node, "type")?;
        let type_name = self.type_name(written)?;
        let arguments = self.expressions(&named(self.field(node, "arguments")?))?;
        let body = child_of_kind(node, "class_body");
        let body =
            body.map(|body| self.unnamed_class(written, type_name.clone(), body)).transpose()?;
        Ok(ExpressionKind::New { type_name, arguments, body })
    }
}

pub(super) fn unsupported(construct: &str) -> ExpressionKind {
    ExpressionKind::Unsupported(construct.to_owned())
}

fn super_of_named_class() -> ExpressionKind {
    unsupported("`super` of a class that is named before it")
}

/// Returns the `super` between the qualifier and the member: `Outer.super.run()`.
fn super_behind<'n>(node: SyntaxNode<'n>, object: SyntaxNode<'_>) -> Option<SyntaxNode<'n>> {
    child_of_kind(node, "super").filter(|above| !above.is_same(object))
}
