//! Round trips: programs are equal after export and import.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{fs, path::Path};

use iiwa_kin::Robot;
use iiwa_path::{JointPath, Step};
use iiwa_program::{Blend, Motion, Program, Ptp};
use iiwa_sunrise::{ExportOptions, ExportedProject, Project};
use iiwa_sunrise::{ImportOptions, import};
use proptest::prelude::*;

fn robot(program: &Program) -> Robot {
    match &program.robot {
        Some(name) => Robot::built_in(name).unwrap(),
        None => Robot::default(),
    }
}

fn exported(program: &Program) -> ExportedProject {
    let options = ExportOptions { name: "program.json".to_owned(), ..ExportOptions::default() };
    ExportedProject::new(program, &robot(program), &options).unwrap()
}

fn imported(project: &ExportedProject) -> Program {
    let java = project.java_file();
    let files = [(java.as_str(), &project.java), (ExportedProject::DATA_FILE, &project.data_file)];
    let project = Project::from_texts(files).unwrap();
    import(&project, None, &ImportOptions::default()).unwrap().program
}

/// Returns the joint positions at the start and end of each path segment, and the wait durations.
fn places(program: &Program) -> Vec<[f64; 7]> {
    let path = JointPath::new(program, &robot(program)).unwrap();
    let ends = path.steps().iter().flat_map(|step| match step {
        Step::Move { segment, .. } => vec![segment.at(0.0).q, segment.at(1.0).q],
        Step::Wait { seconds, .. } => vec![[*seconds; 7]],
        _ => Vec::new(),
    });
    ends.collect()
}

/// Asserts that a round trip keeps the path, and that a second one changes nothing.
fn assert_same(program: &Program) {
    let first = exported(program);
    let again = imported(&first);
    let [before, after] = [program, &again].map(places);
    assert_eq!(before.len(), after.len(), "{}", first.java);
    for (before, after) in before.iter().zip(&after) {
        for (before, after) in before.iter().zip(after) {
            assert!((before - after).abs() < 1e-9, "{before} {after}\n{}", first.java);
        }
    }
    let moves = |program: &Program| program.motions.iter().filter(|motion| motion.moves()).count();
    assert_eq!(moves(program), moves(&again));
    let second = exported(&again);
    assert_eq!(imported(&second), again);
}

#[test]
fn fixtures_come_back() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures");
    for name in ["appendix-b", "pick-and-place", "ten-motions", "waits-and-stops"] {
        let text = fs::read_to_string(folder.join(format!("{name}.json"))).unwrap();
        assert_same(&Program::from_json(&text).unwrap());
    }
}

/// Repeat blocks are loops, which the import runs: the motions are those of all rounds.
#[test]
fn loops_come_back_as_their_motions() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures");
    let text = fs::read_to_string(folder.join("glue-dots.json")).unwrap();
    let program = Program::from_json(&text).unwrap();
    let project = exported(&program);
    assert_eq!(project.java.matches("for (int").count(), 2, "{}", project.java);
    let again = imported(&project);
    let mut unrolled = program.clone();
    unrolled.sources.set_repeats(Vec::new());
    let plain = imported(&exported(&unrolled));
    assert_eq!((&again.motions, &again.workcell), (&plain.motions, &plain.workcell));
    let [before, after] = [&program, &again].map(places);
    assert_eq!(before.len(), after.len());
    for (before, after) in before.iter().flatten().zip(after.iter().flatten()) {
        assert!((before - after).abs() < 1e-9, "{before} {after}\n{}", project.java);
    }
}

#[test]
fn projects_come_back() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/sunrise");
    for name in ["joints", "frames", "computed-frames", "paths", "batches", "async", "classes"] {
        let text = fs::read_to_string(folder.join(name).join("expected.json")).unwrap();
        assert_same(&Program::from_json(&text).unwrap());
    }
}

fn joints() -> impl Strategy<Value = [f64; 7]> {
    prop::array::uniform7(-1.6..1.6)
}

fn motion() -> impl Strategy<Value = Motion> {
    let blend = prop_oneof![
        Just(None),
        (5.0..80.0).prop_map(|r| Some(Blend::CartMm(r))),
        (0.05..1.0).prop_map(|x| Some(Blend::SunriseRel(x))),
    ];
    (joints(), 0.01..1.0, blend).prop_map(|(target_rad, velocity, blend)| {
        Motion::Ptp(Ptp { blend, ..Ptp::to(target_rad).velocity(velocity) })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Joint-space motions, which need no frames, are equal bit for bit.
    #[test]
    fn motions_in_joint_space_come_back(
        start in joints(),
        mut motions in prop::collection::vec(motion(), 1..8),
        wait in (0.001..3.0_f64),
        position in 0..8_usize,
    ) {
        if let Some(Motion::Ptp(last)) = motions.last_mut() {
            last.blend = None;
        }
        let before = position.checked_sub(1).and_then(|position| motions.get_mut(position));
        if let Some(Motion::Ptp(before)) = before {
            before.blend = None;
        }
        // Whole milliseconds, which Java's sleep represents exactly.
        let seconds = (wait * 1e3).round() / 1e3;
        motions.insert(position.min(motions.len()), Motion::Wait { seconds, overlap: 0 });
        let mut program = Program::from_rad(start).build();
        program.motions = motions;
        let again = imported(&exported(&program));
        prop_assert_eq!(&again.start, &program.start);
        // Java's `move` waits for the end of a motion.
        for entry in &mut program.motions {
            if let Motion::Ptp(ptp) = entry {
                ptp.blocking = ptp.blend.is_none();
            }
        }
        prop_assert_eq!(&again.motions, &program.motions);
    }
}
