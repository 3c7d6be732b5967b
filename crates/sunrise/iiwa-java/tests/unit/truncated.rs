//! Truncated and random texts: no input may cause a panic.

use proptest::prelude::*;

use super::{read, unit};

/// Program that is also a fuzzing seed.
const PROGRAM: &str = include_str!("../../../../../tests/fuzz/seeds/java/stacking.java");

#[test]
fn a_program_that_ends_anywhere() {
    assert_eq!(unit(PROGRAM).classes.len(), 1);
    for end in (0..PROGRAM.len()).filter(|end| PROGRAM.is_char_boundary(*end)) {
        let result = read("A.java", &PROGRAM[..end]);
        // A text truncated within the head or after the end may be valid.
        if (200..PROGRAM.len() - 2).contains(&end) {
            let error = result.expect_err(&PROGRAM[..end]);
            assert!(error.line >= 1 && !error.to_string().contains("the parser failed"), "{error}");
        }
    }
}

#[test]
fn a_program_from_anywhere_on() {
    for start in (1..PROGRAM.len()).filter(|start| PROGRAM.is_char_boundary(*start)) {
        if let Err(error) = read("A.java", &PROGRAM[start..]) {
            assert!(!error.to_string().contains("the parser failed"), "{error}");
        }
    }
}

#[test]
fn a_program_without_any_one_token() {
    let tokens = crate::read::tokens::Tokens::scan(PROGRAM).expect("tokens");
    for token in &tokens.list {
        for replacement in ["", ";", "(", "}", "x", "<", "1"] {
            let text = format!("{}{replacement}{}", &PROGRAM[..token.start], &PROGRAM[token.end..]);
            if let Err(error) = read("A.java", &text) {
                assert!(!error.to_string().contains("the parser failed"), "{error}");
            }
        }
    }
}

/// Generates Java words and symbols.
fn word() -> impl Strategy<Value = &'static str> {
    prop::sample::select(
        &[
            "class",
            "A",
            "b",
            "{",
            "}",
            "(",
            ")",
            "[",
            "]",
            ";",
            ",",
            ".",
            "=",
            "+",
            "-",
            "<",
            ">",
            ">>",
            "->",
            "::",
            "?",
            ":",
            "@",
            "1",
            "\"s\"",
            "'c'",
            "int",
            "void",
            "new",
            "for",
            "if",
            "else",
            "while",
            "do",
            "switch",
            "case",
            "default",
            "try",
            "catch",
            "finally",
            "return",
            "static",
            "this",
            "super",
            "import",
            "package",
            "enum",
            "interface",
            "record",
            "instanceof",
            "final",
            "++",
            "!",
            "~",
            "*",
            "&",
            "...",
            "//x\n",
            "/*x*/",
            "yield",
            "var",
            "sealed",
            "non",
            "_",
            "null",
            "0x",
            "1e",
            "\\",
            "\u{e4}",
        ][..],
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, ..ProptestConfig::default() })]

    #[test]
    fn any_words(words in prop::collection::vec(word(), 0..60), is_in_method in any::<bool>()) {
        let words = words.join(" ");
        let text = if is_in_method { format!("class A {{ void a() {{ {words} \
            }} }}") } else { words };
        if let Err(error) = read("A.java", &text) {
            prop_assert!(!error.to_string().contains("the parser failed"), "{}", error);
        }
    }

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        if let Err(error) = read("A.java", &crate::source_text::decode(&bytes)) {
            prop_assert!(!error.to_string().contains("the parser failed"), "{}", error);
        }
    }

    /// Any expression in a method is read as Java reads it: the fully parenthesised text gives the
    /// same tree.
    #[test]
    fn sums_in_parentheses(
        parts in prop::collection::vec(
            (any::<bool>(), 0_usize..4, prop::sample::select(&["+", "-", "*", "<", "&&"][..])),
            1..8,
        ),
    ) {
        let mut plain = String::from("x");
        let mut wrapped = String::from("x");
        for (is_in_parentheses, name, operator) in parts {
            let name = ["a", "b.c", "f(d)", "e[1]"][name];
            plain.extend([" ", operator, " ", name]);
            let name = if is_in_parentheses { format!("({name})") } else { name.to_owned() };
            wrapped.extend([" ", operator, " ", &name]);
        }
        let shown = |written: &str| super::shown::expression(&super::value(written));
        prop_assert_eq!(shown(&plain), shown(&wrapped));
    }
}
