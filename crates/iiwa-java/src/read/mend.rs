//! What the parser would read otherwise than Java does, written so that it cannot.
//!
//! - `(a) + b` would be a cast of `+b` to a type `a`; so it becomes `((a)) + b`.
//! - `+b` would be `b`; so it becomes `~b`, and its place is remembered.
//! - Comments slow the parser down; so they become blanks.

use super::tokens::{Kind, Tokens, begins_expression};

/// A text for the parser.
pub(super) struct Mended {
    pub(super) text: String,
    /// Where characters were put in, in order.
    inserted: Vec<usize>,
    /// The `+` that have no left side, in the file as it is, in order.
    pub(super) pluses: Vec<usize>,
}

impl Mended {
    pub(super) fn new(text: &str, tokens: &Tokens<'_>) -> Self {
        let mut edits: Vec<(usize, Edit)> = Vec::new();
        for comment in &tokens.comments {
            edits.push((comment.start, Edit::Blank(comment.end)));
        }
        let mut open: Vec<(usize, bool)> = Vec::new();
        let mut pluses = Vec::new();
        for (index, token) in tokens.list.iter().enumerate() {
            match (token.kind, tokens.text(index)) {
                (Kind::Open, _) => open.push((index, false)),
                (Kind::Close, text) => {
                    let Some((open, is_list)) = open.pop() else { continue };
                    if text == ")" && !is_list && is_operand(tokens, open, index) {
                        let opened = tokens.list.get(open).map_or(0, |token| token.end);
                        edits.push((opened, Edit::Insert('(')));
                        edits.push((token.start, Edit::Insert(')')));
                    }
                }
                (Kind::Symbol, "," | ";") => {
                    if let Some((_, is_list)) = open.last_mut() {
                        *is_list = true;
                    }
                }
                (Kind::Symbol, "+") if is_unary(tokens, index) => {
                    pluses.push(token.start);
                    edits.push((token.start, Edit::Complement));
                }
                _ => {}
            }
        }
        edits.sort_by_key(|(at, _)| *at);
        Self::edited(text, &edits, pluses)
    }

    fn edited(original: &str, edits: &[(usize, Edit)], pluses: Vec<usize>) -> Self {
        let mut text = String::with_capacity(original.len() + edits.len());
        let mut inserted = Vec::new();
        let mut from = 0;
        for (at, edit) in edits {
            text.push_str(&original[from..*at]);
            from = *at;
            match edit {
                Edit::Insert(character) => {
                    inserted.push(text.len());
                    text.push(*character);
                }
                Edit::Complement => {
                    text.push('~');
                    from = at + 1;
                }
                Edit::Blank(end) => {
                    let bytes = original[*at..*end].bytes();
                    text.extend(bytes.map(|byte| if byte == b'\n' { '\n' } else { ' ' }));
                    from = *end;
                }
            }
        }
        text.push_str(&original[from..]);
        Self { text, inserted, pluses }
    }

    /// Where a byte of this text is in the file as it is.
    pub(super) fn original(&self, at: usize) -> usize {
        at - self.inserted.partition_point(|inserted| *inserted < at)
    }

    /// The first byte of this text that stands for one of the file as it is.
    pub(super) fn mended(&self, original: usize) -> usize {
        // Each insertion moves what is behind it, and the next insertions are known in this text only.
        let mut at = original;
        for inserted in &self.inserted {
            if *inserted <= at {
                at += 1;
            } else {
                break;
            }
        }
        at
    }
}

enum Edit {
    Insert(char),
    Complement,
    /// Up to this byte.
    Blank(usize),
}

/// Whether these parentheses are the left side of `+` or `-`, or what `++` or `--` changes.
fn is_operand(tokens: &Tokens<'_>, open: usize, close: usize) -> bool {
    if !matches!(tokens.text(close + 1), "+" | "-" | "++" | "--") || close == open + 1 {
        return false;
    }
    if is_primitive(tokens.text(open + 1)) && tokens.text(open + 2) != "." {
        return false;
    }
    match tokens.kind_before(open) {
        // A call, or a statement's parentheses.
        Some(Kind::Word) => begins_expression(tokens.text_before(open)),
        _ => true,
    }
}

/// Whether a `+` has no left side.
fn is_unary(tokens: &Tokens<'_>, index: usize) -> bool {
    let before = tokens.text_before(index);
    match tokens.kind_before(index) {
        None | Some(Kind::Open) => true,
        Some(Kind::Number | Kind::Text | Kind::Char) => false,
        Some(Kind::Word) => begins_expression(before),
        Some(Kind::Symbol) => !matches!(before, "++" | "--"),
        // Of a cast.
        Some(Kind::Close) => {
            before == ")"
                && index > 2
                && tokens.text(index - 3) == "("
                && is_primitive(tokens.text(index - 2))
        }
    }
}

fn is_primitive(word: &str) -> bool {
    matches!(word, "byte" | "short" | "int" | "long" | "char" | "float" | "double" | "boolean")
}
