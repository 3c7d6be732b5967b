//! Bounds that a file keeps before the parser sees it.
//!
//! The parser calls itself for what is nested, and for most operators, so that a file of a few hundred kilobytes could
//! overflow any stack. It also reads some things more than once: what is in parentheses, to tell casts and lambda
//! expressions from them; types, to tell them from comparisons; what a method is called on, which it copies; annotations;
//! the first statement of constructors. All of that is bounded here, far above what people write.

use super::{
    fault::Fault,
    tokens::{Kind, Tokens, begins_expression},
};
use crate::source_error::SourceFault;

/// Brackets within brackets.
pub(super) const MOST_BRACKETS: usize = 200;
/// Operators, calls on the results of calls, and statements within statements that need no brackets.
pub(super) const MOST_OPERATORS: usize = 2000;
/// Type arguments within type arguments.
pub(super) const MOST_TYPES: usize = 50;
/// Classes within classes.
const MOST_CLASSES: usize = 6;
/// Annotations within arguments of annotations.
const MOST_ANNOTATIONS: usize = 4;
/// Tokens of the arguments of an annotation.
const MOST_IN_ANNOTATION: usize = 2000;
/// Squares of the numbers of tokens in parentheses, added up: a second's work.
const MOST_LOOKED_AHEAD: usize = 400_000_000;
/// Tokens before calls, added up for each of them: a second's work.
const MOST_COPIED: usize = 20_000_000;

/// Checks that the brackets of a file match, and that the parser can read it in time and on its stack.
pub(super) fn check(tokens: &Tokens<'_>) -> Result<(), Fault> {
    let mut walk = Walk {
        tokens,
        levels: vec![Level::default()],
        depth: 0,
        types: 0,
        looked_ahead: 0,
        copied: 0,
        is_class_next: false,
    };
    for index in 0..tokens.list.len() {
        walk.step(index)?;
    }
    match walk.levels.pop() {
        Some(level) if level.is_bracket => {
            let opened = tokens.text(level.open);
            let what = format!("this `{opened}` is not closed: `{}` is expected", closing(opened));
            Err(Fault::syntax(tokens.start(level.open), what))
        }
        _ => Ok(()),
    }
}

/// What is between two brackets, or in the file as a whole.
#[derive(Default)]
struct Level {
    is_bracket: bool,
    /// The token that opens it.
    open: usize,
    is_class: bool,
    is_annotation: bool,
    /// How deep it is on the parser's stack at most.
    depth: Depth,
    /// The first token of what methods are called on.
    operand: usize,
}

#[derive(Clone, Copy, Default)]
struct Depth {
    operators: usize,
    /// Calls and fields behind one another.
    chain: usize,
    /// Statements within statements.
    statements: usize,
}

impl Depth {
    fn sum(self) -> usize {
        self.operators + self.chain + self.statements
    }
}

struct Walk<'t> {
    tokens: &'t Tokens<'t>,
    levels: Vec<Level>,
    /// Of all levels.
    depth: usize,
    types: usize,
    looked_ahead: usize,
    copied: usize,
    /// Whether the next brace is that of a class.
    is_class_next: bool,
}

impl Walk<'_> {
    fn step(&mut self, index: usize) -> Result<(), Fault> {
        let text = self.tokens.text(index);
        let Some(kind) = self.tokens.kind(index) else { return Ok(()) };
        self.type_arguments(index, kind, text)?;
        match kind {
            Kind::Open => self.open(index, text),
            Kind::Close => self.close(index, text),
            Kind::Symbol => self.symbol(index, text),
            Kind::Word => self.word(index, text),
            Kind::Number | Kind::Text | Kind::Char => Ok(()),
        }
    }

    fn fault<T>(&self, index: usize, what: &'static str, most: usize) -> Result<T, Fault> {
        Err(Fault::too_deep(self.tokens.start(index), what, most))
    }

    fn too_long<T>(&self, index: usize, what: &'static str) -> Result<T, Fault> {
        Err(Fault { at: self.tokens.start(index), what: SourceFault::TooLong(what) })
    }

    /// Changes how deep the innermost level is.
    fn deepen(&mut self, index: usize, change: impl FnOnce(&mut Depth)) -> Result<(), Fault> {
        let Some(level) = self.levels.last_mut() else { return Ok(()) };
        let before = level.depth.sum();
        change(&mut level.depth);
        self.depth = self.depth - before + level.depth.sum();
        if self.depth > MOST_OPERATORS {
            return self.fault(index, "an expression is too long", MOST_OPERATORS);
        }
        Ok(())
    }

    fn open(&mut self, index: usize, text: &str) -> Result<(), Fault> {
        if self.levels.len() > MOST_BRACKETS {
            return self.fault(index, "too many brackets are open", MOST_BRACKETS);
        }
        let ends_operand = match self.tokens.kind_before(index) {
            Some(Kind::Word) => true,
            _ => matches!(self.tokens.text_before(index), ")" | "]"),
        };
        if text == "[" && ends_operand {
            self.deepen(index, |depth| depth.chain += 1)?;
        }
        let is_class = text == "{" && std::mem::take(&mut self.is_class_next);
        if is_class && self.levels.iter().filter(|level| level.is_class).count() >= MOST_CLASSES {
            return self.fault(index, "too many classes are within one another", MOST_CLASSES);
        }
        let is_annotation = text == "(" && self.is_annotation(index);
        if is_annotation {
            if self.types > 0 {
                let what = "an annotation with arguments is not expected within a type";
                return Err(Fault::syntax(self.tokens.start(index), what));
            }
            if self.levels.iter().filter(|level| level.is_annotation).count() >= MOST_ANNOTATIONS {
                let what = "too many annotations are within one another";
                return self.fault(index, what, MOST_ANNOTATIONS);
            }
        }
        self.levels.push(Level {
            is_bracket: true,
            open: index,
            is_class,
            is_annotation,
            depth: Depth::default(),
            operand: index + 1,
        });
        Ok(())
    }

    /// Whether these parentheses are those of an annotation.
    fn is_annotation(&self, open: usize) -> bool {
        let mut index = open;
        while self.tokens.kind_before(index) == Some(Kind::Word) {
            index -= 1;
            match self.tokens.text_before(index) {
                "@" => return true,
                "." => index -= 1,
                _ => return false,
            }
        }
        false
    }

    fn close(&mut self, index: usize, text: &str) -> Result<(), Fault> {
        let closed = self.levels.pop().filter(|level| level.is_bracket);
        let Some(closed) = closed else {
            let what = format!("`{text}` closes nothing");
            return Err(Fault::syntax(self.tokens.start(index), what));
        };
        let opened = self.tokens.text(closed.open);
        if closing(opened) != text {
            let line = self.tokens.line(closed.open);
            let expected = closing(opened);
            let what = format!(
                "`{expected}` is expected, which closes the `{opened}` of line {line}, not `{text}`"
            );
            return Err(Fault::syntax(self.tokens.start(index), what));
        }
        self.depth -= closed.depth.sum();
        if closed.is_annotation && index - closed.open > MOST_IN_ANNOTATION {
            return self.fault(index, "an annotation is too long", MOST_IN_ANNOTATION);
        }
        match text {
            ")" => self.close_parenthesis(index, closed.open),
            "}" if self.ends_statement(index) => self.begin_statement(index),
            _ => Ok(()),
        }
    }

    fn close_parenthesis(&mut self, index: usize, open: usize) -> Result<(), Fault> {
        let before = self.tokens.text_before(open);
        let is_called = self.tokens.kind_before(open) == Some(Kind::Word);
        if !is_called || begins_expression(before) {
            self.looked_ahead += (index - open) * (index - open);
            if self.looked_ahead > MOST_LOOKED_AHEAD {
                return self.too_long(index, "too much is in parentheses");
            }
        } else if open > 1 && self.tokens.text(open - 2) == "." {
            let operand = self.levels.last().map_or(0, |level| level.operand);
            self.copied += open.saturating_sub(operand);
            if self.copied > MOST_COPIED {
                return self.too_long(index, "too many calls are on the results of calls");
            }
        }
        // A cast calls the parser once more, as an operator does.
        let is_cast = match self.tokens.kind(index + 1) {
            Some(Kind::Symbol) => matches!(self.tokens.text(index + 1), "!" | "~"),
            Some(Kind::Open) => self.tokens.text(index + 1) == "(",
            Some(Kind::Close) | None => false,
            Some(_) => true,
        };
        if is_cast { self.deepen(index, |depth| depth.operators += 1) } else { Ok(()) }
    }

    fn symbol(&mut self, index: usize, text: &str) -> Result<(), Fault> {
        match text {
            ";" if self.is_block() => self.begin_statement(index),
            ";" | "," => {
                self.operand(index + 1);
                self.deepen(index, |depth| {
                    depth.operators = 0;
                    depth.chain = 0;
                })
            }
            "." if !self.is_name_next(index) => {
                // The parser takes any token for a name here.
                let at = self.tokens.start(index + 1);
                let found = self.tokens.text(index + 1);
                Err(Fault::syntax(at, format!("a name is expected, not `{found}`")))
            }
            "." | "::" => self.deepen(index, |depth| depth.chain += 1),
            "@" | "..." => Ok(()),
            _ => {
                self.operand(index + 1);
                self.deepen(index, |depth| {
                    depth.operators += 1;
                    depth.chain = 0;
                })
            }
        }
    }

    /// Whether a name may follow a dot; before it, there may be type arguments or an annotation.
    fn is_name_next(&self, dot: usize) -> bool {
        self.tokens.kind(dot + 1) == Some(Kind::Word)
            || matches!(self.tokens.text(dot + 1), "<" | "@" | "*")
    }

    fn word(&mut self, index: usize, text: &str) -> Result<(), Fault> {
        match text {
            "if" | "else" | "for" | "while" | "do" => {
                self.deepen(index, |depth| depth.statements += 1)
            }
            "instanceof" => self.deepen(index, |depth| depth.operators += 1),
            "class" | "interface" | "enum" if self.tokens.text_before(index) != "." => {
                self.is_class_next = true;
                Ok(())
            }
            "record" if self.tokens.kind(index + 1) == Some(Kind::Word) => {
                self.is_class_next = true;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Counts type arguments, as far as they can be told from comparisons.
    fn type_arguments(&mut self, index: usize, kind: Kind, text: &str) -> Result<(), Fault> {
        self.types = match text {
            "<" => self.types + 1,
            ">" => self.types.saturating_sub(1),
            ">>" => self.types.saturating_sub(2),
            ">>>" => self.types.saturating_sub(3),
            "," | "." | "?" | "&" | "[" | "]" | "@" => self.types,
            _ if kind == Kind::Word => self.types,
            "(" if self.is_annotation(index) => self.types,
            _ => 0,
        };
        if self.types > MOST_TYPES {
            return self.fault(index, "too many `<` are open", MOST_TYPES);
        }
        Ok(())
    }

    fn is_block(&self) -> bool {
        self.levels
            .last()
            .is_none_or(|level| !level.is_bracket || self.tokens.text(level.open) == "{")
    }

    /// Whether a `}` ends a statement or a member; else it ends part of an expression.
    fn ends_statement(&self, index: usize) -> bool {
        let next = self.tokens.text(index + 1);
        let goes_on = match self.tokens.kind(index + 1) {
            Some(Kind::Word) => next == "instanceof",
            Some(Kind::Symbol) => !matches!(next, "@" | "++" | "--" | ";"),
            Some(Kind::Open) => next == "[",
            Some(Kind::Close) => next != "}",
            Some(_) => true,
            None => false,
        };
        self.is_block() && !goes_on
    }

    fn begin_statement(&mut self, index: usize) -> Result<(), Fault> {
        self.operand(index + 1);
        let goes_on = self.tokens.text(index + 1) == "else";
        self.is_class_next = false;
        self.deepen(index, |depth| {
            let statements = if goes_on { depth.statements } else { 0 };
            *depth = Depth { statements, ..Depth::default() };
        })
    }

    fn operand(&mut self, first: usize) {
        if let Some(level) = self.levels.last_mut() {
            level.operand = first;
        }
    }
}

fn closing(open: &str) -> &'static str {
    match open {
        "(" => ")",
        "[" => "]",
        _ => "}",
    }
}
