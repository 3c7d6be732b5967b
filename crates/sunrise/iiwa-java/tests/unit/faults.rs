//! Faults of a text, with their places, in plain words.

use super::{fault, read};
use crate::source_error::SourceFault;

/// Checks the place and the message.
#[track_caller]
fn assert_fault(text: &str, expected: &str) {
    assert_eq!(fault(text).to_string(), format!("A.java:{expected}"), "{text}");
}

#[track_caller]
fn is_in_method(statements: &str, expected: &str) {
    assert_fault(&format!("class A {{ void a() {{\n{statements}\n}} }}"), expected);
}

#[test]
fn of_characters_texts_and_comments() {
    assert_fault("class A {\n  int # }", "2:7: `#` has no meaning in Java");
    assert_fault(
        "class A { int \\u0061; }",
        "1:15: `\\` has a meaning within texts only; write the character that is meant",
    );
    assert_fault(
        "class A { String a = \"b;\n}",
        "1:22: this text does not end on its line: `\"` is expected",
    );
    assert_fault(
        "class A { char a = 'b;\n}",
        "1:20: this text does not end on its line: `'` is expected",
    );
    assert_fault(
        "class A { String a = \"b\\\n\"; }",
        "1:22: this text does not end on its line: `\"` is expected",
    );
    assert_fault("class A {\n/* }", "2:1: this comment does not end: `*/` is expected after it");
    assert_fault(
        "class A { String a = \"\"\"\n\"\"",
        "1:22: this text block does not end: `\"\"\"` is expected after it",
    );
    assert_fault("\u{e4}\u{e4} \u{fffd}", "1:4: `\u{fffd}` has no meaning in Java");
    assert_fault(
        "class A { String a = \"\\q\"; }",
        "1:23: the character after `\\` cannot be escaped",
    );
}

#[test]
fn of_brackets() {
    assert_fault("class A {\n  void a() {\n}", "1:9: this `{` is not closed: `}` is expected");
    assert_fault("class A { } }", "1:13: unmatched `}`");
    assert_fault(
        "class A { void a() {\n b(c[1); } }",
        "2:7: `]` is expected, which closes the `[` of line 2, not `)`",
    );
}

#[test]
fn of_declarations() {
    assert_fault("klass A { }", "1:8: `;` is expected");
    assert_fault("class { }", "1:7: a name is expected, not `{`");
    assert_fault("class A { run() { } }", "1:11: `run` lacks the type that it returns, or `void`");
    assert_fault("class A { void a(int) { } }", "1:21: a name is expected, not `)`");
    assert_fault("void a() { }", "1:1: expected a class: this code is outside of any class");
    assert_fault("class A { int a = 1 int b; }", "1:20: `;` is expected");
    assert_fault("class A { int if; }", "1:15: a name is expected, not `if`");
    assert_fault(
        "class A { }\nimport b.C;",
        "2:1: `package` and `import` are expected before all classes",
    );
}

#[test]
fn of_statements() {
    is_in_method("a(b)\nc();", "2:5: `;` is expected");
    is_in_method("a(1, );", "2:6: a value is expected, not `)`");
    is_in_method("a..b();", "2:3: a name is expected, not `.`");
    is_in_method("if a { }", "2:4: `(` is expected, not `a`");
    is_in_method("a.if;", "2:3: a name is expected, not `if`");
    is_in_method("try { }", "3:1: `catch` or `finally` is expected, not `}`");
    is_in_method("a.;", "2:3: a name is expected, not `;`");
    is_in_method(
        "switch (a) { case 1 -> b(); c(); }",
        "2:29: `case`, `default` or `}` is expected, not `c`",
    );
    is_in_method("switch (a) { b(); }", "2:14: `case`, `default` or `}` is expected, not `b`");
    is_in_method("new A { };", "2:7: `(` is expected, not `{`");
    is_in_method("int a = b[];", "2:12: `;` is not expected here");
    is_in_method("a = new int[];", "2:14: `{` is expected, not `;`");
    is_in_method("a = new int[][3];", "2:15: `]` is expected, not `3`");
}

#[test]
fn of_texts_that_the_grammar_accepts_and_java_does_not() {
    is_in_method("a + b;", "2:1: expected a statement: this expression has no effect");
    is_in_method("a;", "2:1: expected a statement: this expression has no effect");
    is_in_method("1++;", "2:1: only a variable can be counted up or down");
    is_in_method("(a) ++b;", "2:1: expected a statement: this expression has no effect");
    is_in_method("import b.C;", "2:1: `import` is not expected here");
    assert_fault("class A { B { } }", "1:11: `B` is not expected here");
    assert_fault(
        "class A { void a(int... b, int c) { } }",
        "1:28: a parameter with `...` is expected to be the last",
    );
}

#[test]
fn within_skipped_text() {
    is_in_method("int a = 3 + ;", "2:13: a value is expected, not `;`");
    is_in_method("int a = 1, b = ;", "2:16: a value is expected, not `;`");
    is_in_method("Frame a = b(1 2);", "2:15: `)` is expected, not `2`");
    is_in_method("List<A> a = b(1) c;", "2:17: `;` is expected");
    is_in_method("for (A a : b) {\n c(1 2);\n}", "3:6: `)` is expected, not `2`");
    is_in_method("for (A a : b +) { }", "2:15: a value is expected, not `)`");
    is_in_method("class B {\nvoid c() {\nint d = ;\n} }", "4:9: a value is expected, not `;`");
    is_in_method("for (int i = ; i < 2; i++) { }", "2:14: a value is expected, not `;`");
    is_in_method("try (A a = ) { }", "2:12: a value is expected, not `)`");
    is_in_method("try { } finally {\n b(1 2);\n}\nc();", "3:6: `)` is expected, not `2`");
    is_in_method(
        "A a = new A() {\nvoid b() {\nfor (C c : d) {\nint e = f(,);\n} } };",
        "5:11: a value is expected, not `,`",
    );
}

#[test]
fn of_the_file_as_a_whole() {
    let error = read("A.java", "class A {\n\0 }").expect_err("a byte of 0");
    assert_eq!((error.line, error.column, error.fault), (2, 1, SourceFault::Binary));
}
