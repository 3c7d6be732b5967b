//! The parser: `tree-sitter` with its Java grammar.
//!
//! The grammar accepts slightly more than Java, which [`TreeReader`](super::reader::TreeReader)
//! refuses. After a syntax error the parser continues with guesses; a file with an error is
//! therefore parsed again up to the first token without a valid interpretation, and the error lists
//! the tokens that would be accepted there.

use std::{
    collections::HashSet,
    ops::ControlFlow,
    sync::{Arc, Mutex},
};

use tree_sitter::{Language, LogType, ParseOptions, ParseState, Parser, Tree};

use super::{
    bounds::{self, MAX_CALLS_PER_TOKEN, MAX_TOKENS_BEFORE_SEARCH},
    fault::SyntaxFault,
    lines::LineStarts,
    tokens::Tokens,
};
use crate::source_error::SourceFault;

/// Parses a file without syntax errors.
pub(super) fn parse(
    text: &str,
    tokens: &Tokens<'_>,
    lines: &LineStarts<'_>,
) -> Result<Tree, SyntaxFault> {
    let mut parser = Parser::new();
    let language = Language::new(tree_sitter_java::LANGUAGE);
    parser.set_language(&language).map_err(|error| no_result(&error.to_string()))?;
    let max_calls = 1000 + tokens.list.len() * MAX_CALLS_PER_TOKEN;
    match bounded(&mut parser, text, max_calls, || false) {
        Some(tree) if !tree.root_node().has_error() => Ok(tree),
        _ => Err(first_error(&mut parser, &language, text, tokens, lines, max_calls)),
    }
}

/// Returns the tree, unless the parser exceeds its number of steps, or is stopped.
fn bounded(
    parser: &mut Parser,
    text: &str,
    max_calls: usize,
    is_at_end: impl Fn() -> bool,
) -> Option<Tree> {
    let mut calls = 0;
    let mut progress = |_: &ParseState| {
        calls += 1;
        if calls > max_calls || is_at_end() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let options = ParseOptions::new().progress_callback(&mut progress);
    let mut input = |offset: usize, _| text.as_bytes().get(offset..).unwrap_or_default();
    parser.reset();
    parser.parse_with_options(&mut input, None, Some(options))
}

/// Parser state after the last token before an error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Stuck {
    row: usize,
    column: usize,
    state: u16,
}

/// Interpretations of a file that the parser has abandoned.
#[derive(Debug, Default)]
struct Log {
    current: Stuck,
    stuck: Vec<Stuck>,
    /// `true` if no interpretation is left: from here on the parser guesses.
    is_at_end: bool,
}

impl Log {
    fn add(&mut self, message: &str) {
        if self.is_at_end {
            return;
        }
        if message.starts_with("process ") {
            self.current = Stuck {
                row: number(message, "row:"),
                column: number(message, "col:"),
                state: u16::try_from(number(message, "state:")).unwrap_or_default(),
            };
        } else if message.starts_with("detect_error ") {
            self.stuck.push(self.current);
        } else if message.starts_with("resume ") {
            self.is_at_end = true;
        }
    }
}

/// Returns the parser's log of a text up to its first error; `None` without an error.
fn first_stuck(parser: &mut Parser, text: &str, max_calls: usize) -> Option<Vec<Stuck>> {
    let log = Arc::new(Mutex::new(Log::default()));
    let written = Arc::clone(&log);
    parser.set_logger(Some(Box::new(move |kind, message| {
        if let (LogType::Parse, Ok(mut log)) = (kind, written.lock()) {
            log.add(message);
        }
    })));
    bounded(parser, text, max_calls, || log.lock().is_ok_and(|log| log.is_at_end));
    parser.set_logger(None);
    let mut log = log.lock().ok()?;
    log.is_at_end.then(|| std::mem::take(&mut log.stuck))
}

/// Returns the place at which the last interpretation was abandoned.
fn furthest(stuck: &[Stuck]) -> (usize, usize) {
    stuck.iter().map(|version| (version.row, version.column)).max().unwrap_or_default()
}

/// Describes the first error of a file in plain words.
fn first_error(
    parser: &mut Parser,
    language: &Language,
    text: &str,
    tokens: &Tokens<'_>,
    lines: &LineStarts<'_>,
    max_calls: usize,
) -> SyntaxFault {
    let Some(stuck) = first_stuck(parser, text, max_calls) else {
        return SyntaxFault {
            offset: 0,
            error: SourceFault::TooLong("the file takes the parser many steps"),
        };
    };
    let place = furthest(&stuck);
    // A superset of the accepted symbols: the parser shares one state between several places.
    let mut symbols = HashSet::new();
    for version in stuck.iter().filter(|version| (version.row, version.column) == place) {
        if let Some(mut names) = language.lookahead_iterator(version.state) {
            symbols.extend(names.iter_names().map(str::to_owned));
        }
    }
    let offset = lines.start(place.0) + place.1;
    let index = tokens.from(offset);
    let token = tokens.text(index);
    let mut accepts = |symbol: &str, written: &str| {
        // Each search parses the text again up to the error.
        if index > MAX_TOKENS_BEFORE_SEARCH || !symbols.contains(symbol) {
            return false;
        }
        let text = format!("{} {written}", text.get(..offset).unwrap_or_default());
        first_stuck(parser, &text, max_calls).is_none_or(|stuck| furthest(&stuck) > place)
    };
    let start = tokens.start(index);
    let found_words = match token {
        "" => "but the file ends".to_owned(),
        text => format!("not `{}`", shortened(text)),
    };
    let fault = |expected: &str| {
        SyntaxFault::syntax(start, format!("{expected} is expected, {found_words}"))
    };
    let is_outside = !bounds::is_within_brackets(tokens, index);
    if is_outside && accepts("class", "class") {
        return fault("a class");
    }
    if !is_outside && accepts("return", "return") {
        return fault("a statement");
    }
    if accepts("decimal_integer_literal", "1") {
        return fault("a value");
    }
    if let Some(closing) = bounds::expected_closing(tokens, index)
        && accepts(closing, closing)
    {
        return fault(&format!("`{closing}`"));
    }
    if accepts(";", ";") && !accepts("private", "private") {
        // Reported after the previous token, because the next one may be on another line.
        return SyntaxFault::syntax(tokens.end_before(index), "`;` is expected");
    }
    if accepts("private", "private") {
        return fault("a method or a field");
    }
    if accepts("int", "int") {
        return fault("a type");
    }
    if accepts("identifier", "x") {
        return fault("a name");
    }
    let others =
        ["(", "{", ")", "]", ">", "case", "default", "catch", "finally", "while", "class", "}"];
    let others: Vec<_> = others.into_iter().filter(|kind| accepts(kind, kind)).collect();
    match others.split_last() {
        None if token.is_empty() => SyntaxFault::syntax(start, "the file ends too early"),
        None => SyntaxFault::syntax(start, format!("`{}` is not expected here", shortened(token))),
        Some((last, [])) => fault(&format!("`{last}`")),
        Some((last, others)) => fault(&format!("`{}` or `{last}`", others.join("`, `"))),
    }
}

fn number(message: &str, name: &str) -> usize {
    let digits = message.split_once(name).map_or("", |(_, digits)| digits);
    let end = digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len());
    digits[..end].parse().unwrap_or(0)
}

/// Shortens texts and names, which may be long.
fn shortened(text: &str) -> String {
    const MAX_CHARACTERS: usize = 40;
    match text.char_indices().nth(MAX_CHARACTERS) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

fn no_result(why: &str) -> SyntaxFault {
    SyntaxFault { offset: 0, error: SourceFault::Parser(why.to_owned()) }
}
