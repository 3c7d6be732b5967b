//! Robot and flange of a project: each kind of file that states them, and contradicting files.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use iiwa_kin::{Joints, Redundancy, Robot};
use iiwa_program::{Frame, Program};
use iiwa_sunrise::{
    Answers, DataFile, ExportOptions, ExportedProject, Project, QuestionKind, TaughtRedundancy,
    Teaching, WorldFrame,
};
use iiwa_sunrise::{Import, ImportError, ImportOptions, import};

/// Returns an application with this field declaration, and this statement before its motion.
fn java(field: &str, before: &str) -> (String, String) {
    let text = format!(
        "import static com.kuka.roboticsAPI.motionModel.BasicMotions.*;\n\
         public class Cell extends RoboticsAPIApplication {{\n\
         {field}\n\
         public void run() {{ {before} lbr.move(ptp(0, 0.5, 0, -1, 0, 1, 0)); }} }}\n"
    );
    ("src/Cell.java".to_owned(), text)
}

fn anonymous() -> (String, String) {
    java("@Inject private LBR lbr;", "")
}

fn station(robot: &str, flange: &str) -> (String, String) {
    let text = format!(
        r#"<ConfigurationProject><TopologyItem name="Robot">
<Property key="Name"><Value>{robot}</Value></Property>
<Property key="MAM"><Value displayName="{flange}">MADA=X</Value></Property>
</TopologyItem></ConfigurationProject>"#
    );
    ("StationSetup.cat".to_owned(), text)
}

/// Nearly stretched positions, which the robot cannot reach with a shorter flange.
const POSES: [Joints; 3] = [
    [0.3, 0.6, 0.4, -0.1, 0.2, 0.1, 0.1],
    [-0.5, 0.8, -0.3, -0.12, 0.4, 0.05, -0.4],
    [0.1, -0.4, 0.6, 0.1, -0.3, -0.1, 0.5],
];

/// Returns a data file with frames that a robot with this device name was taught at [`POSES`].
fn taught(device: &str, robot: &Robot) -> (String, String) {
    let frames = POSES.iter().enumerate().map(|(number, joints_rad)| {
        let Redundancy { e1_rad, status, turn } = robot.redundancy(joints_rad);
        WorldFrame {
            name: format!("P{number}"),
            frame: Frame::from(&robot.flange_pose(joints_rad)),
            redundancy: Some(TaughtRedundancy {
                device: device.to_owned(),
                e1_rad: Some(e1_rad),
                status: Some(status),
                turn: Some(turn),
            }),
            teaching: Some(Teaching {
                device: device.to_owned(),
                tcp_name: "Flange".to_owned(),
                tcp: Frame::default(),
            }),
            children: Vec::new(),
        }
    });
    let file = DataFile { frames: frames.collect(), ..DataFile::default() };
    ("RoboticsAPI.data.xml".to_owned(), file.to_xml())
}

fn imported<const N: usize>(
    files: [(String, String); N],
    options: &ImportOptions,
) -> Result<Import, ImportError> {
    import(&Project::from_texts(files).unwrap(), None, options)
}

/// Returns the model and the flange length in mm of the program; a stated flange must match the
/// robot.
fn robot(import: &Import) -> (String, Option<f64>) {
    let name = import.program.robot.clone().unwrap();
    let flange_m = import.program.workcell.flange_m;
    if let Some(flange_m) = flange_m {
        let stated = Robot::built_in(&name).unwrap().with_flange_m(flange_m).unwrap();
        assert_eq!(import.robot, stated);
    }
    (name, flange_m.map(|length_m| 1e3 * length_m))
}

fn stated<const N: usize>(files: [(String, String); N]) -> (String, Option<f64>) {
    robot(&imported(files, &ImportOptions::default()).unwrap())
}

fn questions_of(import: &Import) -> Vec<(QuestionKind, &str, bool)> {
    let questions = import.questions.iter().filter(|question| question.kind != QuestionKind::Start);
    questions.map(|question| (question.kind, question.answer.as_str(), question.is_given)).collect()
}

const SMALL: &str = "lbr_iiwa_7_r800";
const LARGE: &str = "lbr_iiwa_14_r820";

#[test]
fn the_station_states_robot_and_flange() {
    let files = || [anonymous(), station("LBR_iiwa_14_R820_1", "Media flange electrical")];
    assert_eq!(stated(files()), (LARGE.to_owned(), Some(126.0)));
    let import = imported(files(), &ImportOptions::default()).unwrap();
    let said: Vec<_> = import.statements.iter().map(ToString::to_string).collect();
    assert_eq!(
        said,
        [
            "StationSetup.cat:2 says LBR_iiwa_14_R820_1",
            "StationSetup.cat:3 says Media flange electrical"
        ]
    );
    assert!(questions_of(&import).is_empty() && import.notes.is_empty());
    let touch = station("LBR_iiwa_7_R800_1", "Media flange Touch pneumatic");
    assert_eq!(stated([anonymous(), touch]), (SMALL.to_owned(), Some(152.0)));
}

#[test]
fn taught_frames_state_robot_and_flange() {
    for (device, name) in [("LBR_iiwa_7_R800_1", SMALL), ("Cabinet/LBR_iiwa_14_R820_1", LARGE)] {
        for flange_m in [0.126, 0.152] {
            let robot = Robot::built_in(name).unwrap().with_flange_m(flange_m).unwrap();
            let actual = stated([anonymous(), taught(device, &robot)]);
            assert_eq!(actual.0, name);
            assert!((actual.1.unwrap() - 1e3 * flange_m).abs() < 1e-9, "{device}: {actual:?}");
        }
    }
}

#[test]
fn java_states_the_robot() {
    let by_name = java("LBR lbr;", "lbr = (LBR) getDevice(c, \"LBR_iiwa_14_R820_1\");");
    let project = Project::from_texts([by_name]).unwrap();
    assert_eq!(project.files()[0].robots()[0].words, "LBR_iiwa_14_R820_1");
    let field = java("@Inject private LBR lbr; LBR lBR_iiwa_14_R820_1;", "");
    let import = imported([field], &ImportOptions::default()).unwrap();
    assert_eq!(robot(&import).0, LARGE);
    assert_eq!(questions_of(&import), [(QuestionKind::Flange, "152", false)]);
    // The application's file has priority over others.
    let other = ("src/Other.java".to_owned(), "class Other { LBR lBR_iiwa_7_R800_1; }".to_owned());
    let field = java("@Inject private LBR lbr; LBR lBR_iiwa_14_R820_1;", "");
    assert_eq!(stated([field, other.clone()]).0, LARGE);
    assert_eq!(stated([anonymous(), other]).0, SMALL);
}

#[test]
fn missing_statements_are_questions() {
    let import = imported([anonymous()], &ImportOptions::default()).unwrap();
    assert_eq!(robot(&import), (SMALL.to_owned(), Some(152.0)));
    assert_eq!(
        questions_of(&import),
        [(QuestionKind::Robot, SMALL, false), (QuestionKind::Flange, "152", false)]
    );
    let answers = Answers::from_toml(&format!("robot = \"{LARGE}\"\nflange_mm = 126\n")).unwrap();
    let options = ImportOptions { answers, ..ImportOptions::default() };
    let import = imported([anonymous()], &options).unwrap();
    assert_eq!(robot(&import), (LARGE.to_owned(), Some(126.0)));
    assert_eq!(
        questions_of(&import),
        [(QuestionKind::Robot, LARGE, true), (QuestionKind::Flange, "126", true)]
    );
}

#[test]
fn files_that_disagree_are_an_error_that_lists_them() {
    let small = || station("LBR_iiwa_7_R800_1", "Media flange electrical");
    let large = Robot::lbr_iiwa_14_r820().with_flange_m(0.126).unwrap();
    let frames = || taught("LBR_iiwa_14_R820_1", &large);
    let error = imported([anonymous(), small(), frames()], &ImportOptions::default()).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("do not agree on the robot"), "{text}");
    assert!(text.contains("StationSetup.cat:2 says LBR_iiwa_7_R800_1"), "{text}");
    assert!(text.contains("RoboticsAPI.data.xml:"), "{text}");
    // A given robot has priority, with a note.
    let options =
        ImportOptions { robot: Some(Robot::lbr_iiwa_14_r820()), ..ImportOptions::default() };
    let import = imported([anonymous(), small(), frames()], &options).unwrap();
    assert_eq!(robot(&import), (LARGE.to_owned(), Some(126.0)));
    assert!(import.notes[0].text.contains("the project states LBR_iiwa_7_R800_1"));
    // Flanges that contradict each other.
    let touch = Robot::lbr_iiwa_7_r800();
    let frames = || taught("LBR_iiwa_7_R800_1", &touch);
    let error = imported([anonymous(), small(), frames()], &ImportOptions::default()).unwrap_err();
    let text = error.to_string();
    assert!(text.contains("do not agree on the robot's flange"), "{text}");
    assert!(text.contains("of 3 taught frames"), "{text}");
    let options = ImportOptions { flange_m: Some(0.126), ..ImportOptions::default() };
    let import = imported([anonymous(), small(), frames()], &options).unwrap();
    assert_eq!(robot(&import).1, Some(126.0));
    assert!(import.notes[0].text.contains("a flange of 152 mm"), "{:?}", import.notes);
}

#[test]
fn a_station_with_two_robots_is_decided_by_the_others() {
    let two = || {
        let [(file, one), (_, other)] = [
            station("LBR_iiwa_7_R800_1", "Media flange Touch"),
            station("LBR_iiwa_14_R820_1", "Basic flange"),
        ];
        (
            file,
            format!("<Stations>{one}{other}</Stations>")
                .replace("ConfigurationProject", "TopologyItem"),
        )
    };
    let error = imported([anonymous(), two()], &ImportOptions::default()).unwrap_err();
    assert!(matches!(error, ImportError::Robots(ref all) if all.len() == 4), "{error}");
    let field = java("@Inject private LBR lbr; LBR lBR_iiwa_14_R820_1;", "");
    assert_eq!(stated([field, two()]), (LARGE.to_owned(), Some(126.0)));
}

#[test]
fn a_profile_says_all_of_a_robot() {
    let with_flange = Robot::default().with_flange_m(0.14).unwrap();
    let options = ImportOptions {
        robot: Some(with_flange.clone()),
        robot_name: Some("own.json".to_owned()),
        ..ImportOptions::default()
    };
    let files = [anonymous(), station("LBR_iiwa_7_R800_1", "Basic flange")];
    let import = imported(files, &options).unwrap();
    assert_eq!(robot(&import), ("own.json".to_owned(), None));
    assert_eq!(import.robot, with_flange);
}

#[test]
fn an_lbr_med_is_planned_as_an_iiwa_and_says_so() {
    let import = imported(
        [anonymous(), station("LBR_Med_14_R820_1", "Basic flange")],
        &ImportOptions::default(),
    )
    .unwrap();
    assert_eq!(robot(&import).0, LARGE);
    assert!(import.notes[0].text.contains("the same limits are assumed"));
}

#[test]
fn a_station_that_cannot_be_read_is_a_note() {
    let broken = ("StationSetup.cat".to_owned(), "<ConfigurationProject>".to_owned());
    let import = imported([anonymous(), broken], &ImportOptions::default()).unwrap();
    assert!(import.notes[0].text.contains("StationSetup.cat cannot be used"), "{:?}", import.notes);
    assert_eq!(questions_of(&import).len(), 2);
}

#[test]
fn an_exported_program_brings_its_robot_along() {
    let program = |robot: &str| {
        let text = format!(
            r#"{{ "version": 1, "robot": "{robot}", "flange_mm": 126,
                 "start": {{ "joints_deg": [0, 0, 0, 0, 0, 0, 0] }},
                 "motions": [{{ "type": "ptp", "joints_deg": [10, 20, 0, -30, 0, 40, 0] }}] }}"#
        );
        Program::from_json(&text).unwrap()
    };
    let exported = |name: &str, robot: Robot| {
        let program = program(name);
        let options = ExportOptions { name: "cell.json".to_owned(), ..ExportOptions::default() };
        let project =
            ExportedProject::new(&program, &program.with_flange(robot), &options).unwrap();
        let data_file = (ExportedProject::DATA_FILE.to_owned(), project.data_file.clone());
        [(project.java_file(), project.java), data_file]
    };
    let small = || exported(LARGE, Robot::lbr_iiwa_14_r820());
    assert_eq!(stated(small()), (LARGE.to_owned(), Some(126.0)));
    assert!(imported(small(), &ImportOptions::default()).unwrap().questions.is_empty());
    // A profile is not part of the project.
    let error = imported(exported("own.json", Robot::default()), &ImportOptions::default());
    assert_eq!(error.unwrap_err(), ImportError::UnknownRobot("own.json".to_owned()));
}

#[test]
fn the_start_is_a_question_until_it_is_given() {
    let is_asked = |options: &ImportOptions| {
        let import = imported([anonymous()], options).unwrap();
        import.questions.iter().any(|question| question.kind == QuestionKind::Start)
    };
    assert!(is_asked(&ImportOptions::default()));
    let start_rad = Some([0.0, 0.1, 0.0, -0.5, 0.0, 0.0, 0.0]);
    assert!(!is_asked(&ImportOptions { start_rad, ..ImportOptions::default() }));
}

#[test]
fn a_first_motion_out_of_reach_names_the_joints_of_a_taught_frame() {
    let frames = taught("LBR_iiwa_7_R800_1", &Robot::default());
    let linear = java("@Inject private LBR lbr;", "lbr.move(linRel(0, 0, 150));");
    let error = imported([linear, frames.clone()], &ImportOptions::default()).unwrap_err();
    let text = error.to_string();
    let (_, proposed) = text.split_once("it was at the frame `P0` with ").unwrap();
    let proposed = proposed.trim_end_matches(" deg");
    for (proposed, taught) in proposed.split(',').zip(POSES[0]) {
        assert!((proposed.parse::<f64>().unwrap() - taught.to_degrees()).abs() < 1e-3, "{text}");
    }
    // After a motion, the start is not among the reasons.
    let later = java(
        "@Inject private LBR lbr;",
        "lbr.move(ptp(0, 0, 0, 0, 0, 0.1, 0)); lbr.move(linRel(0, 0, 500));",
    );
    let text = imported([later, frames], &ImportOptions::default()).unwrap_err().to_string();
    assert!(
        text.contains("cannot be reached") && !text.contains("the start is not given"),
        "{text}"
    );
}
