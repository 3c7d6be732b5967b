//! Expressions and literals.

use super::{fault, shown, value};

#[track_caller]
fn is(written: &str, expected: &str) {
    assert_eq!(shown::expression(&value(written)), expected, "{written}");
}

#[test]
fn literals() {
    is("null", "null");
    is("true", "true");
    is("false", "false");
    is("0", "0");
    is("1_000", "1000");
    is("017", "15");
    is("0x1F", "31");
    is("0xffffffff", "-1");
    is("0b101", "5");
    is("2147483647", "2147483647");
    is("-2147483648", "-2147483648");
    is("-2147483647", "(- 2147483647)");
    is("0x80000000", "-2147483648");
    is("5L", "5L");
    is("-9223372036854775808L", "-9223372036854775808L");
    is("0xFFFFFFFFFFFFFFFFl", "-1L");
    is("1.5", "1.5");
    is("1.", "1.0");
    is(".5e-3", "0.0005");
    is("1e10", "10000000000.0");
    is("2d", "2.0");
    is("0.1f", "0.1f");
    is("3F", "3.0f");
    is("0x1p3", "<a hexadecimal number with an exponent>");
    is("'a'", "c97");
    is(r"'\n'", "c10");
    is(r"'\''", "c39");
    is(r"'\u00e4'", "c228");
    is(r"'\uuu0041'", "c65");
    is(r"'\101'", "c65");
    is(r"'\47'", "c39");
    is(r#""a\tb\\c\"d\u0041\0""#, "\"a\\tb\\\\c\\\"dA\\0\"");
    is(r#""\1234""#, "\"S4\"");
    is(r#""\uD83D\uDE00""#, "\"\u{1f600}\"");
    is("\"\u{e4} // no comment /* none */\"", "\"\u{e4} // no comment /* none */\"");
    is("\"\"", "\"\"");
    is("\"\"\"\n  text\n  \"\"\"", "\"text\\n\"");
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
    is("a", "a");
    is("a.b.c", "a.b.c");
    is("this.a", "this.a");
    is("super.a", "super.a");
    is("Outer.this.a", "Outer.this.a");
    is("f()", "f()");
    is("f(1, a)", "f(1 a)");
    is("a.f(1).g().h", "a.f(1).g().h");
    is("super.f()", "super.f()");
    is("this.<T>f(1)", "this.f(1)");
    is("java.util.Collections.<String>emptyList()", "java.util.Collections.emptyList()");
    is("Outer.super.f()", "Outer.super.f()");
    is("a.record.open.with", "a.record.open.with");
}

#[test]
fn objects_and_arrays() {
    is("new A()", "new A()");
    is("new a.b.C<D, E<F>>(1)", "new a.b.C(1)");
    is("new ArrayList<>()", "new ArrayList()");
    is("new A(1) { int b; }", "new A(1)<class  extends A implements [], int b=->");
    is("outer.new Inner()", "<an object that is made within another (`outer.new Inner()`)>");
    is("new int[3]", "new int[] [3] {-}");
    is("new int[3][]", "new int[][] [3] {-}");
    is("new double[n + 1][2]", "new double[][] [(n + 1) 2] {-}");
    is("new int[] {1, 2,}", "new int[] [] {1 2}");
    is("new a.B[][] {{c}, {}}", "new a.B[][] [] {{c} {}}");
    is("{1, {2, 3}}", "{1 {2 3}}");
    is("a[1][i]", "a[1][i]");
    is("a.b()[0].c", "a.b()[0].c");
    is("int[].class", "int[].class");
    is("a.B.class", "a.B.class");
    is("void.class", "void.class");
}

#[test]
fn operators() {
    is("a + b * c - d", "((a + (b * c)) - d)");
    is("a / b % c", "((a / b) % c)");
    is("(a + b) * c", "((a + b) * c)");
    is("a << 1 >> 2 >>> 3", "(((a << 1) >> 2) >>> 3)");
    is("a < b == c >= d != e <= f", "(((a < b) == (c >= d)) != (e <= f))");
    is("a > b", "(a > b)");
    is("a & b ^ c | d && e || f", "(((((a & b) ^ c) | d) && e) || f)");
    is("!a", "(! a)");
    is("~a", "(~ a)");
    is("-a", "(- a)");
    is("+a", "(+ a)");
    is("- -a", "(- (- a))");
    is("a - -1", "(a - (- 1))");
    is("a + +b + c", "((a + (+ b)) + c)");
    is("~+~a", "(~ (+ (~ a)))");
    is("f(+1, +a)", "f((+ 1) (+ a))");
    is("-a++", "(- (a++))");
    is("!a.b--", "(! (a.b--))");
    is("- -a++ * b", "((- (- (a++))) * b)");
    is("-(a)--", "(- (a--))");
    is("(int) a++", "((int) (a++))");
    is("--n", "(--n)");
    is("- --n", "(- (--n))");
    is("a+++b", "((a++) + b)");
    is("a - --b", "(a - (--b))");
    is("++a", "(++a)");
    is("a--", "(a--)");
    is("--a[0]", "(--a[0])");
    is("a.b++ + ++c", "((a.b++) + (++c))");
    is("a ? b : c ? d : e", "(a ? b : (c ? d : e))");
    is("a ? b ? c : d : e", "(a ? (b ? c : d) : e)");
    is("a instanceof B && c", "((a instanceof B) && c)");
    is("a instanceof b.C<?>[]", "(a instanceof b.C[])");
    is("a instanceof B b", "(a instanceof B b)");
    is("a instanceof P(int x, var y)", "(a instanceof P(int x var y))");
    is("a = b = c", "(a = (b = c))");
    for operator in ["+", "-", "*", "/", "%", "<<", ">>", ">>>", "&", "^", "|"] {
        is(&format!("a.b[0] {operator}= c"), &format!("(a.b[0] {operator}= c)"));
    }
}

#[test]
fn casts_and_parentheses() {
    is("(int) a", "((int) a)");
    is("(int) -a", "((int) (- a))");
    is("(double) +a", "((double) (+ a))");
    is("(double) a / b", "(((double) a) / b)");
    is("(double) (a + b) / c", "(((double) (a + b)) / c)");
    is("(A) b", "((A) b)");
    is("(a.B<C>) d.e()", "((a.B) d.e())");
    is("(int[]) a", "((int[]) a)");
    is("(A) (b)", "((A) b)");
    is("(A) !b", "((A) (! b))");
    is("(Runnable & java.io.Serializable) a", "((Runnable) a)");
    // Differences and sums that the parser may read as casts of `+b` and `-b`.
    is("(a) + b", "(a + b)");
    is("(a) - b * c", "(a - (b * c))");
    is("(a) - (b) - c", "((a - b) - c)");
    is("x * (a) + b", "((x * a) + b)");
    is("x > (a) - b", "(x > (a - b))");
    is("(a.b.c) - d", "(a.b.c - d)");
    is("((a)) - d", "(a - d)");
    is("\"x\" + (a < b) + \"y\"", "((\"x\" + (a < b)) + \"y\")");
    is("(a & b) - c * d", "((a & b) - (c * d))");
    is("(a)++", "(a++)");
    is("(a) - b > 0 ? (c) - 1 : (d.e) + f * g", "(((a - b) > 0) ? (c - 1) : (d.e + (f * g)))");
    is("a = (b) + (c) * (d) - (e)", "(a = ((b + (c * d)) - e))");
    is("(int) -a - b", "(((int) (- a)) - b)");
    is("(int) (a) - b", "(((int) a) - b)");
    is("f(a) - b", "(f(a) - b)");
    is("f((a) - b, (c) + d)", "f((a - b) (c + d))");
    is("new A<B>(a) + b", "(new A(a) + b)");
    is("new A<B>(a, b) + c", "(new A(a b) + c)");
    is("c[(a) + 1]", "c[(a + 1)]");
    is("b ? (a) - 1 : (c) + 2", "(b ? (a - 1) : (c + 2))");
    is("(int) + (a) + 1", "(((int) (+ a)) + 1)");
    is("/* ( */ (a) /* ) */ - // +\n b", "(a - b)");
}

#[test]
fn method_references() {
    is("A::b", "(A::b)");
    is("this::b", "(this::b)");
    is("a.b.C::d", "(a.b.C::d)");
    is("List<String>::size", "(type List::size)");
    is("A::new", "(type A::new)");
    is("a.B::new", "(type a.B::new)");
    is("A[]::new", "(type A[]::new)");
    is("int[]::clone", "(type int[]::clone)");
    is("f()::g", "(f()::g)");
    is("super::b", "<a method reference to `super`>");
}

#[test]
fn lambda_expressions() {
    is("x -> x + 1", "(var x -> {return (x + 1);})");
    is("() -> { return; }", "( -> {return -;})");
    is("(int a, int b) -> a - b", "(int a int b -> {return (a - b);})");
    is("(a, b) -> a - b", "(var a var b -> {return (a - b);})");
    is("(var a) -> { b(); }", "(var a -> {b();})");
    is("f(x -> x, 1)", "f((var x -> {return x;}) 1)");
    is("(A) () -> b", "((A) ( -> {return b;}))");
    is("a ? x -> 1 : y -> 2", "(a ? (var x -> {return 1;}) : (var y -> {return 2;}))");
}

#[test]
fn switches_with_a_value() {
    is(
        "switch (a) { case 1, 2 -> 3; case B -> { yield 4; } default -> throw c; }",
        "(switch a [1 2]->{yield 3;} [B]->{{yield 4;}} [default]->{throw c;})",
    );
    is(
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
