//! Statements.

use super::{body, shown};

#[track_caller]
fn assert_parsed(written: &str, expected: &str) {
    let shown: Vec<String> = body(written).iter().map(shown::statement).collect();
    assert_eq!(shown.join(" "), expected, "{written}");
}

#[test]
fn blocks_and_expressions() {
    assert_parsed("", "");
    assert_parsed(";;", "; ;");
    assert_parsed("{ a(); { } }", "{a(); {}}");
    assert_parsed("a.b(c);", "a.b(c);");
    assert_parsed("(a)++; i++; --i;", "(a++); (i++); (--i);");
    assert_parsed("a: { break a; }", "a: {break a;}");
    assert_parsed("assert a : b;", "assert;");
    assert_parsed("synchronized (a) { b(); }", "synchronized {b();}");
    assert_parsed("yield 3;", "yield 3;");
}

#[test]
fn locals() {
    assert_parsed("int a;", "int a=-;");
    assert_parsed("int a = 1, b, c[] = {1}, d[][];", "int a=1 b=- c[]={1} d[][]=-;");
    assert_parsed("final List<A<B>> a = new ArrayList<A<B>>();", "List a=new ArrayList();");
    assert_parsed("@Tag(\"x\") a.b.C[] d = e;", "a.b.C[] d=e;");
    assert_parsed("var a = 1;", "var a=1;");
    assert_parsed("Map.Entry<String, int[]> a = b;", "Map.Entry a=b;");
    assert_parsed(
        "Runnable a = new Runnable() { public void run() { b(); } };",
        "Runnable a=new Runnable()<class  extends Runnable implements [], void run() {b();}>;",
    );
    assert_parsed("double a = (b) + 1, c = +d;", "double a=(b + 1) c=(+ d);");
    assert_parsed(
        "class B extends C { } interface D { } enum E { F }",
        "<class B extends C implements []> <abstract interface D extends - implements []> \
         <enum E extends - implements [], F()>",
    );
    assert_parsed("@interface B { }", "<an annotation type>;");
    assert_parsed("abstract class B { }", "<abstract class B extends - implements []>");
}

#[test]
fn choices() {
    assert_parsed("if (a) b();", "if a b(); else -");
    assert_parsed(
        "if (a) { b(); } else if (c) d(); else { }",
        "if a {b();} else if c d(); else {}",
    );
    assert_parsed("if (a) if (b) c(); else d();", "if a if b c(); else d(); else -");
    assert_parsed("if ((a) - b > 0) ++c;", "if ((a - b) > 0) (++c); else -");
    assert_parsed(
        "switch (a) { case 1: case B: c(); break; default: }",
        "switch a [1]:{} [B]:{c(); break -;} [default]:{}",
    );
    assert_parsed(
        "switch (a) { case \"b\": { c(); } case -1: }",
        "switch a [\"b\"]:{{c();}} [(- 1)]:{}",
    );
    assert_parsed(
        "switch (a) { case 1, 2 -> b(); case C -> { d(); } default -> throw e; }",
        "switch a [1 2]->{b();} [C]->{{d();}} [default]->{throw e;}",
    );
    assert_parsed("switch (a) { case null, default -> b(); }", "switch a [null default]->{b();}");
    assert_parsed("switch (a) { case B b -> c(); }", "switch a [B b]->{c();}");
    assert_parsed(
        "switch (a) { case P(int x, Q(var y)) when x > 1 -> c(); default -> d(); }",
        "switch a [P(int x Q(var y)) when (x > 1)]->{c();} [default]->{d();}",
    );
    assert_parsed("switch (a) { }", "switch a ");
}

#[test]
fn loops() {
    assert_parsed("while (a) b();", "while a b();");
    assert_parsed("while (true) { continue; }", "while true {continue -;}");
    assert_parsed("do a(); while (b);", "do a(); while b");
    assert_parsed("for (;;) ;", "for ( | - | ) ;");
    assert_parsed("for (int i = 0; i < n; i++) a();", "for (int i=0; | (i < n) | (i++)) a();");
    assert_parsed(
        "for (int i = 0, j = n; i < j; i++, --j) { }",
        "for (int i=0 j=n; | (i < j) | (i++) (--j)) {}",
    );
    assert_parsed("for (i = 0, j = 1; ; i += 2) { }", "for ((i = 0); (j = 1); | - | (i += 2)) {}");
    assert_parsed("for (final Frame f : a.b()) c(f);", "for (Frame f : a.b()) c(f);");
    assert_parsed(
        "for (Map.Entry<A, B<C>> e : m.entrySet()) { }",
        "for (Map.Entry e : m.entrySet()) {}",
    );
    assert_parsed(
        "for (double[] q : new double[][] {{1}}) { }",
        "for (double[] q : new double[][] [] {{1}}) {}",
    );
    assert_parsed(
        "a: for (;;) { for (;;) { continue a; } }",
        "a: for ( | - | ) {for ( | - | ) {continue a;}}",
    );
}

#[test]
fn jumps_and_exceptions() {
    assert_parsed("return; return a + 1;", "return -; return (a + 1);");
    assert_parsed("throw new A(\"b\");", "throw new A(\"b\");");
    assert_parsed("try { a(); } catch (B b) { c(); }", "try () {a();} catch B b {c();} finally -");
    assert_parsed(
        "try { } catch (final B | c.D e) { } catch (F f) { } finally { g(); }",
        "try () {} catch B c.D e {} catch F f {} finally {g();}",
    );
    assert_parsed("try { } finally { }", "try () {}  finally {}");
    assert_parsed("try (A a = b(); C c = d()) { }", "try (A a=b(); C c=d();) {}  finally -");
    assert_parsed("try (a) { }", "try (a;) {}  finally -");
}
