//! Bounds for source files, which protect memory and the stack.
//!
//! The parser itself needs no stack for nesting. Its number of steps is bounded, and the depth of
//! its tree is bounded before [`TreeReader`](super::reader::TreeReader) and the evaluator recurse
//! into its levels.

use super::{
    fault::SyntaxFault,
    tokens::{TokenKind, Tokens},
};

/// Maximum depth of the tree. Each bracket, operator, statement and chained call is one or two
/// levels.
pub(super) const MAX_LEVELS: usize = 2000;

/// Maximum number of progress callbacks of the parser for each token; each callback is 100 steps.
/// Java sources need less than one.
pub(super) const MAX_CALLS_PER_TOKEN: usize = 10;

/// Maximum number of tokens before a syntax error whose message lists the tokens that would be
/// accepted there: up to twenty candidates are tried, each with all tokens before it.
pub(super) const MAX_TOKENS_BEFORE_SEARCH: usize = 20_000;

/// Checks that the brackets of a file match: the parser reports this error, too, but far after the
/// missing bracket.
pub(super) fn check_brackets(tokens: &Tokens<'_>) -> Result<(), SyntaxFault> {
    let mut open = Vec::new();
    for index in 0..tokens.list.len() {
        match tokens.kind(index) {
            Some(TokenKind::Open) => open.push(index),
            Some(TokenKind::Close) => {
                let text = tokens.text(index);
                let Some(opened) = open.pop() else {
                    let message = format!("unmatched `{text}`");
                    return Err(SyntaxFault::syntax(tokens.start(index), message));
                };
                let expected = closing(tokens.text(opened));
                if expected != text {
                    let (opened, line) = (tokens.text(opened), tokens.line(opened));
                    let message = format!(
                        "`{expected}` is expected, which closes the `{opened}` of line {line}, not \
                         `{text}`"
                    );
                    return Err(SyntaxFault::syntax(tokens.start(index), message));
                }
            }
            _ => {}
        }
    }
    match open.pop() {
        Some(index) => {
            let opened = tokens.text(index);
            let message =
                format!("this `{opened}` is not closed: `{}` is expected", closing(opened));
            Err(SyntaxFault::syntax(tokens.start(index), message))
        }
        None => Ok(()),
    }
}

/// Returns true if a bracket is open before a token.
pub(super) fn is_within_brackets(tokens: &Tokens<'_>, before: usize) -> bool {
    open_bracket(tokens, before).is_some()
}

/// Returns the closing bracket expected before a token; `None` within blocks and the heads of
/// `for`, where a `;` is more likely.
pub(super) fn expected_closing(tokens: &Tokens<'_>, before: usize) -> Option<&'static str> {
    let index = open_bracket(tokens, before)?;
    let is_before = |texts: &[&str]| {
        index.checked_sub(1).is_some_and(|before| texts.contains(&tokens.text(before)))
    };
    let ends = match tokens.text(index) {
        "(" => !is_before(&["for"]),
        "{" => is_before(&["=", "]", ",", "{", "("]),
        _ => true,
    };
    ends.then(|| closing(tokens.text(index)))
}

/// Returns the innermost bracket that is open before a token.
fn open_bracket(tokens: &Tokens<'_>, before: usize) -> Option<usize> {
    let mut open = Vec::new();
    for index in 0..before {
        match tokens.kind(index) {
            Some(TokenKind::Open) => open.push(index),
            Some(TokenKind::Close) => {
                open.pop();
            }
            _ => {}
        }
    }
    open.pop()
}

fn closing(open: &str) -> &'static str {
    match open {
        "(" => ")",
        "[" => "]",
        _ => "}",
    }
}
