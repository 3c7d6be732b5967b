//! Parses the text of a source file.
//!
//! Only this module depends on the parser, `tree-sitter` with its Java grammar. Before it runs,
//! tokens are counted, and brackets are matched; its tree is checked against [bounds]; and
//! [operands] reassembles operator expressions, because the grammar does not rank all operators as
//! Java does.

mod bounds;
mod declarations;
mod expressions;
mod fault;
mod functions;
mod lines;
mod literals;
mod operands;
mod parser;
mod reader;
mod statements;
#[cfg(test)]
#[path = "../tests/unit/read.rs"]
mod tests;
mod tokens;
mod tree;

use std::thread;

pub(crate) use self::functions::completes;
use self::{
    fault::SyntaxFault, lines::LineStarts, reader::TreeReader, tokens::Tokens, tree::SyntaxNodes,
};
use crate::{
    source_error::{SourceError, SourceFault},
    syntax::CompilationUnit,
};

/// Stack size in bytes of the reader thread; only used pages take memory. The deepest accepted tree
/// needs a third of it without optimisation.
const STACK_BYTES: usize = 64 << 20;

/// Reads a source file of this name.
///
/// # Errors
///
/// If the text is not Java, or exceeds a bound, with the place.
pub fn read(file: &str, text: &str) -> Result<CompilationUnit, SourceError> {
    let result = thread::scope(|scope| {
        let reader = thread::Builder::new().stack_size(STACK_BYTES);
        match reader.spawn_scoped(scope, || unit(text)) {
            Ok(thread) => thread.join().unwrap_or_else(|_| Err(no_result("it failed"))),
            Err(error) => Err(no_result(&error.to_string())),
        }
    });
    result.map_err(|SyntaxFault { offset, error }| {
        let lines = LineStarts::new(text);
        let (line, column) = (lines.line(offset), lines.column(offset));
        SourceError { file: file.to_owned(), line, column, fault: error }
    })
}

fn unit(text: &str) -> Result<CompilationUnit, SyntaxFault> {
    if let Some(offset) = text.find('\0') {
        return Err(SyntaxFault { offset, error: SourceFault::Binary });
    }
    let tokens = Tokens::scan(text)?;
    bounds::check_brackets(&tokens)?;
    // Ctrl-Z, which old editors append as the end of a file.
    let text = text.strip_suffix('\u{1a}').unwrap_or(text);
    let lines = LineStarts::new(text);
    let tree = parser::parse(text, &tokens, &lines)?;
    let nodes = SyntaxNodes::of(&tree)?;
    TreeReader { text, lines: &lines }.unit(nodes.root())
}

fn no_result(why: &str) -> SyntaxFault {
    SyntaxFault { offset: 0, error: SourceFault::Parser(why.to_owned()) }
}
