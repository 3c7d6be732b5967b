//! Values of Java snippets, compared with those that a JVM computes; see `tests/java/expected.py`.
//!
//! A value may be unknown, or its evaluation refused, but never differ from the JVM's.

use std::{fmt::Write as _, rc::Rc, thread};

use crate::{
    Classes, EvaluationStop, Host, HostCounts, HostValue, Machine, SourceLine, Value, read,
    value::JavaObject,
};

/// Minimum number of snippets with a known value: most of them.
const MIN_KNOWN: usize = 1540;

const FILES: [(&str, &str); 14] = [
    ("arrays", include_str!("../../../../../tests/java/snippets/arrays.txt")),
    ("classes", include_str!("../../../../../tests/java/snippets/classes.txt")),
    ("collections", include_str!("../../../../../tests/java/snippets/collections.txt")),
    ("control", include_str!("../../../../../tests/java/snippets/control.txt")),
    ("floating", include_str!("../../../../../tests/java/snippets/floating.txt")),
    ("functions", include_str!("../../../../../tests/java/snippets/functions.txt")),
    ("generics", include_str!("../../../../../tests/java/snippets/generics.txt")),
    ("integers", include_str!("../../../../../tests/java/snippets/integers.txt")),
    ("logic", include_str!("../../../../../tests/java/snippets/logic.txt")),
    ("mixed", include_str!("../../../../../tests/java/snippets/mixed.txt")),
    ("newer", include_str!("../../../../../tests/java/snippets/newer.txt")),
    ("old_texts", include_str!("../../../../../tests/java/snippets/old_texts.txt")),
    ("streams", include_str!("../../../../../tests/java/snippets/streams.txt")),
    ("strings", include_str!("../../../../../tests/java/snippets/strings.txt")),
];

/// Host without classes.
struct NoHost;

impl Host for NoHost {
    fn acting(&self) -> &'static [&'static str] {
        &["move"]
    }

    fn acting_on_receivers(&self) -> &'static [&'static str] {
        &[]
    }

    fn acts(&self) -> &'static str {
        "the arm moves"
    }

    fn pausing(&self) -> &'static [&'static str] {
        &[]
    }

    fn progress(&self) -> HostCounts {
        HostCounts::default()
    }

    fn suppose(&self, _: usize, _: Option<bool>) -> bool {
        false
    }

    fn settle(&self) {}

    fn answers_since(&self, _: usize) -> Option<String> {
        None
    }

    fn endless(&self, _: &Machine, _: usize) {}

    fn call(
        &self,
        machine: &mut Machine,
        _: &Rc<dyn HostValue>,
        name: &str,
        _: &[Value],
    ) -> Result<Value, EvaluationStop> {
        Ok(machine.unknown(name))
    }

    fn field(
        &self,
        machine: &mut Machine,
        _: &Rc<dyn HostValue>,
        name: &str,
    ) -> Result<Value, EvaluationStop> {
        Ok(machine.unknown(name))
    }

    fn call_static(
        &self,
        _: &mut Machine,
        _: &str,
        _: &str,
        _: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        Ok(None)
    }

    fn construct(
        &self,
        _: &mut Machine,
        _: &str,
        _: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        Ok(None)
    }

    fn constant(&self, _: &mut Machine, _: &str, _: &str) -> Result<Option<Value>, EvaluationStop> {
        Ok(None)
    }

    fn injected(
        &self,
        _: &mut Machine,
        _: &str,
        _: Option<&str>,
        _: &str,
    ) -> Result<Option<Value>, EvaluationStop> {
        Ok(None)
    }

    fn inherited(
        &self,
        _: &mut Machine,
        _: &Rc<JavaObject>,
        _: &str,
        _: &str,
        _: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        Ok(None)
    }

    fn constructed(
        &self,
        _: &mut Machine,
        _: &Rc<JavaObject>,
        _: &str,
        _: &[Value],
    ) -> Result<(), EvaluationStop> {
        Ok(())
    }

    fn text(&self, _: &Rc<dyn HostValue>) -> String {
        String::new()
    }
}

/// Returns the class around a snippet, as `expected.py` writes it.
fn source(lines: &[&str]) -> String {
    let separator = lines.iter().position(|line| *line == "--");
    let (members, lines) = match separator {
        Some(separator) => (&lines[..separator], &lines[separator + 1..]),
        None => (&[][..], lines),
    };
    let body = match lines {
        [line] if !line.ends_with([';', '}']) => format!("return {line};"),
        _ => lines.join("\n"),
    };
    let members = members.join("\n");
    format!(
        "import java.util.*;\nclass S {{\n{members}\nstatic Object run() throws Exception \
         {{\n{body}\n}} }}"
    )
}

/// Returns the value in the format of `expected.py`; the error is the reason why it is unknown.
fn evaluated(source: &str) -> Result<String, String> {
    let unit = read("S.java", source).map_err(|error| format!("not read: {error}"))?;
    let mut classes = Classes::default();
    classes.add("S.java", &unit);
    let id = classes.by_qualified_name("S").ok_or("no class")?;
    let place = SourceLine { file: Rc::from("S.java"), line: 1 };
    let mut machine = Machine::new(classes, Rc::new(NoHost), place);
    let (owner, method) = machine.plain_method(id, "run").ok_or("no method")?;
    let value = match machine.run(owner, None, &method, &[]) {
        Ok(value) => value,
        Err(EvaluationStop::Thrown(thrown)) => {
            let class = match &thrown.value {
                Value::Object(object) => {
                    machine.java.classes.known(object.class).class.name.clone()
                }
                _ => thrown.classes.first().map_or(String::new(), ToString::to_string),
            };
            return Ok(format!("throws {class}"));
        }
        Err(EvaluationStop::Refused(refusal)) => {
            return Err(format!("refused: {}", refusal.reason));
        }
        Err(EvaluationStop::Ended) => return Err("refused: a loop without an end".to_owned()),
    };
    let kind = match &value {
        Value::Unknown(unknown) => return Err(format!("unknown: {}", unknown.reason)),
        Value::Null => return Ok("null".to_owned()),
        Value::Char(code) => return Ok(format!("char {code}")),
        Value::Boolean(_) => "boolean",
        Value::Int(_) => "int",
        Value::Long(_) => "long",
        Value::Float(_) => "float",
        Value::Double(_) => "double",
        Value::Text(_) => "String",
        _ => "object",
    };
    match machine.text_of(&value) {
        Ok(Ok(text)) => Ok(format!("{kind} {}", quoted(&text))),
        Ok(Err(unknown)) => Err(format!("unknown: {}", unknown.reason)),
        Err(_) => Err("refused: its text".to_owned()),
    }
}

fn quoted(text: &str) -> String {
    let mut quoted = String::new();
    for unit in text.encode_utf16() {
        match u8::try_from(unit) {
            Ok(b'\\') => quoted.push_str("\\\\"),
            Ok(b'\n') => quoted.push_str("\\n"),
            Ok(byte @ b' '..=b'~') => quoted.push(char::from(byte)),
            _ => _ = write!(quoted, "\\u{unit:04x}"),
        }
    }
    quoted
}

/// Returns the differences, and the numbers of snippets with equal, unknown and refused values.
fn compared(files: &[(&str, &str)]) -> (Vec<String>, [usize; 3]) {
    let mut differences = Vec::new();
    let mut counts = [0; 3];
    for (file, text) in files {
        // The first block describes the file.
        for block in text.trim_end().split("\n\n").skip(1) {
            let mut lines: Vec<&str> = block.lines().collect();
            let expected = lines.pop().and_then(|value| value.strip_prefix("=> ")).expect(block);
            // The evaluator represents these types by `int`.
            let same_type = expected.replacen("byte ", "int ", 1).replacen("short ", "int ", 1);
            match evaluated(&source(&lines)) {
                Ok(value) if value == expected || value == same_type => counts[0] += 1,
                Ok(value) => differences.push(format!(
                    "{file}:\n{}\n  {value}, and a JVM has {expected}",
                    lines.join("\n")
                )),
                Err(reason) => {
                    let is_unknown = reason.starts_with("unknown");
                    counts[if is_unknown { 1 } else { 2 }] += 1;
                    if std::env::var_os("IIWASIM_SHOW").is_some() {
                        println!("{file}: {}\n  {reason} ({expected})", lines.join("\n"));
                    }
                }
            }
        }
    }
    (differences, counts)
}

/// Compares on a thread with a stack of 64 MiB.
fn compared_aside(files: &'static [(&str, &str)]) -> (Vec<String>, [usize; 3]) {
    let machine = thread::Builder::new().stack_size(64 << 20);
    machine.spawn(|| compared(files)).expect("a thread").join().expect("values")
}

#[test]
fn are_those_of_a_jvm() {
    let (differences, [equal, unknown, refused]) = compared_aside(&FILES);
    println!("{equal} equal, {unknown} unknown, {refused} refused");
    assert!(differences.is_empty(), "{} differ:\n{}", differences.len(), differences.join("\n"));
    assert!(equal >= MIN_KNOWN, "{equal} are known");
}

#[test]
fn in_which_a_lambda_expression_acts_or_assigns() {
    let value = |lines: &[&str]| evaluated(&source(lines)).unwrap_or_else(|reason| reason);
    // A library or an undecided branch may run the lambda at any time.
    let acts = ["Runnable r = () -> arm.move();", "new Library().add(r);", "return 1;"];
    let expected =
        "refused: `add` may run a lambda expression, in which the arm moves, and is not evaluated";
    assert_eq!(value(&acts), expected);
    let members = ["static int n = 1;", "static List<Runnable> l = new ArrayList<>();", "--"];
    let with = |lines: &[&'static str]| [&members[..], lines].concat();
    let assigns = with(&["new Library().add(() -> n = 2);", "return n;"]);
    assert_eq!(value(&assigns), "unknown: a `Library`, of a library without source");
    let unaffected = with(&["new Library().add(() -> l.size());", "return n;"]);
    assert_eq!(value(&unaffected), "int 1");
    let branch = with(&[
        "l.add(() -> arm.move());",
        "if (System.nanoTime() > 1) l.get(0).run();",
        "return n;",
    ]);
    let expected = "refused: whether this branch, in which the arm moves, is taken depends on the \
        controller's clock";
    assert_eq!(value(&branch), expected);
    let branch =
        with(&["l.add(() -> n = 2);", "if (System.nanoTime() > 1) l.get(0).run();", "return n;"]);
    assert_eq!(value(&branch), "unknown: the controller's clock");
    let anonymous = with(&[
        "if (System.nanoTime() > 1) \
         { Runnable r = new Runnable() { public void run() { arm.move(); } }; r.run(); }",
        "return n;",
    ]);
    assert_eq!(value(&anonymous), expected);
}

#[test]
fn with_a_call_whose_types_do_not_decide_the_method() {
    let members = |second: &'static str| {
        vec![
            "static int n = 1;",
            "static void f(Object o) { n = 2; }",
            second,
            "static <T> T last(T a, T b) { return b; }",
            "--",
            "f(last(\"a\", \"b\"));",
            "return n;",
        ]
    };
    let sets = evaluated(&source(&members("static void f(String s) { n = 3; }")));
    let types = "the types of the arguments of `f`, which are not known";
    assert_eq!(sets, Err(format!("unknown: {types}")));
    let acts = evaluated(&source(&members("static void f(String s) { arm.move(); }")));
    let expected = format!("refused: which of the methods `f` is called depends on {types}");
    assert_eq!(acts, Err(expected));
}

/// Java after 17, which the JVM of `expected.py` may not support.
#[test]
fn with_patterns_of_switches() {
    let members = [
        "sealed interface Shape permits Circle, Rect { }",
        "record Circle(double r) implements Shape { }",
        "record Rect(Point a, Point b) implements Shape { }",
        "record Point(int x, int y) { }",
        "record Box(Object o) { }",
        "enum E { A, B }",
        "static int n = 0;",
        "static String f(Object o) {",
        "  return switch (o) {",
        "    case null -> \"null\";",
        "    case Integer i when i > 10 -> \"big\" + i;",
        "    case Integer i -> \"int\" + i;",
        "    case String s when s.isEmpty() -> \"empty\";",
        "    case Circle(double r) -> \"circle\" + r;",
        "    case Rect(Point(int x, var y), Point b) when b.x() > x -> \"rect\" + x + y + b;",
        "    case Rect r -> \"other\" + r.a().x();",
        "    case Box(String s) -> \"box\" + s;",
        "    case Box(var o2) -> \"any\" + o2;",
        "    case E e when e == E.A -> \"A\";",
        "    case int[] a -> \"ints\" + a.length;",
        "    default -> \"default\";",
        "  };",
        "}",
        "--",
    ];
    let cases = [
        ("f(null)", "String null"),
        ("f(11)", "String big11"),
        ("f(3)", "String int3"),
        ("f(\"\")", "String empty"),
        ("f(\"a\")", "String default"),
        ("f(new Circle(2))", "String circle2.0"),
        ("f(new Rect(new Point(1, 2), new Point(3, 4)))", "String rect12Point[x=3, y=4]"),
        ("f(new Rect(new Point(9, 2), new Point(3, 4)))", "String other9"),
        ("f(new Box(\"es\"))", "String boxes"),
        ("f(new Box(null))", "String anynull"),
        ("f(new Box(1))", "String any1"),
        ("f(E.A) + f(E.B)", "String Adefault"),
        ("f(new int[3])", "String ints3"),
        ("new Box(new Point(1, 2)) instanceof Box(Point(int x, int y)) ? x + y : 0", "int 3"),
        ("new Box(7) instanceof Box(Point(int x, int y)) ? x + y : 0", "int 0"),
    ];
    for (value, expected) in cases {
        let returned = format!("return {value};");
        let lines = [&members[..], &[&*returned]].concat();
        assert_eq!(evaluated(&source(&lines)), Ok(expected.to_owned()), "{value}");
    }
    let unknown = [
        "Object o = 1;",
        "switch (o) { case Integer i when System.nanoTime() > i -> n = 1; default -> n = 2; }",
        "return n;",
    ];
    let lines = [&members[..], &unknown[..]].concat();
    assert_eq!(evaluated(&source(&lines)), Err("unknown: the controller's clock".to_owned()));
    let thrown = ["Object o = null;", "switch (o) { case String s -> n = 1; default -> n = 2; }"];
    let lines = [&members[..], &thrown[..], &["return n;"]].concat();
    assert_eq!(evaluated(&source(&lines)), Ok("throws NullPointerException".to_owned()));
}

#[test]
fn with_functions_that_would_fill_time_or_stack() {
    let cases = [
        (
            "IntUnaryOperator f = x -> x + 1; for (int i = 0; i < 40; i++) f = f.andThen(f); \
             return f.applyAsInt(0);",
            "steps",
        ),
        (
            "Function<Integer, Integer> f = Function.identity(); for (int i = 0; i < 40; i++) f = \
             f.andThen(f); return f.apply(0);",
            "steps",
        ),
        (
            "UnaryOperator<Integer> f = x -> x; for (int i = 0; i < 2000; i++) f = f.andThen(x -> \
             x + 1); return f.apply(0);",
            "levels of functions",
        ),
        (
            "Runnable[] r = new Runnable[1]; r[0] = () -> r[0].run(); r[0].run(); return 1;",
            "100 calls deep",
        ),
        ("return IntStream.range(0, 2000000).count();", "a million elements"),
        ("return IntStream.range(0, 900000).map(Math::abs).sum();", "steps"),
    ];
    let run = move || {
        for (body, reason) in cases {
            let result = evaluated(&source(&[body]));
            assert!(
                result.as_ref().is_err_and(|message| message.contains(reason)),
                "{body}: {result:?}"
            );
        }
    };
    let machine = thread::Builder::new().stack_size(64 << 20);
    machine.spawn(run).expect("a thread").join().expect("values");
}
