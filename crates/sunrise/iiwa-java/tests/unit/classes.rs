//! Files, classes and their members.

use super::{shown, unit};

#[track_caller]
fn assert_parsed(written: &str, expected: &str) {
    let shown: Vec<String> =
        unit(written).classes.iter().map(|class| shown::class(class)).collect();
    assert_eq!(shown.join(" "), expected, "{written}");
}

#[test]
fn heads_of_files() {
    let read = unit(
        "package a.b;\nimport c.D;\nimport e.f.*;\nimport static g.H.i;\nimport static j.K.*;\n",
    );
    assert_eq!(read.package, "a.b");
    let imports = read.imports.iter().map(|i| (i.path.as_str(), i.is_static, i.is_all));
    let expected =
        [("c.D", false, false), ("e.f", false, true), ("g.H.i", true, false), ("j.K", true, true)];
    assert_eq!(imports.collect::<Vec<_>>(), expected);
    assert!(read.classes.is_empty());
}

#[test]
fn files_without_a_type() {
    for text in [
        "",
        "\n",
        "// nothing",
        "/* nothing */",
        "package a;",
        ";",
        "@interface A { }",
        "module a.b { requires c; }",
        "\u{1a}",
    ] {
        assert!(unit(text).classes.is_empty(), "{text:?}");
    }
}

#[test]
fn kinds_of_classes() {
    assert_parsed("class A { }", "<class A extends - implements []>");
    assert_parsed(
        "public final class A<T extends B<T>> extends c.D<E> implements F, G<H> { }",
        "<class A extends c.D implements [F G]>",
    );
    assert_parsed("abstract class A { }", "<abstract class A extends - implements []>");
    assert_parsed(
        "@Tag interface A extends B, C \
         { int D = 1; void e(); default int f() { return 1; } static void g() { } class H { } }",
        "<abstract interface A extends - implements [B C], static int D=1, void e() -, int f() \
         {return 1;}, static void g() {}, <class H extends - implements []>>",
    );
    assert_parsed(
        "enum A implements B \
            { C, D(1) { int e() { return 2; } }, ; \
              int f; A() { } A(int f) { this.f = f; } int e() { return 1; } }",
        "<enum A extends - implements [B], C(), D(1)<class  extends A implements [], int e() \
         {return 2;}>, int f=-, int e() {return 1;}, new void A() {}, new void A(int f) \
         {(this.f = f);}>",
    );
    assert_parsed(
        "class A { } class B { } interface C { } enum D { }",
        "<class A extends - implements []> <class B extends - implements []> \
         <abstract interface C extends - implements []> <enum D extends - implements []>",
    );
}

#[test]
fn members() {
    assert_parsed(
        "class A { private int a; \
            static final double[] B = {1, 2}, C[] = null; \
            { a = 1; } static { b(); } }",
        "<class A extends - implements [], int a=-, static double[] B={1 2}, static double[][] \
         C=null, {(a = 1);}, static {b();}>",
    );
    assert_parsed(
        "class A { @Inject @Named(\"Gripper\") private Tool t; \
            @a.Named(value = \"x\") Tool u; \
            @Tag(1) @Tags({\"a\"}) int v; }",
        "<class A extends - implements [], @Inject=- @Named=Gripper Tool t=-, @Named=x Tool u=-, \
         @Tag=- @Tags=- int v=->",
    );
    assert_parsed(
        "class A { @Override public void a() throws B, C { } \
            protected static <T> T[] b(final int c, T... d) { return d; } \
            abstract int e(); native void f(); int g()[] { return h; } }",
        "<class A extends - implements [], @Override void a() {}, static T[] b(int c T[] d...) \
         {return d;}, int e() -, void f() -, int[] g() {return h;}>",
    );
    assert_parsed(
        "class A { A() { super(1, b); c(); } A(int d[]) { this(); } \
            <T> A(T e) { f.super(); } A(A this, int g) { } }",
        "<class A extends - implements [], new void A() {super(1 b); c();}, new void A(int[] d) \
         {this();}, new void A(T e) {<a `super(...)` of an outer object>;}, new void A(int g) {}>",
    );
    assert_parsed(
        "class A { class B { static class C { } } enum D { E } interface F { } \
            record G(int h) { } @interface I { } ; }",
        "<class A extends - implements [], <class B extends - implements [], <class C extends - \
         implements []>>, <enum D extends - implements [], E()>, <abstract interface F extends - \
         implements []>, <record G extends - implements [], int h=-, int h() {return this.h;}, new \
         void G(int h) {(this.h = h);}>>",
    );
}

#[test]
fn records() {
    assert_parsed(
        "record A<T>(int b, T... c) implements D \
         { static int E = 1; A { f(); } public int b() { return 2; } }",
        "<record A extends - implements [D], int b=-, T[] c=-, static int E=1, int b() \
         {return 2;}, T[] c() {return this.c;}, new void A(int b T[] c...) \
         {f(); (this.b = b); (this.c = c);}>",
    );
    assert_parsed(
        "record A(int b) { A(int c) { this.b = c; } A() { this(1); } }",
        "<record A extends - implements [], int b=-, int b() {return this.b;}, new void A(int c) \
         {(this.b = c);}, new void A() {this(1);}>",
    );
}
