//! Bounds of the reader, and texts just below them.

use super::{fault, unit, value};
use crate::{
    read::{
        bounds::{MAX_LEVELS, MAX_TOKENS_BEFORE_SEARCH},
        tokens::MAX_TOKENS,
    },
    source_error::{SourceError, SourceFault},
};

fn in_method(statements: &str) -> String {
    format!("class A {{ void a() {{ {statements} }} }}")
}

/// Checks that a text of some depth is read if each part of it is this many tree levels, and that a
/// text deeper than the bound is refused, however deep it is.
#[track_caller]
fn bounded(deep: impl Fn(usize) -> String, levels: usize) {
    // The surrounding class, method, statement and value are at most this many levels.
    unit(&deep((MAX_LEVELS - 12) / levels));
    for depth in [MAX_LEVELS / levels + 1, 20 * MAX_LEVELS] {
        let SourceError { line, fault, .. } = fault(&deep(depth));
        assert_eq!(line, 1);
        let SourceFault::TooDeep { max_depth, .. } = fault else { panic!("{fault}") };
        assert_eq!(max_depth, MAX_LEVELS);
    }
}

fn nested(open: &str, inner: &str, close: &str, depth: usize) -> String {
    format!("{}{inner}{}", open.repeat(depth), close.repeat(depth))
}

#[test]
fn brackets() {
    bounded(|depth| in_method(&format!("a = {};", nested("(", "a", ")", depth))), 1);
    bounded(|depth| in_method(&nested("{", "", "}", depth)), 1);
    bounded(|depth| in_method(&format!("int[] a = {};", nested("{", "", "}", depth))), 1);
    bounded(|depth| in_method(&format!("a = {};", nested("a[", "0", "]", depth))), 1);
    bounded(|depth| in_method(&format!("{};", nested("f(", "", ")", depth))), 2);
    bounded(|depth| in_method(&nested("if (a) {", "", "}", depth)), 2);
    // Closed constructs are not limited in number.
    unit(&in_method(&"if (a) { f((1)); } else { g[1]++; } ".repeat(5000)));
}

#[test]
fn types_and_classes() {
    bounded(|depth| format!("class A {{ {} a; }}", nested("A<", "A", ">", depth)), 2);
    unit(&in_method(&"if (a < b) { List<A<B>> c = d < e; } ".repeat(1000)));
    bounded(|depth| nested("class A {", "", "}", depth), 2);
    unit(&format!(
        "class A {{ {} }}",
        "class B { class C { Object d = new E() { }; } } ".repeat(500)
    ));
    bounded(|depth| format!("{} class A {{ }}", nested("@A(", "1", ")", depth)), 2);
    unit(&"@A({\"a\", \"b\"}) class A { @B(1) void c() { } } ".repeat(100));
}

#[test]
fn chains() {
    let chain = |part: &'static str, end: &'static str| {
        move |length: usize| format!("class A {{ Object a = {}{end}; }}", part.repeat(length))
    };
    bounded(chain("a + ", "a"), 1);
    bounded(chain("- ", "a"), 1);
    bounded(chain("!", "a"), 1);
    bounded(chain("(int) ", "a"), 1);
    bounded(chain("a.", "a"), 1);
    bounded(chain("a().", "a"), 1);
    bounded(chain("a = ", "a"), 1);
    bounded(chain("a -> ", "a"), 1);
    bounded(chain("a ? b : ", "a"), 1);
    bounded(
        |length| format!("class A {{ Object a = {}; }}", nested("a ? ", "b", " : c", length)),
        1,
    );
    bounded(|length| format!("class A {{ Object a = a{}; }}", "[0]".repeat(length)), 1);
    unit(&in_method(&format!("f({});", vec!["a + b"; 3000].join(", "))));
    unit(&in_method(&"a = b + c; ".repeat(5000)));
    unit(&format!("class A {{ double[] a = {{ {} }}; }}", "1.5e-3, -2 * 3, ".repeat(20_000)));
}

#[test]
fn statements_without_brackets() {
    bounded(|length| in_method(&format!("{} b();", "if (a) ".repeat(length))), 1);
    bounded(|length| in_method(&format!("{} ;", "if (a) b(); else ".repeat(length))), 1);
    bounded(|length| in_method(&format!("{} ;", "for (;;) ".repeat(length))), 1);
    bounded(|length| in_method(&format!("{} ;", "a: ".repeat(length))), 1);
    bounded(
        |length| in_method(&format!("{} ; {}", "do ".repeat(length), "while (a);".repeat(length))),
        1,
    );
}

#[test]
fn long_lists_and_chains() {
    unit(&in_method(&format!("a = (f({}));", vec!["a"; 100_000].join(", "))));
    unit(&in_method(&format!("f({});", vec!["g(a, 1)"; 40_000].join(", "))));
    unit(&in_method(&format!("a{};", format!(".f({})", vec!["a"; 60].join(", ")).repeat(1500))));
}

#[test]
fn tokens() {
    let text = in_method(&"a(); ".repeat(MAX_TOKENS / 4));
    assert!(matches!(fault(&text).fault, SourceFault::TooManyTokens { max_tokens: MAX_TOKENS }));
}

#[test]
fn an_error_after_many_tokens() {
    let error_after = |calls: usize| {
        fault(&in_method(&format!("{} a b c();", "a(); ".repeat(calls)))).to_string()
    };
    assert!(!error_after(10).contains("is not expected here"));
    assert!(error_after(MAX_TOKENS_BEFORE_SEARCH / 4).contains("`c` is not expected here"));
}

#[test]
fn a_text_of_500_lines() {
    let text = vec!["\"line of the text\\n\" + number"; 500].join("\n  + ");
    assert_eq!(value(&text).line, 1);
}
