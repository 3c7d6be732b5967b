//! Conversion of the parser's tree: common parts of all node kinds.

use super::{fault::SyntaxFault, lines::LineStarts, tree::SyntaxNode};
use crate::syntax::{TypeName, TypeParameter};

/// Reader for the parser's tree of one file.
pub(super) struct TreeReader<'t> {
    pub(super) text: &'t str,
    pub(super) lines: &'t LineStarts<'t>,
}

impl<'t> TreeReader<'t> {
    pub(super) fn line(&self, node: SyntaxNode<'_>) -> u32 {
        self.lines.line(node.start())
    }

    /// Returns the source text of a node.
    pub(super) fn source(&self, node: SyntaxNode<'_>) -> &'t str {
        self.text.get(node.bytes()).unwrap_or("")
    }

    /// Reads a name; the parser accepts keywords as names where it does not expect keywords.
    pub(super) fn name(&self, node: SyntaxNode<'_>) -> Result<String, SyntaxFault> {
        let source = self.source(node);
        let is_name =
            matches!(node.kind(), "identifier" | "type_identifier" | "underscore_pattern");
        if is_name && !is_reserved(source) {
            return Ok(source.to_owned());
        }
        Err(SyntaxFault::syntax(node.start(), format!("a name is expected, not `{source}`")))
    }

    /// Returns the child in a grammar field.
    pub(super) fn field<'n>(
        &self,
        node: SyntaxNode<'n>,
        field: &str,
    ) -> Result<SyntaxNode<'n>, SyntaxFault> {
        node.field(field).ok_or_else(|| self.misread(node))
    }

    /// Returns the error for a grammar node that this reader does not know.
    pub(super) fn misread(&self, node: SyntaxNode<'_>) -> SyntaxFault {
        let begin = self.source(node).split_whitespace().next().unwrap_or("");
        SyntaxFault::syntax(node.start(), format!("`{begin}` is not expected here"))
    }

    pub(super) fn type_name(&self, node: SyntaxNode<'_>) -> Result<TypeName, SyntaxFault> {
        match node.kind() {
            "integral_type" | "floating_point_type" | "boolean_type" | "void_type" => {
                Ok(TypeName::new(self.source(node), 0))
            }
            "array_type" => {
                let element = self.type_name(self.field(node, "element")?)?;
                let more = brackets(self.field(node, "dimensions")?);
                Ok(element.with_dimensions(element.dimensions + more))
            }
            "annotated_type" => {
                let inner = named(node).pop().ok_or_else(|| self.misread(node))?;
                self.type_name(inner)
            }
            _ => {
                let name = self.path(node)?;
                Ok(TypeName { name, dimensions: 0, arguments: self.type_arguments(node)? })
            }
        }
    }

    /// Reads the type arguments of a generic type.
    fn type_arguments(&self, node: SyntaxNode<'_>) -> Result<Vec<TypeName>, SyntaxFault> {
        let Some(list) = child_of_kind(node, "type_arguments") else { return Ok(Vec::new()) };
        let arguments: Result<Vec<_>, _> = named(list)
            .into_iter()
            .map(|node| match node.kind() {
                "wildcard" => self.wildcard(node),
                _ => self.type_name(node),
            })
            .collect();
        let arguments = arguments?;
        // The diamond of `new ArrayList<>()`.
        Ok(if arguments.is_empty() { vec![TypeName::new("", 0)] } else { arguments })
    }

    /// Reads a wildcard as its upper bound.
    fn wildcard(&self, node: SyntaxNode<'_>) -> Result<TypeName, SyntaxFault> {
        let bound = named(node).into_iter().rfind(|node| !is_annotation(*node));
        match bound.filter(|_| child_of_kind(node, "super").is_none()) {
            Some(bound) => self.type_name(bound),
            None => Ok(TypeName::new("Object", 0)),
        }
    }

    /// Reads the type variables that a class or a method declares.
    pub(super) fn type_parameters(
        &self,
        node: SyntaxNode<'_>,
    ) -> Result<Vec<TypeParameter>, SyntaxFault> {
        let Some(list) = child_of_kind(node, "type_parameters") else { return Ok(Vec::new()) };
        let parameters = named(list).into_iter().filter(|node| node.kind() == "type_parameter");
        let read = parameters.map(|parameter| {
            let name = child_of_kind(parameter, "type_identifier")
                .or_else(|| child_of_kind(parameter, "identifier"))
                .ok_or_else(|| self.misread(parameter))?;
            let bounds = child_of_kind(parameter, "type_bound");
            let bound = bounds.and_then(|bounds| named(bounds).into_iter().next());
            let bound = bound.map(|bound| self.type_name(bound)).transpose()?;
            Ok(TypeParameter { name: self.name(name)?, bound })
        });
        read.collect()
    }

    /// Reads a dotted name, without type arguments.
    pub(super) fn path(&self, node: SyntaxNode<'_>) -> Result<String, SyntaxFault> {
        match node.kind() {
            "scoped_identifier" | "scoped_type_identifier" | "generic_type" => {
                let is_name = |child: &SyntaxNode<'_>| {
                    !is_annotation(*child) && child.kind() != "type_arguments"
                };
                let names = named(node).into_iter().filter(is_name);
                let names: Result<Vec<String>, SyntaxFault> =
                    names.map(|name| self.path(name)).collect();
                Ok(names?.join("."))
            }
            _ => self.name(node),
        }
    }

    pub(super) fn type_names(
        &self,
        nodes: &[SyntaxNode<'_>],
    ) -> Result<Vec<TypeName>, SyntaxFault> {
        nodes.iter().map(|node| self.type_name(*node)).collect()
    }
}

/// Returns all children.
pub(super) fn children(node: SyntaxNode<'_>) -> Vec<SyntaxNode<'_>> {
    node.children().collect()
}

/// Returns the children other than symbols and keywords.
pub(super) fn named(node: SyntaxNode<'_>) -> Vec<SyntaxNode<'_>> {
    node.children().filter(|child| child.is_named()).collect()
}

/// Returns the first child of a kind.
pub(super) fn child_of_kind<'n>(node: SyntaxNode<'n>, kind: &str) -> Option<SyntaxNode<'n>> {
    node.children().find(|child| child.kind() == kind)
}

/// Returns the number of dimensions written as `[]`.
pub(super) fn brackets(node: SyntaxNode<'_>) -> usize {
    node.children().filter(|child| child.kind() == "[").count()
}

pub(super) fn is_annotation(node: SyntaxNode<'_>) -> bool {
    matches!(node.kind(), "annotation" | "marker_annotation")
}

/// Returns true for reserved words; contextual keywords are valid names.
fn is_reserved(word: &str) -> bool {
    matches!(
        word,
        "abstract"
            | "assert"
            | "boolean"
            | "break"
            | "byte"
            | "case"
            | "catch"
            | "char"
            | "class"
            | "const"
            | "continue"
            | "default"
            | "do"
            | "double"
            | "else"
            | "enum"
            | "extends"
            | "final"
            | "finally"
            | "float"
            | "for"
            | "goto"
            | "if"
            | "implements"
            | "import"
            | "instanceof"
            | "int"
            | "interface"
            | "long"
            | "native"
            | "new"
            | "package"
            | "private"
            | "protected"
            | "public"
            | "return"
            | "short"
            | "static"
            | "strictfp"
            | "super"
            | "switch"
            | "synchronized"
            | "this"
            | "throw"
            | "throws"
            | "transient"
            | "try"
            | "void"
            | "volatile"
            | "while"
            | "true"
            | "false"
            | "null"
    )
}
