//! Java semantics: each evaluated value is a joint target.

#![expect(clippy::unwrap_used, clippy::panic, reason = "a test fails by it")]

use iiwa_program::{Motion, Program};
use iiwa_sunrise::Project;
use iiwa_sunrise::{Import, ImportError, ImportOptions, RefusedImport};

/// Returns an application with these members and this body of `run`.
pub(crate) fn application(members: &str, run: &str) -> String {
    format!(
        "import static com.kuka.roboticsAPI.motionModel.BasicMotions.ptp;\n\
         public class Main extends RoboticsAPIApplication {{\n\
         @Inject private LBR lbr;\n{members}\npublic void run() {{\n{run}\n}}\n}}\n"
    )
}

fn import_all(files: &[(&str, &str)]) -> Result<Import, ImportError> {
    let project = Project::from_texts(files.iter().copied()).unwrap();
    iiwa_sunrise::import(&project, None, &ImportOptions::default())
}

pub(crate) fn import(members: &str, run: &str) -> Result<Import, ImportError> {
    import_all(&[("src/Main.java", &application(members, run))])
}

pub(crate) fn first_joints(program: &Program) -> Vec<f64> {
    let first = |motion: &Motion| match motion {
        Motion::Ptp(ptp) => Some(ptp.target_rad[0]),
        _ => None,
    };
    program.motions.iter().filter_map(first).collect()
}

/// Returns the A1 targets of all motions.
pub(crate) fn joint_targets(members: &str, run: &str) -> Vec<f64> {
    match import(members, run) {
        Ok(import) => first_joints(&import.program),
        Err(error) => panic!("{error}\n{run}"),
    }
}

pub(crate) fn refused_import(members: &str, run: &str) -> RefusedImport {
    match import(members, run) {
        Err(ImportError::Refused(refused_import)) => *refused_import,
        other => panic!("{other:?}"),
    }
}

/// Returns the value of an expression.
fn value(expression: &str) -> f64 {
    let run = format!("lbr.move(ptp({expression}, 0, 0, 0, 0, 0, 0));");
    joint_targets("", &run)[0]
}

#[test]
fn expressions_have_the_values_of_java() {
    let cases: [(&str, f64); 34] = [
        ("7 / 2 * 0.1", 3.0 * 0.1),
        ("7 / 2.0 * 0.1", 3.5 * 0.1),
        ("-7 / 2 * 0.1", -3.0 * 0.1),
        ("-7 % 3 * 0.1", -0.1),
        ("1 + 2 * 0.25", 1.5),
        ("(1 + 2) * 0.25", 0.75),
        ("0.1f", f64::from(0.1_f32)),
        ("1 / 3f", f64::from(1.0_f32 / 3.0)),
        ("(int) 2.9 * 0.5", 1.0),
        ("(int) -2.9 * 0.5", -1.0),
        ("(byte) 200 * 0.01", -56.0 * 0.01),
        ("(1 << 33) * 0.5", 1.0),
        ("(-8 >>> 29) * 0.1", 7.0 * 0.1),
        ("(-8 >> 1) * 0.1", -4.0 * 0.1),
        ("(6 & 3 | 8 ^ 1) * 0.1", f64::from(6 & 3 | 8 ^ 1) * 0.1),
        ("(Integer.MAX_VALUE + 1) * 1e-10", f64::from(i32::MIN) * 1e-10),
        ("Math.toRadians(90)", 90.0 / 180.0 * std::f64::consts::PI),
        ("Math.PI / 4", std::f64::consts::PI / 4.0),
        ("Math.max(1, 2) / 4 * 1.0", 0.0),
        ("Math.max(1, 2.0) / 4", 0.5),
        ("Math.round(2.5) * 0.1", 3.0 * 0.1),
        ("Math.round(-2.5) * 0.1", -2.0 * 0.1),
        ("Math.abs(-0.5)", 0.5),
        ("true ? 0.25 : 1", 0.25),
        ("'b' - 'a'", 1.0),
        ("\"12\".length() * 0.5", 1.0),
        ("Double.parseDouble(\"0.75\")", 0.75),
        ("Integer.parseInt(\"2\") * 0.5", 1.0),
        ("(\"a\" + 1.0).length() * 0.1", 4.0 * 0.1),
        ("(\"\" + 1e7).length() * 0.1", 5.0 * 0.1),
        ("String.format(\"%05.1f|%d\", 2.25, 3).length() * 0.1", 7.0 * 0.1),
        ("\"a,b,,\".split(\",\").length * 0.1", 2.0 * 0.1),
        ("new double[] {0.1, 0.2}[1]", 0.2),
        ("new int[3].length * 0.1", 3.0 * 0.1),
    ];
    for (expression, expected) in cases {
        let actual = value(expression);
        assert!((actual - expected).abs() < 1e-15, "{expression}: {actual}, not {expected}");
    }
}

pub(crate) const MOVE: &str = "lbr.move(ptp(a, 0, 0, 0, 0, 0, 0));";

#[test]
fn statements_behave_as_in_java() {
    let cases: [(&str, &[f64]); 13] = [
        ("for (int i = 0; i < 3; i++) { double a = i * 0.5; MOVE }", &[0.0, 0.5, 1.0]),
        ("for (double a : new double[] {0.25, 0.5}) { MOVE }", &[0.25, 0.5]),
        ("double a = 1; while (a > 0.3) { a /= 2; MOVE }", &[0.5, 0.25]),
        ("double a = 0; do { a += 0.5; MOVE } while (a < 1);", &[0.5, 1.0]),
        (
            "outer: for (int i = 0; i < 3; i++) { for (int j = 0; j < 3; j++) { \
             if (j == 2) continue outer; if (i == 1) break outer; double a = i + 0.1 * j; MOVE } }",
            &[0.0, 0.1],
        ),
        (
            "for (int i = 0; i < 4; i++) { double a = 0; switch (i) { case 0: a = 0.1; break; \
             case 1: a = 0.2; case 2: a += 0.3; break; default: a = 0.9; } MOVE }",
            &[0.1, 0.2 + 0.3, 0.3, 0.9],
        ),
        (
            "double a = 0.1; try { a = 0.2; int[] few = new int[1]; few[1] = 3; a = 0.3; } \
             catch (IndexOutOfBoundsException e) { a += 0.2; } finally { a += 0.1; } MOVE",
            &[0.2 + 0.2 + 0.1],
        ),
        ("int i = 0; double a = i++ + ++i * 0.1; MOVE", &[0.2]),
        ("int i = 7; i /= 2.0; double a = i * 0.1; MOVE", &[3.0 * 0.1]),
        ("double a = 0.1; { double b = 2; a *= b; } MOVE", &[0.2]),
        (
            "List<Double> all = new ArrayList<Double>(); all.add(0.5); all.add(0, 0.25); \
             all.remove(1); for (Double a : all) { MOVE }",
            &[0.25],
        ),
        (
            "Map<String, Double> by = new HashMap<>(); by.put(\"b\", 0.2); by.put(\"a\", 0.1); \
             by.put(\"b\", 0.3); for (Map.Entry<String, Double> entry : by.entrySet()) \
             { double a = entry.getValue(); MOVE }",
            &[0.1, 0.3],
        ),
        (
            "StringBuilder text = new StringBuilder(); for (int i = 0; i < 3; i++) text.append(i); \
             double a = text.toString().equals(\"012\") ? 0.5 : 0; MOVE",
            &[0.5],
        ),
    ];
    for (run, expected) in cases {
        let joints = joint_targets("", &run.replace("MOVE", MOVE));
        assert_eq!(joints.len(), expected.len(), "{run}: {joints:?}");
        for (actual, expected) in joints.iter().zip(expected) {
            assert!((actual - expected).abs() < 1e-15, "{run}: {actual}, not {expected}");
        }
    }
}

#[test]
fn objects_are_as_in_java() {
    let other = "
        public abstract class Base {
            static int made = 0;
            protected double angle = 0.1;
            Base() { made++; begin(); }
            void begin() { angle = 0.9; }
            abstract double next();
            static double twice(double a) { return 2 * a; }
        }";
    let derived = "
        public class Derived extends Base {
            private double own = 0.2;
            enum Side { LEFT(0.3), RIGHT(0.4) { double angle() { return 0.45; } };
                private final double angle;
                Side(double angle) { this.angle = angle; }
                double angle() { return angle; } }
            Derived() { super(); }
            Derived(double own) { this(); this.own += own; }
            @Override void begin() { own = 5; angle = 0.15; }
            double next() { return own + angle; }
            class Inner { double get() { return own; } }
            Inner inner() { return new Inner(); }
            static double sum(double... all) {
                double s = 0;
                for (double a : all) s += a;
                return s;
            }
        }";
    let main = application(
        "interface Angle { double get(); }",
        "lbr.move(ptp(new Derived().next(), 0, 0, 0, 0, 0, 0));\n\
         lbr.move(ptp(new Derived(0.1).next(), 0, 0, 0, 0, 0, 0));\n\
         lbr.move(ptp(Base.made * 0.1, 0, 0, 0, 0, 0, 0));\n\
         lbr.move(ptp(Derived.twice(0.2), 0, 0, 0, 0, 0, 0));\n\
         lbr.move(ptp(new Derived(0.3).inner().get(), 0, 0, 0, 0, 0, 0));\n\
         lbr.move(ptp(Derived.sum() + Derived.sum(0.1, 0.2), 0, 0, 0, 0, 0, 0));\n\
         for (Derived.Side side : Derived.Side.values()) lbr.move(ptp(side.angle(), 0, 0, 0, 0, 0, \
         0));\n\
         final double b = 0.6;\n\
         Angle angle = new Angle() { public double get() { return b; } };\n\
         lbr.move(ptp(angle.get(), 0, 0, 0, 0, 0, 0));",
    );
    let files = [("src/Base.java", other), ("src/Derived.java", derived), ("src/Main.java", &main)];
    let import = import_all(&files).unwrap();
    let expected = [0.35, 0.45, 0.2, 0.4, 0.5, 0.3, 0.3, 0.45, 0.6];
    let joints = first_joints(&import.program);
    assert_eq!(joints.len(), expected.len());
    for (actual, expected) in joints.iter().zip(expected) {
        assert!((actual - expected).abs() < 1e-12, "{actual}, not {expected}");
    }
}

#[test]
fn an_endless_loop_is_planned_for_one_turn() {
    let import = import(
        "",
        "int turn = 0; while (true) { double a = 0.5; MOVE turn++; }"
            .replace("MOVE", MOVE)
            .as_str(),
    )
    .unwrap();
    assert_eq!(first_joints(&import.program), [0.5]);
    assert!(import.notes.iter().any(|note| note.text.contains("one turn")), "{:?}", import.notes);
    // The loop ends by known values.
    let run = "int turn = 0; while (true) { double a = 0.1 * turn; MOVE if (++turn == 3) break; }";
    assert_eq!(joint_targets("", &run.replace("MOVE", MOVE)).len(), 3);
    // No state outside an iteration changes.
    let run = "boolean on = true; while (on) { double a = 0.1; MOVE } double a = 0.2; MOVE";
    assert_eq!(joint_targets("", &run.replace("MOVE", MOVE)), [0.1]);
}

#[test]
fn unknown_values_matter_only_for_motions() {
    // A branch that only computes and logs is skipped.
    let run = "long begin = System.currentTimeMillis(); double b = 0; if (begin > 5) \
        { b = 1; getLogger().info(\"\" + b); } double a = 0.5; MOVE getLogger().info(\"took \" + \
        (System.currentTimeMillis() - begin));";
    assert_eq!(joint_targets("", &run.replace("MOVE", MOVE)), [0.5]);
    // The values that the branch computes are unknown from then on.
    let run = "double a = 0;\nif (System.nanoTime() > 5) {\na = 1;\n}\nMOVE";
    let message = refused_import("", &run.replace("MOVE", MOVE));
    assert!(message.reason.contains("clock"), "{}", message.reason);
    assert_eq!(message.source.line, 10);
    // A branch in which the robot moves is refused, at the line of the branch.
    let run = "double a = 0.5; MOVE\nif (Math.random() > 0.5) {\nMOVE\n}";
    let message = refused_import("", &run.replace("MOVE", MOVE));
    assert!(message.reason.contains("random"), "{}", message.reason);
    assert_eq!(message.source.line, 7);
    assert_eq!(message.understood.motions.len(), 1);
}

#[test]
fn hostile_programs_are_refused() {
    let cases = [
        ("", "int i = 0; while (true) { i++; if (i < 0) break; }", "100 000 steps"),
        ("double f(double a) { return f(a); }", "double a = f(1); MOVE", "100"),
        ("", "double[] all = new double[2000000000]; double a = all[0]; MOVE", "too large"),
        (
            "",
            "String s = \"x\"; for (int i = 0; i < 64; i++) s = s + s; double a = s.length(); MOVE",
            "letters",
        ),
        ("", "double a = 1 / 0; MOVE", "by zero"),
        ("", "String s = null; double a = s.length(); MOVE", "null"),
        ("", "throw new IllegalStateException(\"no part\");", "no part"),
    ];
    for (members, run, reason) in cases {
        let message = refused_import(members, &run.replace("MOVE", MOVE));
        assert!(message.reason.contains(reason), "{run}: {}", message.reason);
    }
}

#[test]
fn classes_that_inherit_in_a_circle_are_refused() {
    let main = application("", "double a = new A().x; MOVE").replace("MOVE", MOVE);
    let files = [
        ("src/A.java", "class A extends B { double x; }"),
        ("src/B.java", "class B extends A { }"),
        ("src/Main.java", main.as_str()),
    ];
    match import_all(&files) {
        Err(ImportError::Refused(refused_import)) => {
            assert!(
                refused_import.reason.contains("inherits from itself"),
                "{}",
                refused_import.reason
            );
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_file_that_cannot_be_used_matters_where_it_is_needed() {
    let main = application("", "double a = 0.5; MOVE").replace("MOVE", MOVE);
    let broken = ("src/Broken.java", "class Broken { void f( {");
    assert!(import_all(&[("src/Main.java", &main), broken]).is_ok());
    let main = application("", "double a = new Broken().f(); MOVE").replace("MOVE", MOVE);
    match import_all(&[("src/Main.java", &main), broken]) {
        Err(ImportError::Refused(refused_import)) => {
            assert!(
                refused_import.reason.contains("src/Broken.java:1"),
                "{}",
                refused_import.reason
            );
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn copies_of_a_class_are_distinguished() {
    let base =
        |angle: &str| format!("package a; class Base {{ double angle() {{ return {angle}; }} }}");
    let main = application("", "double a = new a.Base().angle(); MOVE").replace("MOVE", MOVE);
    let (one, two) = (base("0.1"), base("0.2"));
    // The class next to the application has priority.
    let files = [
        ("old/src/a/Base.java", one.as_str()),
        ("src/a/Base.java", two.as_str()),
        ("src/Main.java", main.as_str()),
    ];
    let applications = import_all(&files).unwrap();
    assert_eq!((first_joints(&applications.program), applications.notes.len()), (vec![0.2], 0));
    // Otherwise the first class is used, with a note unless the classes are equal.
    let files = [files[0], ("new/src/a/Base.java", two.as_str()), files[2]];
    let applications = import_all(&files).unwrap();
    let text = applications.notes.iter().map(|note| note.text.as_str()).collect::<String>();
    assert!(text.contains("old/src/a/Base.java") && text.contains("new/src/a/Base.java"), "{text}");
    let files = [files[0], ("new/src/a/Base.java", one.as_str()), files[2]];
    assert!(import_all(&files).unwrap().notes.is_empty());
    // Applications are selected by their file.
    let files = [("one/Main.java", main.as_str()), ("two/Main.java", main.as_str()), files[0]];
    let project = Project::from_texts(files).unwrap();
    let import = |name| iiwa_sunrise::import(&project, Some(name), &ImportOptions::default());
    let error = import("Main").unwrap_err().to_string();
    assert!(error.contains("one/Main.java, two/Main.java"), "{error}");
    assert_eq!(import("two/Main.java").unwrap().application.file, "two/Main.java");
}
