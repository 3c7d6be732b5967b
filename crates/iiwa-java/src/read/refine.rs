//! Where a syntax error is, in plain words.
//!
//! The parser tries several readings of a statement, and names the place where the last of them fails: the name of a
//! variable whose value is wrong, the `class` of a class with an error deep inside. So what it tried first is parsed
//! once more, alone.

use java_lang::{CompilationUnit, Error, parse_str};

use super::{fault::Fault, reader::Reader, tokens::Kind};

/// Each attempt finds an error behind the one before; this many are nested within one another at most.
const MOST_ATTEMPTS: usize = 50;

const IN_CLASS: &str = "class A{";
const IN_METHOD: &str = "class A{void a(){";
const AS_VALUE: &str = "class A{Object a=";

impl Reader<'_> {
    /// What the parser's error means.
    pub(super) fn parser_fault(&self, error: &Error) -> Fault {
        let mut at = self.start(error.span());
        let mut message = error.message().to_owned();
        if let Some(block) = self.fault_in_finally(at) {
            (at, message) = block;
        }
        for _ in 0..MOST_ATTEMPTS {
            match self.fault_behind(at, &message) {
                Some(deeper) if deeper.0 > at => (at, message) = deeper,
                _ => break,
            }
        }
        self.said(at, &message)
    }

    /// What is wrong with a value that the parser could not read, by the number of its first token.
    pub(super) fn fault_of_value(&self, first: usize) -> Fault {
        match self.attempt_at(AS_VALUE, self.tokens.start(first)) {
            Some((at, message)) => self.said(at, &message),
            None => Fault::syntax(self.tokens.start(first), "a value is expected"),
        }
    }

    /// The error in what the parser may have tried to read, and given up, at a place where it then found an error.
    fn fault_behind(&self, at: usize, message: &str) -> Option<(usize, String)> {
        let index = self.tokens.from(at);
        if message == "invalid assignment target" {
            // `List<A> a = ...` is a comparison, if it is no declaration.
            let mut behind = index..self.tokens.list.len();
            let ends = [";", "{", "}", "="];
            let equals = behind.find(|index| ends.contains(&self.tokens.text(*index)))?;
            let is_value = self.tokens.text(equals) == "=";
            return is_value.then(|| self.attempt_at(AS_VALUE, self.tokens.start(equals + 1)))?;
        }
        let next = self.tokens.text(index + 1);
        let is_declared = match self.tokens.kind_before(index) {
            Some(Kind::Word) => true,
            _ => matches!(self.tokens.text_before(index), ">" | ">>" | ">>>" | "]"),
        };
        let is_name = self.tokens.kind(index) == Some(Kind::Word) && is_declared;
        if is_name && next == "=" {
            return self.attempt_at(AS_VALUE, self.tokens.start(index + 2));
        }
        if is_name && next == ":" {
            let value = self.attempt_at(AS_VALUE, self.tokens.start(index + 2));
            // The value alone is followed by the `)` of the loop, which no value has.
            let end = self.closing(index)?;
            return match value {
                Some((at, message)) if at < self.tokens.start(end) || message != "expected ;" => {
                    Some((at, message))
                }
                _ => self.attempt_at(IN_METHOD, self.tokens.start(end + 1)),
            };
        }
        let begins_class = ["class", "interface", "enum", "abstract", "final", "static"];
        if begins_class.contains(&self.tokens.text(index)) {
            return self.attempt_at(IN_CLASS, self.tokens.start(index));
        }
        None
    }

    /// An error within a block behind `finally`: the parser loses count of braces there, and fails elsewhere.
    fn fault_in_finally(&self, at: usize) -> Option<(usize, String)> {
        let behind = self.tokens.from(at);
        let blocks = (0..behind).rev().filter(|index| {
            self.tokens.text(*index) == "finally" && self.tokens.text(index + 1) == "{"
        });
        for index in blocks.take(MOST_ATTEMPTS) {
            let end = self.tokens.start(self.closing(index + 1)?);
            let from = self.tokens.start(index + 1);
            if let Some(found) = self.attempt_at(IN_METHOD, from)
                && found.0 < end
            {
                return Some(found);
            }
        }
        None
    }

    /// The bracket that closes the level of a token; that opens it, of one that opens a level.
    fn closing(&self, index: usize) -> Option<usize> {
        let mut open = 0_usize;
        let first = index + usize::from(self.tokens.kind(index) == Some(Kind::Open));
        for index in first..self.tokens.list.len() {
            match self.tokens.kind(index) {
                Some(Kind::Open) => open += 1,
                Some(Kind::Close) if open == 0 => return Some(index),
                Some(Kind::Close) => open -= 1,
                _ => {}
            }
        }
        None
    }

    /// The first error from a byte of the file on, where something else is before it.
    fn attempt_at(&self, before: &str, from: usize) -> Option<(usize, String)> {
        let from = self.mended.mended(from);
        let text = format!("{before}{}", self.mended.text.get(from..)?);
        let error = parse_str::<CompilationUnit>(&text).err()?;
        let at = (error.span().start() + from).checked_sub(before.len())?;
        Some((self.mended.original(at), error.message().to_owned()))
    }

    /// An error in our words.
    fn said(&self, at: usize, message: &str) -> Fault {
        let index = self.tokens.from(at);
        let found = match self.tokens.text(index) {
            "" => "but the file ends".to_owned(),
            found => format!("not `{}`", shortened(found)),
        };
        let Some(expected) = message.strip_prefix("expected ") else {
            return Fault::syntax(at, format!("this is no Java: {message}"));
        };
        match expected {
            // At its own place: what comes next may be on another line.
            ";" => Fault::syntax(self.tokens.end_before(index), "`;` is expected"),
            "identifier" => Fault::syntax(at, format!("a name is expected, {found}")),
            "expression" => Fault::syntax(at, format!("a value is expected, {found}")),
            "type" | "type after new" => Fault::syntax(at, format!("a type is expected, {found}")),
            "method or field declaration" | "interface member" => {
                Fault::syntax(at, format!("a method or a field is expected, {found}"))
            }
            _ if expected.starts_with("type declaration") => {
                Fault::syntax(at, format!("a class is expected, {found}"))
            }
            _ if expected.contains(' ') => {
                Fault::syntax(at, format!("a {expected} is expected, {found}"))
            }
            _ => Fault::syntax(at, format!("`{expected}` is expected, {found}")),
        }
    }
}

/// Texts and names may be long.
fn shortened(found: &str) -> String {
    const MOST: usize = 40;
    match found.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}...", &found[..end]),
        None => found.to_owned(),
    }
}
