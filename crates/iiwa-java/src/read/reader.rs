//! From the parser's tree to ours: what all kinds of nodes need.
//!
//! The parser lets pass some things that are not Java, and drops others that are. Whatever it could have changed is
//! held against the tokens of the file.

use java_lang::{Ident, Span, ast};

use super::{
    fault::Fault,
    lines::Lines,
    mend::Mended,
    tokens::{Kind, Tokens},
};
use crate::syntax::TypeName;

/// Reads the parser's tree of one file.
pub(super) struct Reader<'t> {
    pub(super) text: &'t str,
    pub(super) tokens: &'t Tokens<'t>,
    pub(super) mended: &'t Mended,
    pub(super) lines: &'t Lines<'t>,
}

impl Reader<'_> {
    /// Where a span begins in the file.
    pub(super) fn start(&self, span: Span) -> usize {
        self.mended.original(span.start())
    }

    pub(super) fn line(&self, span: Span) -> u32 {
        self.lines.line(self.start(span))
    }

    /// What the file has at a span.
    pub(super) fn source(&self, span: Span) -> &str {
        self.text.get(self.start(span)..self.mended.original(span.end())).unwrap_or("")
    }

    /// The number of the token that begins at a span.
    pub(super) fn token(&self, span: Span) -> usize {
        self.tokens.from(self.start(span))
    }

    /// The number of the first token behind a span.
    pub(super) fn token_behind(&self, span: Span) -> usize {
        self.tokens.from(self.mended.original(span.end()))
    }

    /// A name; the parser takes other tokens for names, too.
    pub(super) fn name(&self, ident: &Ident) -> Result<String, Fault> {
        let index = self.token(ident.span());
        let found = self.tokens.text(index);
        let is_name = self.tokens.kind(index) == Some(Kind::Word) && !is_reserved(found);
        if is_name && found == ident.name() {
            return Ok(found.to_owned());
        }
        Err(Fault::syntax(self.start(ident.span()), format!("a name is expected, not `{found}`")))
    }

    pub(super) fn type_name(&self, written: &ast::Type) -> Result<TypeName, Fault> {
        let (name, dimensions) = match written {
            ast::Type::Primitive(primitive) => (primitive.kind.as_str().to_owned(), 0),
            ast::Type::Void(_) => ("void".to_owned(), 0),
            ast::Type::Reference(ast::ReferenceType::ClassOrInterfaceType(class)) => {
                (self.path(&class.path)?, 0)
            }
            ast::Type::Reference(ast::ReferenceType::TypeVar(name)) => (self.name(name)?, 0),
            ast::Type::Reference(ast::ReferenceType::Array(array)) => {
                let TypeName { name, dimensions } = self.type_name(&array.elem_type)?;
                (name, dimensions + array.dims.len())
            }
        };
        Ok(TypeName { name, dimensions })
    }

    pub(super) fn type_names(&self, written: &[ast::Type]) -> Result<Vec<TypeName>, Fault> {
        written.iter().map(|written| self.type_name(written)).collect()
    }

    /// Names with dots between them, without type arguments.
    pub(super) fn path(&self, path: &ast::Path) -> Result<String, Fault> {
        let names: Result<Vec<String>, Fault> =
            path.segments.iter().map(|segment| self.name(&segment.ident)).collect();
        Ok(names?.join("."))
    }
}

/// The words of Java that are no names; those that only some places reserve are names elsewhere.
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
