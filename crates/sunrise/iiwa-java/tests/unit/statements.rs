//! Statements.

use super::{body, shown};

#[track_caller]
fn is(written: &str, expected: &str) {
    let shown: Vec<String> = body(written).iter().map(shown::statement).collect();
    assert_eq!(shown.join(" "), expected, "{written}");
}

#[test]
fn blocks_and_expressions() {
    is("", "");
    is(";;", "; ;");
    is("{ a(); { } }", "{a(); {}}");
    is("a.b(c);", "a.b(c);");
    is("(a)++; i++; --i;", "(a++); (i++); (--i);");
    is("a: { break a; }", "a: {break a;}");
    is("assert a : b;", "assert;");
    is("synchronized (a) { b(); }", "synchronized {b();}");
    is("yield 3;", "yield 3;");
}

#[test]
fn locals() {
    is("int a;", "int a=-;");
    is("int a = 1, b, c[] = {1}, d[][];", "int a=1 b=- c[]={1} d[][]=-;");
    is("final List<A<B>> a = new ArrayList<A<B>>();", "List a=new ArrayList();");
    is("@Tag(\"x\") a.b.C[] d = e;", "a.b.C[] d=e;");
    is("var a = 1;", "var a=1;");
    is("Map.Entry<String, int[]> a = b;", "Map.Entry a=b;");
    is(
        "Runnable a = new Runnable() { public void run() { b(); } };",
        "Runnable a=new Runnable()<class  extends Runnable implements [], void run() {b();}>;",
    );
    is("double a = (b) + 1, c = +d;", "double a=(b + 1) c=(+ d);");
    is(
        "class B extends C { } interface D { } enum E { F }",
        "<class B extends C implements []> <abstract interface D extends - implements []> \
         <enum E extends - implements [], F()>",
    );
    is("@interface B { }", "<an annotation type>;");
    is("abstract class B { }", "<abstract class B extends - implements []>");
}

#[test]
fn choices() {
    is("if (a) b();", "if a b(); else -");
    is("if (a) { b(); } else if (c) d(); else { }", "if a {b();} else if c d(); else {}");
    is("if (a) if (b) c(); else d();", "if a if b c(); else d(); else -");
    is("if ((a) - b > 0) ++c;", "if ((a - b) > 0) (++c); else -");
    is(
        "switch (a) { case 1: case B: c(); break; default: }",
        "switch a [1]:{} [B]:{c(); break -;} [default]:{}",
    );
    is("switch (a) { case \"b\": { c(); } case -1: }", "switch a [\"b\"]:{{c();}} [(- 1)]:{}");
    is(
        "switch (a) { case 1, 2 -> b(); case C -> { d(); } default -> throw e; }",
        "switch a [1 2]->{b();} [C]->{{d();}} [default]->{throw e;}",
    );
    is("switch (a) { case null, default -> b(); }", "switch a [null default]->{b();}");
    is("switch (a) { case B b -> c(); }", "switch a [B b]->{c();}");
    is(
        "switch (a) { case P(int x, Q(var y)) when x > 1 -> c(); default -> d(); }",
        "switch a [P(int x Q(var y)) when (x > 1)]->{c();} [default]->{d();}",
    );
    is("switch (a) { }", "switch a ");
}

#[test]
fn loops() {
    is("while (a) b();", "while a b();");
    is("while (true) { continue; }", "while true {continue -;}");
    is("do a(); while (b);", "do a(); while b");
    is("for (;;) ;", "for ( | - | ) ;");
    is("for (int i = 0; i < n; i++) a();", "for (int i=0; | (i < n) | (i++)) a();");
    is(
        "for (int i = 0, j = n; i < j; i++, --j) { }",
        "for (int i=0 j=n; | (i < j) | (i++) (--j)) {}",
    );
    is("for (i = 0, j = 1; ; i += 2) { }", "for ((i = 0); (j = 1); | - | (i += 2)) {}");
    is("for (final Frame f : a.b()) c(f);", "for (Frame f : a.b()) c(f);");
    is("for (Map.Entry<A, B<C>> e : m.entrySet()) { }", "for (Map.Entry e : m.entrySet()) {}");
    is(
        "for (double[] q : new double[][] {{1}}) { }",
        "for (double[] q : new double[][] [] {{1}}) {}",
    );
    is(
        "a: for (;;) { for (;;) { continue a; } }",
        "a: for ( | - | ) {for ( | - | ) {continue a;}}",
    );
}

#[test]
fn jumps_and_exceptions() {
    is("return; return a + 1;", "return -; return (a + 1);");
    is("throw new A(\"b\");", "throw new A(\"b\");");
    is("try { a(); } catch (B b) { c(); }", "try () {a();} catch B b {c();} finally -");
    is(
        "try { } catch (final B | c.D e) { } catch (F f) { } finally { g(); }",
        "try () {} catch B c.D e {} catch F f {} finally {g();}",
    );
    is("try { } finally { }", "try () {}  finally {}");
    is("try (A a = b(); C c = d()) { }", "try (A a=b(); C c=d();) {}  finally -");
    is("try (a) { }", "try (a;) {}  finally -");
}
