//! Inputs and outputs: import of Java code, and round trips.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::Robot;
use iiwa_program::{IoEntry, IoValue, Motion, MotionIndex, MotionLabel, Program};
use iiwa_sunrise::{
    ExportError, ExportOptions, ExportedProject, Import, ImportOptions, Project, import,
};

const HEAD: &str = r#"{ "version": 1, "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },"#;
const PTP: &str = r#"{ "type": "ptp", "joints_deg": [40, 30, 0, -60, 0, 90, 0] }"#;
const BACK: &str = r#"{ "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0] }"#;

fn program(motions: &[&str]) -> Program {
    Program::from_json(&format!(r#"{HEAD} "motions": [{}] }}"#, motions.join(", "))).unwrap()
}

fn exported(program: &Program) -> Result<ExportedProject, ExportError> {
    let options = ExportOptions { name: "pick".to_owned(), ..ExportOptions::default() };
    ExportedProject::new(program, &Robot::default(), &options)
}

fn round_trip(program: &Program) -> (Program, String) {
    let project = exported(program).unwrap();
    let java = project.java_file();
    let files = [(java.as_str(), &project.java), (ExportedProject::DATA_FILE, &project.data_file)];
    let again = Project::from_texts(files).unwrap();
    (import(&again, None, &ImportOptions::default()).unwrap().program, project.java)
}

/// Imports an application with a group `Gripper` as `io` and the statements `run`.
fn imported(run: &str) -> Import {
    let java = format!(
        "package application;\n\
         import com.kuka.roboticsAPI.applicationModel.RoboticsAPIApplication;\n\
         import com.kuka.roboticsAPI.deviceModel.LBR;\n\
         import com.kuka.generated.ioAccess.GripperIOGroup;\n\
         import static com.kuka.roboticsAPI.motionModel.BasicMotions.*;\n\
         import javax.inject.Inject;\n\
         public class Pick extends RoboticsAPIApplication {{\n\
         @Inject private LBR lbr;\n@Inject private GripperIOGroup io;\n\
         public void run() {{\n{run}\n}} }}\n"
    );
    let project = Project::from_texts([("src/application/Pick.java", &java)]).unwrap();
    import(&project, None, &ImportOptions::default()).unwrap()
}

fn signals(import: &Import) -> Vec<IoEntry> {
    import.program.motions.iter().filter_map(Motion::io).cloned().collect()
}

const MOVE: &str = "lbr.move(ptp(0.5, 0, 0, -1, 0, 1, 0));";
const MOVE_BACK: &str = "lbr.move(ptp(0, 0, 0, -1, 0, 1, 0));";

#[test]
fn a_program_comes_back() {
    let closed =
        r#"{ "type": "wait_for", "io": "Gripper.Closed", "value": true, "seconds": 0.35 }"#;
    let opened = closed.replace("true", "false").replace("0.35", "0.123456789");
    let mut program = program(&[
        r#"{ "type": "set", "io": "Lamp.Colour", "value": 3 }"#,
        PTP,
        r#"{ "type": "set", "io": "Gripper.Close", "value": true, "name": "close" }"#,
        closed,
        r#"{ "type": "set", "io": "Belt.Speed", "value": -0.5 }"#,
        BACK,
        r#"{ "type": "set", "io": "Gripper.Close", "value": false }"#,
        &opened,
        closed,
    ]);
    for motion in &mut program.motions {
        if let Motion::Ptp(ptp) = motion {
            ptp.blocking = true;
        }
    }
    let (again, java) = round_trip(&program);
    assert_eq!(again.motions, program.motions, "{java}");
    assert!(java.contains("import com.kuka.generated.ioAccess.GripperIOGroup;"), "{java}");
    assert!(java.contains("    @Inject\n    private GripperIOGroup ioGripper;"), "{java}");
    assert!(
        java.contains("        // iiwasim name: close\n        ioGripper.setClose(true);"),
        "{java}"
    );
    assert!(java.contains("while (!ioGripper.getClosed()) { // iiwasim: 0.35 s"), "{java}");
    assert!(java.contains("while (ioGripper.getClosed()) { // iiwasim: 0.123456789 s"), "{java}");
    assert!(java.contains("ioLamp.setColour(3);") && java.contains("ioBelt.setSpeed(-0.5);"));
}

#[test]
fn overlapping_entries_come_back() {
    let blended = PTP.replace(" }", r#", "blend": { "cart_mm": 20 } }"#);
    let program = program(&[
        &blended,
        r#"{ "type": "set", "io": "Gripper.Close", "value": true, "overlap": true }"#,
        r#"{ "type": "wait_for", "io": "Gripper.Closed", "value": true, "seconds": 0.01,
             "overlap": true }"#,
        &BACK.replace(" }", r#", "blocking": true }"#),
    ]);
    let (again, java) = round_trip(&program);
    assert_eq!(again.motions, program.motions, "{java}");
}

#[test]
fn names_and_values_without_a_java_equivalent_are_refused() {
    for (motion, expected) in [
        (r#"{ "type": "set", "io": "Close", "value": true }"#, "motion 1: `io`: name the group"),
        (r#"{ "type": "set", "io": "A.B.C", "value": true }"#, "motion 1: `io`: group and signal"),
        (r#"{ "type": "set", "io": "1A.B", "value": true }"#, "motion 1: `io`: group and signal"),
        (
            r#"{ "type": "wait_for", "io": "A.B", "value": 3, "seconds": 1 }"#,
            "motion 1: `value`: a wait for a number is not exported",
        ),
    ] {
        let error = exported(&program(&[motion])).unwrap_err().to_string();
        assert!(error.starts_with(expected), "{error}");
    }
}

#[test]
fn setters_become_entries_that_do_not_change_the_time() {
    let run = format!("{MOVE}\nio.setClose(true);\n{MOVE_BACK}\nio.setPower(7);");
    let import = imported(&run);
    let close = IoEntry::set("Gripper.Close", IoValue::Boolean(true));
    assert_eq!(signals(&import), [close, IoEntry::set("Gripper.Power", IoValue::Digital(7))]);
    assert!(matches!(import.program.motions[1], Motion::Io(_)));
    let plain = imported(&format!("{MOVE}\n{MOVE_BACK}"));
    let motions = import.program.motions.into_iter().filter(|motion| motion.io().is_none());
    assert_eq!(motions.collect::<Vec<_>>(), plain.program.motions);
}

#[test]
fn loops_that_wait_for_an_input_become_waits() {
    let wait = |condition: &str, time: &str| {
        format!("while ({condition}) {{ {time}\nThread.sleep(10);\n}}\n")
    };
    let run = wait("!io.getClosed()", "// iiwasim: 0.3 s") + MOVE + &wait("io.getClosed()", "");
    let import = imported(&run);
    let [closed, opened] = [(true, 0.3), (false, 0.0)]
        .map(|(value, s)| IoEntry::wait_for("Gripper.Closed", IoValue::Boolean(value), s));
    assert_eq!(signals(&import), [closed, opened]);
}

#[test]
fn waits_of_an_observer_for_an_input_become_waits() {
    let condition = "new BooleanIOCondition(io.getInput(\"Closed\"), true)";
    let run = format!(
        "{MOVE}\ngetObserverManager().waitFor({condition}); // iiwasim: 0.25 s\n\
         getObserverManager().waitFor({condition}.invert());\n\
         getObserverManager().waitFor({condition}.and({condition})); // iiwasim: 1 s"
    );
    let import = imported(&run);
    let [closed, opened] = [(true, 0.25), (false, 0.0)]
        .map(|(value, s)| IoEntry::wait_for("Gripper.Closed", IoValue::Boolean(value), s));
    assert_eq!(signals(&import), [closed, opened]);
    assert_eq!(import.program.motions.last(), Some(&Motion::Wait { seconds: 1.0, overlap: 0 }));
}

#[test]
fn loops_that_do_more_than_wait_get_a_note() {
    let blink = "io.setBlink(true); Thread.sleep(100); io.setBlink(false);";
    for (run, why) in [
        (format!("while (!io.getClosed()) {{ {blink} }}"), "its body does more than sleep"),
        (
            "int n = 0; while (!io.getClosed() && n < 10) { Thread.sleep(10); n++; }".to_owned(),
            "its condition is more than the value of the input",
        ),
        (
            "for (int n = 0; !io.getClosed(); n++) { Thread.sleep(10); }".to_owned(),
            "its body does more than sleep",
        ),
    ] {
        let import = imported(&format!("{MOVE}\n{run}"));
        assert_eq!(signals(&import), [], "{run}");
        let expected =
            format!("by the input `Gripper.Closed`, and the program does not wait for it: {why}");
        assert!(
            import.notes.iter().any(|note| note.text.contains(&expected)),
            "{:?}",
            import.notes
        );
    }
}

#[test]
fn a_loop_that_sleeps_before_its_test_becomes_a_wait() {
    let import = imported(&format!("{MOVE}\ndo {{ Thread.sleep(100); }} while (!io.getClosed());"));
    let waits = &import.program.motions[import.program.motions.len() - 2..];
    let closed = IoEntry::wait_for("Gripper.Closed", IoValue::Boolean(true), 0.0);
    assert_eq!(waits, [Motion::Wait { seconds: 0.1, overlap: 0 }, Motion::Io(closed)]);
}

#[test]
fn losses_of_an_export_are_notices() {
    let program = program(&[
        r#"{ "type": "set", "io": "A.B", "value": true }"#,
        r#"{ "type": "wait_for", "io": "A.B", "value": true, "seconds": 0.1 }"#,
        r#"{ "type": "wait_for", "io": "A.C", "value": true, "seconds": 0.1 }"#,
        r#"{ "type": "load", "load": { "mass_kg": 2, "shapes": [
             { "type": "sphere", "center_mm": [0, 0, 60], "radius_mm": 40 } ] } }"#,
        PTP,
    ]);
    let notices: Vec<String> =
        exported(&program).unwrap().notices.iter().map(ToString::to_string).collect();
    let [wait, shapes] = &notices[..] else { panic!("{notices:?}") };
    assert!(wait.starts_with("motion 2: `io`: the program sets `A.B` before"), "{wait}");
    assert_eq!(shapes, "motion 4: `shapes`: Sunrise loads have no shapes: they are left out");
}

/// Sources of an application with the statements `run`, and of its group as Workbench generates it.
fn sources(run: &str) -> (String, String) {
    let group = "package com.kuka.generated.ioAccess;\n\
        public class GripperIOGroup extends AbstractIOGroup {\n\
        @Inject public GripperIOGroup(Controller controller) {\n\
        super(controller, \"Gripper\");\n\
        addDigitalOutput(\"Close\", IOTypes.BOOLEAN, 1);\n\
        addDigitalOutput(\"Offset\", IOTypes.INTEGER, 8);\n\
        addDigitalOutput(\"Count\", IOTypes.UNSIGNED_INTEGER, 32);\n\
        addAnalogOutput(\"Force\", IOTypes.ANALOG, 16, -40.0, 40.0);\n\
        addInput(\"Closed\", IOTypes.BOOLEAN, 1);\n}\n\
        public void setClose(java.lang.Boolean value) {\n\
        setDigitalOutput(\"Close\", value);\n}\n\
        public void setOffset(java.lang.Integer value) {\n\
        setDigitalOutput(\"Offset\", value);\n}\n\
        public void setCount(java.lang.Long value) {\n\
        setDigitalOutput(\"Count\", value);\n}\n\
        public void setForce(double value) {\n\
        setAnalogOutput(\"Force\", value);\n}\n\
        public boolean getClosed() {\n\
        return getBooleanIOValue(\"Closed\", false);\n}\n\
        public void awaitClosed() {\n\
        while (!getClosed()) { // iiwasim: 0.2 s\n\
        ThreadUtil.milliSleep(10);\n}\n}\n}\n";
    let java = format!(
        "package application;\n\
         import com.kuka.roboticsAPI.applicationModel.RoboticsAPIApplication;\n\
         import com.kuka.roboticsAPI.deviceModel.LBR;\n\
         import com.kuka.generated.ioAccess.GripperIOGroup;\n\
         import static com.kuka.roboticsAPI.motionModel.BasicMotions.*;\n\
         import javax.inject.Inject;\n\
         public class Pick extends RoboticsAPIApplication {{\n\
         @Inject private LBR lbr;\n@Inject private GripperIOGroup io;\n\
         public void run() {{\n{run}\n}} }}\n"
    );
    (java, group.to_owned())
}

const GROUP: &str = "src/com/kuka/generated/ioAccess/GripperIOGroup.java";

fn with_generated_class(run: &str) -> Project {
    let (java, group) = sources(run);
    Project::from_texts([("src/application/Pick.java", java), (GROUP, group)]).unwrap()
}

#[test]
fn signals_have_the_line_of_the_application() {
    let run = format!(
        "{MOVE}\nio.setClose(true);\nwhile (!io.getClosed()) {{\nThread.sleep(10);\n}}\n\
         io.awaitClosed();\nio.setForce(\n2);\nclose();\n}}\nvoid close() {{\nio.setClose(false);"
    );
    let project = with_generated_class(&run);
    let import = import(&project, None, &ImportOptions::default()).unwrap();
    let sources: Vec<String> =
        import.program.sources.iter().map(|(_, source)| source.to_string()).collect();
    let at = |line: u32| format!("src/application/Pick.java:{line}");
    assert_eq!(sources, [11, 12, 13, 16, 17, 22].map(at));
    let seconds: Vec<f64> = signals(&import).iter().map(IoEntry::seconds).collect();
    assert_eq!(seconds, [0.0, 0.0, 0.2, 0.0, 0.0]);
}

/// Values keep their kinds: true or false, a whole number, a real number.
#[test]
fn values_keep_their_types() {
    let run = format!(
        "{MOVE}\nio.setClose(true);\nio.setOffset(7);\nio.setOffset(-7);\n\
         io.setCount(3000000000L);\n\
         io.setCount(5L);\nio.setForce(2);\nio.setForce(-2);\nio.setForce(0.25);"
    );
    let project = with_generated_class(&run);
    let import = import(&project, None, &ImportOptions::default()).unwrap();
    let program = Program::from_json(&import.program.to_json()).unwrap();
    let java = exported(&program).unwrap().java;
    for call in [
        "setClose(true)",
        "setOffset(7)",
        "setOffset(-7)",
        "setCount(3000000000L)",
        "setCount(5L)",
        "setForce(2.0)",
        "setForce(-2)",
        "setForce(0.25)",
    ] {
        assert!(java.contains(&format!("ioGripper.{call};")), "{call}: {java}");
    }
    // `setForce(double)` also accepts the -2. The values of the round trip are the same.
    let files = [("src/application/Pick.java", java), (GROUP, sources(&run).1)];
    let again = Project::from_texts(files).unwrap();
    let again = iiwa_sunrise::import(&again, None, &ImportOptions::default()).unwrap();
    assert_eq!(again.program.motions, program.motions);
}

#[test]
fn names_comments_and_groups_come_back() {
    let mut program = program(&[
        r#"{ "type": "load", "load": { "mass_kg": 1 }, "name": "before the first motion" }"#,
        &PTP.replace(
            " }",
            r#", "blocking": true, "name": "over \\ \"part\"",
            "comment": "20 mm above\n\n  C:\\users */", "group": "pick" }"#,
        ),
        r#"{ "type": "wait", "seconds": 0.5, "name": "settle" }"#,
        r#"{ "type": "load", "load": { "mass_kg": 3 }, "name": "part gripped", "group": "pick" }"#,
        r#"{ "type": "set", "io": "Gripper.Close", "value": true, "name": "close" }"#,
        r#"{ "type": "wait_for", "io": "Gripper.Closed", "value": true, "seconds": 0.35,
            "name": "closed", "comment": "the plant's contact" }"#,
        &BACK.replace(" }", r#", "blocking": true }"#),
        r#"{ "type": "load", "load": { "mass_kg": 1 }, "name": "part released" }"#,
        &PTP.replace(" }", r#", "blocking": true, "comment": "and again" }"#),
    ]);
    let (again, java) = round_trip(&program);
    // The first load is the load of the tool.
    program.motions.remove(0);
    let labels: Vec<_> = program.sources.labels().map(|(_, label)| label.clone()).skip(1).collect();
    let found: Vec<_> = again.sources.labels().map(|(_, label)| label.clone()).collect();
    assert_eq!(found, labels, "{java}");
    assert_eq!(again.motions.len(), program.motions.len(), "{java}");
    for (motion, label) in again.sources.labels() {
        assert_eq!(program.sources.label(MotionIndex::new(motion.index() + 1)), Some(label));
    }
}

/// Comments of programmers are not names, and may follow a name.
#[test]
fn only_comments_of_the_export_are_labels() {
    let import = imported(&format!(
        "// approach\n{MOVE}\n// iiwasim name: back\n// by hand\n{MOVE_BACK}\n\
         // iiwasim name:\n{MOVE}\n// iiwasim name: there\n{MOVE}"
    ));
    let labels: Vec<_> = import.program.sources.labels().collect();
    let named = |motion, name| (MotionIndex::new(motion), MotionLabel::named(name));
    let expected = [named(1, "back"), named(3, "there")];
    assert!(labels.into_iter().eq(expected.iter().map(|(motion, label)| (*motion, label))));
    let notes: Vec<_> = import.notes.iter().map(|note| note.text.as_str()).collect();
    assert_eq!(notes, ["the comment lines before this line are ignored: `name` is empty"]);
}
