//! Expressions and literals.

use super::{fault, shown, value};

#[track_caller]
fn assert_parsed(written: &str, expected: &str) {
    assert_eq!(shown::expression(&value(written)), expected, "{written}");
}

#[test]
fn literals() {
    assert_parsed("null", "null");
    assert_parsed("true", "true");
    assert_parsed("false", "false");
    assert_parsed("0", "0");
    assert_parsed("1_000", "1000");
    assert_parsed("017", "15");
    assert_parsed("0x1F", "31");
    assert_parsed("0xffffffff", "-1");
    assert_parsed("0b101", "5");
    assert_parsed("2147483647", "2147483647");
    assert_parsed("-2147483648", "-2147483648");
    assert_parsed("-2147483647", "(- 2147483647)");
    assert_parsed("0x80000000", "-2147483648");
    assert_parsed("5L", "5L");
    assert_parsed("-9223372036854775808L", "-9223372036854775808L");
    assert_parsed("0xFFFFFFFFFFFFFFFFl", "-1L");
    assert_parsed("1.5", "1.5");
    assert_parsed("1.", "1.0");
    assert_parsed(".5e-3", "0.0005");
    assert_parsed("1e10", "10000000000.0");
    assert_parsed("2d", "2.0");
    assert_parsed("0.1f", "0.1f");
    assert_parsed("3F", "3.0f");
    assert_parsed("0x1p3", "<a hexadecimal number with an exponent>");
    assert_parsed("'a'", "c97");
    assert_parsed(r"'\n'", "c10");
    assert_parsed(r"'\''", "c39");
    assert_parsed(r"'\u00e4'", "c228");
    assert_parsed(r"'\uuu0041'", "c65");
    assert_parsed(r"'\101'", "c65");
    assert_parsed(r"'\47'", "c39");
    assert_parsed(r#""a\tb\\c\"d\u0041\0""#, "\"a\\tb\\\\c\\\"dA\\0\"");
    assert_parsed(r#""\1234""#, "\"S4\"");
    assert_parsed(r#""\uD83D\uDE00""#, "\"\u{1f600}\"");
    assert_parsed("\"\u{e4} // no comment /* none */\"", "\"\u{e4} // no comment /* none */\"");
    assert_parsed("\"\"", "\"\"");
    assert_parsed("\"\"\"\n  text\n  \"\"\"", "\"text\\n\"");
}

#[test]
fn literals_that_are_none() {
    for written in
        ["2147483648", "9223372036854775808L", "0x1_0000_0000", "08", "1e999", "1e99f", "0b2", "0x"]
    {
        let error = fault(&format!("class A {{ Object a = {written}; }}"));
        assert!(error.line == 1 && error.column >= 22, "{error}");
    }
    for written in ["''", "'ab'", r"'\q'", r#""\q""#, r#""\u12""#, r#""\u00e""#] {
        let error = fault(&format!("class A {{ Object a = {written}; }}"));
        assert!(error.column >= 22, "{error}");
    }
}

#[test]
fn names_fields_and_calls() {
    assert_parsed("a", "a");
    assert_parsed("a.b.c", "a.b.c");
    assert_parsed("this.a", "this.a");
    assert_parsed("super.a", "super.a");
    assert_parsed("Outer.this.a", "Outer.this.a");
    assert_parsed("f()", "f()");
    assert_parsed("f(1, a)", "f(1 a)");
    assert_parsed("a.f(1).g().h", "a.f(1).g().h");
    assert_parsed("super.f()", "super.f()");
    assert_parsed("this.<T>f(1)", "this.f(1)");
    assert_parsed("java.util.Collections.<String>emptyList()", "java.util.Collections.emptyList()");
    assert_parsed("Outer.super.f()", "Outer.super.f()");
    assert_parsed("a.record.open.with", "a.record.open.with");
}

#[test]
fn objects_and_arrays() {
    assert_parsed("new A()", "new A()");
    assert_parsed("new a.b.C<D, E<F>>(1)", "new a.b.C(1)");
    assert_parsed("new ArrayList<>()", "new ArrayList()");
    assert_parsed("new A(1) { int b; }", "new A(1)<class  extends A implements [], int b=->");
    assert_parsed(
        "outer.new Inner()",
        "<an object that is made within another (`outer.new Inner()`)>",
    );
    assert_parsed("new int[3]", "new int[] [3] {-}");
    assert_parsed("new int[3][]", "new int[][] [3] {-}");
    assert_parsed("new double[n + 1][2]", "new double[][] [(n + 1) 2] {-}");
    assert_parsed("new int[] {1, 2,}", "new int[] [] {1 2}");
    assert_parsed("new a.B[][] {{c}, {}}", "new a.B[][] [] {{c} {}}");
    assert_parsed("{1, {2, 3}}", "{1 {2 3}}");
    assert_parsed("a[1][i]", "a[1][i]");
    assert_parsed("a.b()[0].c", "a.b()[0].c");
    assert_parsed("int[].class", "int[].class");
    assert_parsed("a.B.class", "a.B.class");
    assert_parsed("void.class", "void.class");
}

#[test]
fn operators() {
    assert_parsed("a + b * c - d", "((a + (b * c)) - d)");
    assert_parsed("a / b % c", "((a / b) % c)");
    assert_parsed("(a + b) * c", "((a + b) * c)");
    assert_parsed("a << 1 >> 2 >>> 3", "(((a << 1) >> 2) >>> 3)");
    assert_parsed("a < b == c >= d != e <= f", "(((a < b) == (c >= d)) != (e <= f))");
    assert_parsed("a > b", "(a > b)");
    assert_parsed("a & b ^ c | d && e || f", "(((((a & b) ^ c) | d) && e) || f)");
    assert_parsed("!a", "(! a)");
    assert_parsed("~a", "(~ a)");
    assert_parsed("-a", "(- a)");
    assert_parsed("+a", "(+ a)");
    assert_parsed("- -a", "(- (- a))");
    assert_parsed("a - -1", "(a - (- 1))");
    assert_parsed("a + +b + c", "((a + (+ b)) + c)");
    assert_parsed("~+~a", "(~ (+ (~ a)))");
    assert_parsed("f(+1, +a)", "f((+ 1) (+ a))");
    assert_parsed("-a++", "(- (a++))");
    assert_parsed("!a.b--", "(! (a.b--))");
    assert_parsed("- -a++ * b", "((- (- (a++))) * b)");
    assert_parsed("-(a)--", "(- (a--))");
    assert_parsed("(int) a++", "((int) (a++))");
    assert_parsed("--n", "(--n)");
    assert_parsed("- --n", "(- (--n))");
    assert_parsed("a+++b", "((a++) + b)");
    assert_parsed("a - --b", "(a - (--b))");
    assert_parsed("++a", "(++a)");
    assert_parsed("a--", "(a--)");
    assert_parsed("--a[0]", "(--a[0])");
    assert_parsed("a.b++ + ++c", "((a.b++) + (++c))");
    assert_parsed("a ? b : c ? d : e", "(a ? b : (c ? d : e))");
    assert_parsed("a ? b ? c : d : e", "(a ? (b ? c : d) : e)");
    assert_parsed("a instanceof B && c", "((a instanceof B) && c)");
    assert_parsed("a instanceof b.C<?>[]", "(a instanceof b.C[])");
    assert_parsed("a instanceof B b", "(a instanceof B b)");
    assert_parsed("a instanceof P(int x, var y)", "(a instanceof P(int x var y))");
    assert_parsed("a = b = c", "(a = (b = c))");
    for operator in ["+", "-", "*", "/", "%", "<<", ">>", ">>>", "&", "^", "|"] {
        assert_parsed(&format!("a.b[0] {operator}= c"), &format!("(a.b[0] {operator}= c)"));
    }
}

#[test]
fn casts_and_parentheses() {
    assert_parsed("(int) a", "((int) a)");
    assert_parsed("(int) -a", "((int) (- a))");
    assert_parsed("(double) +a", "((double) (+ a))");
    assert_parsed("(double) a / b", "(((double) a) / b)");
    assert_parsed("(double) (a + b) / c", "(((double) (a + b)) / c)");
    assert_parsed("(A) b", "((A) b)");
    assert_parsed("(a.B<C>) d.e()", "((a.B) d.e())");
    assert_parsed("(int[]) a", "((int[]) a)");
    assert_parsed("(A) (b)", "((A) b)");
    assert_parsed("(A) !b", "((A) (! b))");
    assert_parsed("(Runnable & java.io.Serializable) a", "((Runnable) a)");
    // Differences and sums that the parser may read as casts of `+b` and `-b`.
    assert_parsed("(a) + b", "(a + b)");
    assert_parsed("(a) - b * c", "(a - (b * c))");
    assert_parsed("(a) - (b) - c", "((a - b) - c)");
    assert_parsed("x * (a) + b", "((x * a) + b)");
    assert_parsed("x > (a) - b", "(x > (a - b))");
    assert_parsed("(a.b.c) - d", "(a.b.c - d)");
    assert_parsed("((a)) - d", "(a - d)");
    assert_parsed("\"x\" + (a < b) + \"y\"", "((\"x\" + (a < b)) + \"y\")");
    assert_parsed("(a & b) - c * d", "((a & b) - (c * d))");
    assert_parsed("(a)++", "(a++)");
    assert_parsed(
        "(a) - b > 0 ? (c) - 1 : (d.e) + f * g",
        "(((a - b) > 0) ? (c - 1) : (d.e + (f * g)))",
    );
    assert_parsed("a = (b) + (c) * (d) - (e)", "(a = ((b + (c * d)) - e))");
    assert_parsed("(int) -a - b", "(((int) (- a)) - b)");
    assert_parsed("(int) (a) - b", "(((int) a) - b)");
    assert_parsed("f(a) - b", "(f(a) - b)");
    assert_parsed("f((a) - b, (c) + d)", "f((a - b) (c + d))");
    assert_parsed("new A<B>(a) + b", "(new A(a) + b)");
    assert_parsed("new A<B>(a, b) + c", "(new A(a b) + c)");
    assert_parsed("c[(a) + 1]", "c[(a + 1)]");
    assert_parsed("b ? (a) - 1 : (c) + 2", "(b ? (a - 1) : (c + 2))");
    assert_parsed("(int) + (a) + 1", "(((int) (+ a)) + 1)");
    assert_parsed("/* ( */ (a) /* ) */ - // +\n b", "(a - b)");
}

#[test]
fn method_references() {
    assert_parsed("A::b", "(A::b)");
    assert_parsed("this::b", "(this::b)");
    assert_parsed("a.b.C::d", "(a.b.C::d)");
    assert_parsed("List<String>::size", "(type List::size)");
    assert_parsed("A::new", "(type A::new)");
    assert_parsed("a.B::new", "(type a.B::new)");
    assert_parsed("A[]::new", "(type A[]::new)");
    assert_parsed("int[]::clone", "(type int[]::clone)");
    assert_parsed("f()::g", "(f()::g)");
    assert_parsed("super::b", "<a method reference to `super`>");
}

#[test]
fn lambda_expressions() {
    assert_parsed("x -> x + 1", "(var x -> {return (x + 1);})");
    assert_parsed("() -> { return; }", "( -> {return -;})");
    assert_parsed("(int a, int b) -> a - b", "(int a int b -> {return (a - b);})");
    assert_parsed("(a, b) -> a - b", "(var a var b -> {return (a - b);})");
    assert_parsed("(var a) -> { b(); }", "(var a -> {b();})");
    assert_parsed("f(x -> x, 1)", "f((var x -> {return x;}) 1)");
    assert_parsed("(A) () -> b", "((A) ( -> {return b;}))");
    assert_parsed("a ? x -> 1 : y -> 2", "(a ? (var x -> {return 1;}) : (var y -> {return 2;}))");
}

#[test]
fn switches_with_a_value() {
    assert_parsed(
        "switch (a) { case 1, 2 -> 3; case B -> { yield 4; } default -> throw c; }",
        "(switch a [1 2]->{yield 3;} [B]->{{yield 4;}} [default]->{throw c;})",
    );
    assert_parsed(
        "1 + switch (a) { case 1: yield 2; default: yield 3; }",
        "(1 + (switch a [1]:{yield 2;} [default]:{yield 3;}))",
    );
}

#[test]
fn targets_that_nothing_can_be_assigned_to() {
    for written in ["1 = 2", "f() = 2", "1++", "--f()", "a + b = c"] {
        let error = fault(&format!("class A {{ Object a = {written}; }}"));
        assert_eq!(error.line, 1, "{error}");
    }
}
