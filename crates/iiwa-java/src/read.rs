//! From the text of a source file to its syntax.
//!
//! This folder alone knows the parser, the crate `java-lang`. It is recursive, forgiving, and slow on some input, so that
//! a file is first held against [bounds], then [mended](mend) where the parser would misunderstand it; what comes out is
//! held against the tokens of the file.

mod bounds;
mod declarations;
mod expressions;
mod fault;
mod lines;
mod literals;
mod mend;
mod reader;
mod refine;
mod statements;
#[cfg(test)]
#[path = "../tests/unit/read.rs"]
mod tests;
mod tokens;

use std::thread;

use java_lang::{CompilationUnit, parse_str};

use self::{fault::Fault, lines::Lines, mend::Mended, reader::Reader, tokens::Tokens};
use crate::{
    source_error::{SourceError, SourceFault},
    syntax::Unit,
};

/// Of the stack that the parser has; it is reserved, and taken up as far as it is used. The bounds
/// let it use half without optimisation, most of all for lambda expressions within one another.
const STACK_BYTES: usize = 256 << 20;

/// Reads a source file of this name.
///
/// # Errors
///
/// If the text is not Java, or is beyond a bound, with the place.
pub fn read(file: &str, text: &str) -> Result<Unit, SourceError> {
    let result = thread::scope(|scope| {
        let parser = thread::Builder::new().stack_size(STACK_BYTES);
        match parser.spawn_scoped(scope, || unit(text)) {
            Ok(thread) => thread.join().unwrap_or_else(|_| Err(no_result("it failed"))),
            Err(error) => Err(no_result(&error.to_string())),
        }
    });
    result.map_err(|Fault { at, what }| {
        let lines = Lines::new(text);
        let (line, column) = (lines.line(at), lines.column(at));
        SourceError { file: file.to_owned(), line, column, fault: what }
    })
}

fn unit(text: &str) -> Result<Unit, Fault> {
    if let Some(at) = text.find('\0') {
        return Err(Fault { at, what: SourceFault::Binary });
    }
    let tokens = Tokens::scan(text)?;
    bounds::check(&tokens)?;
    let mended = Mended::new(text, &tokens);
    let lines = Lines::new(text);
    let reader = Reader { text, tokens: &tokens, mended: &mended, lines: &lines };
    match parse_str::<CompilationUnit>(&mended.text) {
        Ok(parsed) => reader.unit(&parsed),
        Err(error) => Err(reader.parser_fault(&error)),
    }
}

fn no_result(why: &str) -> Fault {
    Fault { at: 0, what: SourceFault::Parser(why.to_owned()) }
}
