//! The parser's tree, copied once without its comments, because access to its own nodes through the
//! parser is slow.

use std::ops::Range;

use tree_sitter::Tree;

use super::{bounds::MAX_LEVELS, fault::SyntaxFault};

/// Nodes of a tree, each before its descendants.
pub(super) struct SyntaxNodes<'t>(Vec<SyntaxEntry<'t>>);

struct SyntaxEntry<'t> {
    kind: &'t str,
    /// Grammar field of the node in its parent.
    field: Option<&'t str>,
    bytes: Range<usize>,
    is_named: bool,
    /// Index of the first node after this one that is not a descendant.
    after: usize,
}

/// Node of a tree.
#[derive(Clone, Copy)]
pub(super) struct SyntaxNode<'n> {
    nodes: &'n SyntaxNodes<'n>,
    number: usize,
}

impl<'t> SyntaxNodes<'t> {
    /// Copies a tree.
    ///
    /// # Errors
    ///
    /// If the tree is too deep for code that recurses into its levels.
    pub(super) fn of(tree: &'t Tree) -> Result<Self, SyntaxFault> {
        let mut nodes = Vec::with_capacity(tree.root_node().descendant_count());
        let mut around = Vec::new();
        let mut cursor = tree.walk();
        loop {
            let node = cursor.node();
            if !node.is_extra() {
                let number = nodes.len();
                nodes.push(SyntaxEntry {
                    kind: node.kind(),
                    field: cursor.field_name(),
                    bytes: node.byte_range(),
                    is_named: node.is_named(),
                    after: number + 1,
                });
                if cursor.goto_first_child() {
                    if around.len() == MAX_LEVELS {
                        let offset = cursor.node().start_byte();
                        let message = "too many expressions and statements are within one another";
                        return Err(SyntaxFault::too_deep(offset, message, MAX_LEVELS));
                    }
                    around.push(number);
                    continue;
                }
            }
            while !cursor.goto_next_sibling() {
                if !cursor.goto_parent() {
                    return Ok(Self(nodes));
                }
                let after = nodes.len();
                if let Some(entry) = around.pop().and_then(|number| nodes.get_mut(number)) {
                    entry.after = after;
                }
            }
        }
    }

    /// Returns the root node.
    pub(super) fn root(&self) -> SyntaxNode<'_> {
        SyntaxNode { nodes: self, number: 0 }
    }
}

impl<'n> SyntaxNode<'n> {
    fn entry(self) -> &'n SyntaxEntry<'n> {
        &self.nodes.0[self.number]
    }

    pub(super) fn kind(self) -> &'n str {
        self.entry().kind
    }

    /// Returns true if the node is more than a symbol or a keyword.
    pub(super) fn is_named(self) -> bool {
        self.entry().is_named
    }

    pub(super) fn bytes(self) -> Range<usize> {
        self.entry().bytes.clone()
    }

    pub(super) fn start(self) -> usize {
        self.entry().bytes.start
    }

    pub(super) fn is_same(self, other: SyntaxNode<'_>) -> bool {
        std::ptr::eq(self.nodes, other.nodes) && self.number == other.number
    }

    pub(super) fn children(self) -> impl Iterator<Item = Self> {
        let end = self.entry().after;
        let mut next = self.number + 1;
        std::iter::from_fn(move || {
            let child = Self { nodes: self.nodes, number: next };
            (next < end).then(|| {
                next = child.entry().after;
                child
            })
        })
    }

    /// Returns the children in a grammar field.
    pub(super) fn fields(self, name: &str) -> impl Iterator<Item = Self> {
        self.children().filter(move |child| child.entry().field == Some(name))
    }

    pub(super) fn field(self, name: &str) -> Option<Self> {
        self.fields(name).next()
    }
}
