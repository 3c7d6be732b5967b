//! Tokens of a file, for the bounds and for syntax error messages.

use super::fault::SyntaxFault;
use crate::source_error::SourceFault;

/// Maximum number of tokens; robot programs have a hundred times fewer.
pub(super) const MAX_TOKENS: usize = 500_000;

/// Symbols of more than one character, the longest first.
const LONG_SYMBOLS: [&str; 25] = [
    ">>>=", ">>>", ">>=", "<<=", "...", "<<", ">>", "<=", ">=", "==", "!=", "&&", "||", "++", "--",
    "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "->", "::",
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TokenKind {
    /// Name or keyword.
    Word,
    Number,
    Text,
    Char,
    Open,
    Close,
    Symbol,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Token {
    pub(super) start: usize,
    pub(super) end: usize,
    pub(super) kind: TokenKind,
}

/// Tokens of a text, in order.
pub(super) struct Tokens<'t> {
    text: &'t str,
    pub(super) list: Vec<Token>,
}

impl<'t> Tokens<'t> {
    /// Scans a text.
    ///
    /// # Errors
    ///
    /// If a string or a comment is not terminated, if a character is not valid in Java, or if the
    /// text has too many tokens.
    pub(super) fn scan(text: &'t str) -> Result<Self, SyntaxFault> {
        let mut tokens = Self { text, list: Vec::new() };
        let mut offset = 0;
        let mut comments = 0;
        while let Some(first) = text[offset..].chars().next() {
            let rest = &text[offset..];
            // Ctrl-Z marks the end of a file in old editors.
            let is_end_mark = first == '\u{1a}' && rest.len() == 1;
            if first.is_whitespace() {
                offset += first.len_utf8();
            } else if rest.starts_with("//") || rest.starts_with("/*") || is_end_mark {
                offset += if is_end_mark { 1 } else { comment(rest, offset)? };
                comments += 1;
            } else {
                let (kind, length) = token(rest, first, offset)?;
                tokens.list.push(Token { start: offset, end: offset + length, kind });
                offset += length;
            }
            if tokens.list.len() + comments > MAX_TOKENS {
                return Err(SyntaxFault {
                    offset,
                    error: SourceFault::TooManyTokens { max_tokens: MAX_TOKENS },
                });
            }
        }
        Ok(tokens)
    }

    /// Returns the text of a token; empty after the last one.
    pub(super) fn text(&self, index: usize) -> &'t str {
        self.list.get(index).map_or("", |token| &self.text[token.start..token.end])
    }

    pub(super) fn kind(&self, index: usize) -> Option<TokenKind> {
        self.list.get(index).map(|token| token.kind)
    }

    /// Returns the index of the first token that begins at or after this byte offset.
    pub(super) fn from(&self, offset: usize) -> usize {
        self.list.partition_point(|token| token.start < offset)
    }

    /// Returns the start of a token; after the last one, the end of the text.
    pub(super) fn start(&self, index: usize) -> usize {
        self.list.get(index).map_or(self.text.len(), |token| token.start)
    }

    /// Returns the line of a token, from 1.
    pub(super) fn line(&self, index: usize) -> usize {
        self.text[..self.start(index)].matches('\n').count() + 1
    }

    /// Returns the end of the previous token.
    pub(super) fn end_before(&self, index: usize) -> usize {
        index.checked_sub(1).and_then(|index| self.list.get(index)).map_or(0, |token| token.end)
    }
}

fn comment(rest: &str, offset: usize) -> Result<usize, SyntaxFault> {
    if rest.starts_with("//") {
        return Ok(rest.find('\n').unwrap_or(rest.len()));
    }
    let end = rest[2..].find("*/").ok_or_else(|| {
        SyntaxFault::syntax(offset, "this comment does not end: `*/` is expected after it")
    })?;
    Ok(end + 4)
}

fn token(rest: &str, first: char, offset: usize) -> Result<(TokenKind, usize), SyntaxFault> {
    let second = rest[first.len_utf8()..].chars().next();
    Ok(match first {
        '"' if rest.starts_with("\"\"\"") => (TokenKind::Text, block(rest, offset)?),
        '"' | '\'' => {
            let kind = if first == '"' { TokenKind::Text } else { TokenKind::Char };
            (kind, quoted(rest, first, offset)?)
        }
        '(' | '[' | '{' => (TokenKind::Open, 1),
        ')' | ']' | '}' => (TokenKind::Close, 1),
        _ if first.is_ascii_digit() => (TokenKind::Number, number(rest)),
        '.' if second.is_some_and(|second| second.is_ascii_digit()) => {
            (TokenKind::Number, number(rest))
        }
        _ if begins_word(first) => {
            let end = rest.find(|c: char| !(begins_word(c) || c.is_numeric()));
            (TokenKind::Word, end.unwrap_or(rest.len()))
        }
        _ if "+-*/%&|^!~<>=?:;,.@".contains(first) => {
            let long = LONG_SYMBOLS.iter().find(|symbol| rest.starts_with(**symbol));
            (TokenKind::Symbol, long.map_or(1, |symbol| symbol.len()))
        }
        '\\' => {
            let message = "`\\` has a meaning within texts only; write the character that is meant";
            return Err(SyntaxFault::syntax(offset, message));
        }
        _ => {
            let message = format!("`{}` has no meaning in Java", first.escape_debug());
            return Err(SyntaxFault::syntax(offset, message));
        }
    })
}

fn begins_word(character: char) -> bool {
    character.is_alphabetic() || character == '_' || character == '$'
}

/// Returns the length of a string or character literal, with its quotes.
fn quoted(rest: &str, quote: char, offset: usize) -> Result<usize, SyntaxFault> {
    let mut characters = rest.char_indices().skip(1);
    while let Some((offset, character)) = characters.next() {
        match character {
            '\n' | '\r' => break,
            // An escaped character ends neither the literal nor, as an escaped quote, the line.
            '\\' if characters.next().is_none_or(|(_, escaped)| escaped == '\n') => break,
            _ if character == quote => return Ok(offset + 1),
            _ => {}
        }
    }
    let message = format!("this text does not end on its line: `{quote}` is expected");
    Err(SyntaxFault::syntax(offset, message))
}

/// Returns the length of a text block, with its quotes.
fn block(rest: &str, offset: usize) -> Result<usize, SyntaxFault> {
    let mut from = 3;
    while let Some(length) = rest[from..].find(['"', '\\']) {
        let quote = from + length;
        if rest[quote..].starts_with("\"\"\"") {
            return Ok(quote + 3);
        }
        let escaped = rest[quote..].starts_with('\\');
        from = quote + 1;
        if escaped {
            from += rest[from..].chars().next().map_or(0, char::len_utf8);
        }
    }
    Err(SyntaxFault::syntax(offset, "this text block does not end: `\"\"\"` is expected after it"))
}

fn number(rest: &str) -> usize {
    let is_hexadecimal = rest.starts_with("0x") || rest.starts_with("0X");
    let mut before = ' ';
    let end = rest.find(|character: char| {
        let exponent = if is_hexadecimal { ['p', 'P'] } else { ['e', 'E'] };
        let is_sign = matches!(character, '+' | '-') && exponent.contains(&before);
        before = character;
        !(character.is_ascii_alphanumeric() || matches!(character, '_' | '.') || is_sign)
    });
    end.unwrap_or(rest.len())
}
