//! Lambda expressions, method references and listeners in applications: each evaluated value is a
//! joint target.

use crate::evaluation::{import, joint_targets, refused_import};

/// Expands `MOVE(x)` in the cases.
fn with_moves(java: &str) -> String {
    java.replace("MOVE(", "lbr.move(to(").replace(")!", "))")
}

const TO: &str =
    "PTP to(double a) { return ptp(a, 0, 0, 0, 0, 0, 0); } void back() { lbr.move(to(-0.5)); }\n";

#[test]
fn functions_move_the_arm_where_they_are_run() {
    let cases: [(&str, &str, &[f64]); 17] = [
        ("", "Arrays.asList(0.1, 0.2).forEach(a -> MOVE(a)!);", &[0.1, 0.2]),
        ("", "Runnable r = () -> MOVE(0.1)!; MOVE(0.2)!; r.run();", &[0.2, 0.1]),
        (
            "",
            "List<Runnable> l = new ArrayList<>(); l.add(() -> MOVE(0.1)!); l.add(this::back); for \
             (Runnable r : l) r.run();",
            &[0.1, -0.5],
        ),
        ("", "Function<Double, PTP> f = this::to; lbr.move(f.apply(0.3));", &[0.3]),
        ("", "Consumer<PTP> go = lbr::move; go.accept(to(0.4));", &[0.4]),
        (
            "",
            "Supplier<JointPosition> s = () -> new JointPosition(0.6, 0, 0, 0, 0, 0, 0); \
             lbr.move(ptp(s.get()));",
            &[0.6],
        ),
        (
            "",
            "IntStream.range(1, 4).filter(i -> i != 2).forEach(i -> MOVE(i * 0.5)!);",
            &[0.5, 1.5],
        ),
        (
            "",
            "List<Double> l = new ArrayList<>(Arrays.asList(0.3, 0.1, 0.2)); \
             l.sort(Comparator.reverseOrder()); l.forEach(a -> MOVE(a)!);",
            &[0.3, 0.2, 0.1],
        ),
        (
            "",
            "Map<String, Runnable> m = new LinkedHashMap<>(); m.put(\"a\", () -> MOVE(0.1)!); \
             m.put(\"b\", () -> MOVE(0.2)!); m.get(\"b\").run(); \
             m.values().forEach(Runnable::run);",
            &[0.2, 0.1, 0.2],
        ),
        (
            "interface Step { void go(double a); default void twice(double a) { go(a); go(-a); } }",
            "Step s = a -> MOVE(a)!; s.twice(0.2);",
            &[0.2, -0.2],
        ),
        (
            "abstract class Step { abstract double at(); void go() { MOVE(at())!; } }",
            "new Step() { double at() { return 0.7; } }.go();",
            &[0.7],
        ),
        (
            "double x = 0.1;",
            "try { Runnable r = () -> { x = 0.2; throw new IllegalStateException(); }; r.run(); } \
             catch (IllegalStateException e) { MOVE(x)!; }",
            &[0.2],
        ),
        (
            "void f(Object a) { MOVE(0.1)!; } void f(String a) { MOVE(0.2)!; }",
            "Map<Integer, String> m = new HashMap<>(); m.put(1, \"a\"); f(m.get(1)); for (var e : \
             m.entrySet()) f(e.getKey());",
            &[0.2, 0.1],
        ),
        (
            "",
            "Object o = 0.3; if (o instanceof Double d && d > 0) MOVE(d)!;\n\
             MOVE(switch (o) \
             { case Integer i -> 0.1; case Double d when d > 1 -> 0.2; default -> 0.4; })!;",
            &[0.3, 0.4],
        ),
        (
            "",
            "getApplicationUI().createUserKeyBar(\"a\").addUserKey(0, (key, event) -> MOVE(0.9)!, \
             true); MOVE(0.1)!;",
            &[0.1],
        ),
        (
            "double y = 0;",
            "Supplier<Double> s = () -> 0.1; Runnable r = () -> MOVE(0.3)!; if (System.nanoTime() \
             > 5) y = s.get(); r.run();",
            &[0.3],
        ),
        ("", "new Thread(() -> System.out.println(\"a\")).start(); MOVE(0.1)!;", &[0.1]),
    ];
    for (members, run, expected) in cases {
        let members = format!("{TO}{}", with_moves(members));
        assert_eq!(joint_targets(&members, &with_moves(run)), expected, "{run}");
    }
}

#[test]
fn functions_that_may_be_run_are_not_passed_over() {
    let cases = [
        (
            "Runnable r = () -> MOVE(0.1)!; if (System.nanoTime() > 5) r.run();",
            "this branch, in which the arm moves",
        ),
        (
            "if (System.nanoTime() > 5) { Runnable r = () -> MOVE(0.1)!; r.run(); }",
            "this branch, in which the arm moves",
        ),
        (
            "Runnable r = this::back; if (System.nanoTime() > 5) r.run();",
            "this branch, in which the arm moves",
        ),
        (
            "if (System.nanoTime() > 5) new Runnable() \
             { public void run() { MOVE(0.1)!; } }.run();",
            "this branch, in which the arm moves",
        ),
        ("new Thread(() -> MOVE(0.1)!).start();", "a thread is started"),
        (
            "new Camera().onImage(() -> MOVE(0.1)!);",
            "`onImage` may run a lambda expression, in which the arm moves",
        ),
        (
            "new Camera().onImage(this::back);",
            "`onImage` may run a method reference, in which the arm moves",
        ),
        (
            "List<Double> l = new ArrayList<>(Arrays.asList(0.3, 0.1)); l.sort((a, b) -> \
             { MOVE(a)!; return 0; });",
            "the order of comparisons, in which the arm moves",
        ),
        ("new Thread(() -> x = 0.3).start(); MOVE(x)!;", "what a thread does"),
        ("new Camera(() -> x = 0.3); MOVE(x)!;", "a `Camera`, of a library without source"),
        ("new Camera(this::back);", "`Camera` may run a method reference, in which the arm moves"),
        ("new Camera().listener = () -> x = 0.3; MOVE(x)!;", "a field of a library without source"),
        (
            "new Camera().onImage(() -> x = 0.3); MOVE(x)!;",
            "a `Camera`, of a library without source",
        ),
        (
            "List<Double> l = new ArrayList<>(Arrays.asList(0.3, 0.1)); l.forEach(a -> l.add(a)); \
             MOVE(l.get(0))!;",
            "is changed while",
        ),
    ];
    let members = with_moves(&format!("{TO}double x = 0.1;"));
    for (run, reason) in cases {
        let message = refused_import(&members, &with_moves(&format!("MOVE(0.1)!; {run}")));
        assert!(message.reason.contains(reason), "{run}: {}", message.reason);
    }
    let harmless = with_moves("new Camera().onImage(() -> System.out.println(x)); MOVE(x)!;");
    assert!(import(&members, &harmless).is_ok());
}
