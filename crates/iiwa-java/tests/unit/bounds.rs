//! How much is read at most, and that so much can be read.

use super::{fault, unit, value};
use crate::{
    read::{
        bounds::{MOST_BRACKETS, MOST_OPERATORS, MOST_TYPES},
        tokens::MOST_TOKENS,
    },
    source_error::{SourceError, SourceFault},
};

fn in_method(statements: &str) -> String {
    format!("class A {{ void a() {{ {statements} }} }}")
}

#[track_caller]
fn is_too_deep(text: &str, bound: usize) {
    let SourceError { line, fault, .. } = fault(text);
    assert_eq!(line, 1);
    assert!(matches!(fault, SourceFault::TooDeep { most, .. } if most == bound), "{fault}");
}

/// A text that is as deep as it may be is read; one that is deeper is not, however deep.
#[track_caller]
fn bounded(deep: impl Fn(usize) -> String, most: usize, bound: usize) {
    unit(&deep(most));
    is_too_deep(&deep(most + 1), bound);
    is_too_deep(&deep(20 * most), bound);
}

fn nested(open: &str, inner: &str, close: &str, depth: usize) -> String {
    format!("{}{inner}{}", open.repeat(depth), close.repeat(depth))
}

#[test]
fn brackets() {
    // Those of the class and of the method are open, too.
    let most = MOST_BRACKETS - 2;
    bounded(
        |depth| in_method(&format!("a = {};", nested("(", "a", ")", depth))),
        most,
        MOST_BRACKETS,
    );
    bounded(|depth| in_method(&nested("{", "", "}", depth)), most, MOST_BRACKETS);
    bounded(
        |depth| in_method(&format!("a = {};", nested("{", "", "}", depth))),
        most,
        MOST_BRACKETS,
    );
    bounded(
        |depth| in_method(&format!("a = {};", nested("a[", "0", "]", depth))),
        most,
        MOST_BRACKETS,
    );
    bounded(|depth| in_method(&format!("{};", nested("f(", "", ")", depth))), most, MOST_BRACKETS);
    bounded(|depth| in_method(&nested("if (a) {", "", "}", depth)), most, MOST_BRACKETS);
    // Where each is closed, there may be any number.
    unit(&in_method(&"if (a) { f((1)); } else { g[1]++; } ".repeat(5000)));
}

#[test]
fn types_and_classes() {
    let types = |depth| format!("class A {{ {} a; }}", nested("A<", "A", ">", depth));
    bounded(types, MOST_TYPES, MOST_TYPES);
    bounded(
        |depth| in_method(&format!("a({});", nested("a <", "a", "", depth))),
        MOST_TYPES,
        MOST_TYPES,
    );
    unit(&in_method(&"if (a < b) { List<A<B>> c = d < e; } ".repeat(1000)));
    bounded(|depth| nested("class A {", "", "}", depth), 6, 6);
    unit(&format!(
        "class A {{ {} }}",
        "class B { class C { Object d = new E() { }; } } ".repeat(500)
    ));
    bounded(|depth| format!("{} class A {{ }}", nested("@A(", "1", ")", depth)), 4, 4);
    is_too_deep(&format!("@A({{{}}}) class A {{ }}", "1, ".repeat(2000)), 2000);
    unit(&"@A({\"a\", \"b\"}) class A { @B(1) void c() { } } ".repeat(100));
}

#[test]
fn chains() {
    let most = MOST_OPERATORS;
    let chain = |part: &'static str, end: &'static str| {
        move |length: usize| format!("class A {{ Object a = {}{end}; }}", part.repeat(length))
    };
    // The `=` counts.
    bounded(chain("a + ", "a"), most - 1, most);
    bounded(chain("- ", "a"), most - 1, most);
    bounded(chain("!", "a"), most - 1, most);
    bounded(chain("(int) ", "a"), most - 1, most);
    bounded(chain("a.", "a"), most - 1, most);
    bounded(chain("a().", "a"), most - 1, most);
    bounded(chain("a = ", "a"), most - 1, most);
    bounded(chain("a -> ", "a"), most - 1, most);
    bounded(chain("a && b || ", "a"), (most - 1) / 2, most);
    bounded(chain("a ? b : ", "a"), (most - 1) / 2, most);
    let choices =
        |length| format!("class A {{ Object a = {}; }}", nested("a ? ", "b", " : c", length));
    bounded(choices, (most - 1) / 2, most);
    bounded(
        |length| chain("", "")(0).replace("= ", &format!("= a{}", "[0]".repeat(length))),
        most - 1,
        most,
    );
}

#[test]
fn chains_within_brackets() {
    // Whatever is open adds up.
    let half = |inner: &str| format!("{}({inner})", "a + ".repeat(MOST_OPERATORS / 2 + 1));
    is_too_deep(&in_method(&format!("b({});", half(&half("a")))), MOST_OPERATORS);
    is_too_deep(
        &in_method(&format!("{} b(c -> {{ d({} a); }});", "- ".repeat(1200), "- ".repeat(1200))),
        MOST_OPERATORS,
    );
    let call = format!("f({});", vec!["a + b"; 3000].join(", "));
    unit(&in_method(&call));
    unit(&in_method(&"a = b + c; ".repeat(5000)));
    unit(&format!("class A {{ double[] a = {{ {} }}; }}", "1.5e-3, -2 * 3, ".repeat(20_000)));
}

#[test]
fn statements_without_brackets() {
    let in_method = |statements: &str| in_method(statements);
    bounded(
        |length| in_method(&format!("{} b();", "if (a) ".repeat(length))),
        MOST_OPERATORS / 2,
        MOST_OPERATORS,
    );
    let elses = |length: usize| in_method(&format!("{} ;", "if (a) b(); else ".repeat(length)));
    unit(&elses(500));
    is_too_deep(&elses(MOST_OPERATORS), MOST_OPERATORS);
    let elses = |length: usize| in_method(&format!("{} ;", "if (a) { b(); } else ".repeat(length)));
    unit(&elses(500));
    is_too_deep(&elses(MOST_OPERATORS), MOST_OPERATORS);
    is_too_deep(&in_method(&format!("{} ;", "for (;;) ".repeat(3000))), MOST_OPERATORS);
    is_too_deep(&in_method(&format!("{} ;", "a: ".repeat(3000))), MOST_OPERATORS);
    is_too_deep(
        &in_method(&format!("{} ; {}", "do ".repeat(3000), "while (a);".repeat(3000))),
        MOST_OPERATORS,
    );
}

#[test]
fn what_is_read_more_than_once() {
    // As many tokens in one pair of parentheses as would take the parser a minute.
    let long = format!("a = (f({}));", vec!["a"; 100_000].join(", "));
    assert!(matches!(fault(&in_method(&long)).fault, SourceFault::TooLong(_)));
    unit(&in_method(&format!("f({});", vec!["g(a, 1)"; 40_000].join(", "))));
    let copied = format!("a{};", format!(".f({})", vec!["a"; 60].join(", ")).repeat(1500));
    assert!(matches!(fault(&in_method(&copied)).fault, SourceFault::TooLong(_)));
    unit(&in_method(&format!("a{};", ".append(b).append(1)".repeat(200))));
    let ends = "class A { A() { new B() { void c() { class D { D() { ".repeat(3);
    let closed = format!("{ends}{}", "} } } }; } }".repeat(3));
    unit(&closed);
}

#[test]
fn tokens() {
    let text = in_method(&"a(); ".repeat(MOST_TOKENS / 4));
    assert!(matches!(fault(&text).fault, SourceFault::TooManyTokens { most: MOST_TOKENS }));
}

#[test]
fn a_text_of_500_lines() {
    let text = vec!["\"line of the text\\n\" + number"; 500].join("\n  + ");
    assert_eq!(value(&text).line, 1);
}
