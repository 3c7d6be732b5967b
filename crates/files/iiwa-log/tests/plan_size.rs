//! Estimated size of plan files, compared with the written files.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::{fs, io::Cursor, path::Path as FilePath};

use iiwa_kin::Robot;
use iiwa_log::{PlanConfig, PlanSize, PlanWriter};
use iiwa_path::JointPath;
use iiwa_plan::PlanFigures;
use iiwa_program::{Blend, Motion, Program, Ptp, Sources, Start, Workcell};
use iiwa_traj::{Timing, Trajectory};

fn planned(program: &Program) -> Trajectory {
    let path = JointPath::new(program, &Robot::default()).unwrap();
    Trajectory::plan(&path, Timing::default()).unwrap()
}

fn size(plan: &Trajectory, rate_hz: f64) -> PlanSize {
    PlanSize::of(plan, rate_hz)
}

/// Returns the bytes of the file.
fn written(plan: &Trajectory, rate_hz: f64) -> usize {
    let config = PlanConfig { rate_hz, ..PlanConfig::default() };
    let storage = Cursor::new(Vec::new());
    let mut writer = PlanWriter::new(storage, plan.path().robot(), config).unwrap();
    for section in plan.sections() {
        writer.section(section).unwrap();
    }
    // The estimate does not include the figures.
    let figures = PlanFigures::new(Timing::default(), plan.path().robot(), 0);
    writer.finish(&figures, None).unwrap().into_inner().len()
}

/// Returns a program with `joints` moving joints at this share of their speed.
fn motions(joints: usize, velocity_rel: f64, count: u32) -> Program {
    let target = |i: u32| {
        let swing = |j: usize| (1.3 * f64::from(i) + 2.1 * j as f64).sin();
        Ptp::to(std::array::from_fn(|j| if j < joints { swing(j) } else { 0.0 }))
    };
    let motion = |i: u32| {
        let ptp = target(i).velocity(velocity_rel);
        Motion::Ptp(if i < count { ptp.blend(Blend::Fraction(0.2)) } else { ptp })
    };
    Program {
        robot: None,
        start: Start::Joints([0.0; 7]),
        workcell: Workcell::default(),
        sources: Sources::default(),
        motions: (1..=count).map(motion).collect(),
    }
}

#[test]
fn files_are_as_large_as_estimated() {
    let fixtures = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures");
    let fixture = |name: &str| {
        let text = fs::read_to_string(fixtures.join(name).with_extension("json")).unwrap();
        (name.to_owned(), Program::from_json(&text).unwrap())
    };
    let mut programs: Vec<_> = ["appendix-b", "ten-motions", "waits-and-stops"].map(fixture).into();
    let waits = vec![Motion::Wait { seconds: 100.0, overlap: 0 }];
    programs.push(("wait".to_owned(), Program { motions: waits, ..motions(0, 1.0, 1) }));
    for (joints, velocity_rel, count) in [(1, 0.02, 3), (2, 0.5, 20), (7, 0.01, 3), (7, 1.0, 20)] {
        let name = format!("{joints} joints at {velocity_rel}");
        programs.push((name, motions(joints, velocity_rel, count)));
    }
    for (name, program) in programs {
        let plan = planned(&program);
        for rate_hz in [50.0, 250.0, 1000.0] {
            let (size, bytes) = (size(&plan, rate_hz), written(&plan, rate_hz));
            let ratio = size.bytes() as f64 / bytes as f64;
            assert!(
                (1.0 / 1.25..1.25).contains(&ratio),
                "{name} at {rate_hz} Hz: {ratio}, {bytes}"
            );
            assert!((size.duration_s() - plan.cycle_time_s()).abs() < 1e-9);
            let samples = (plan.cycle_time_s() * rate_hz).ceil() + 1.0;
            assert!((size.samples() as f64 - samples).abs() < 1.5, "{name}: {samples}");
        }
    }
}

#[test]
fn months_have_a_size_too() {
    let plan = planned(&motions(1, 1e-6, 8));
    let months_s = plan.cycle_time_s();
    assert!(months_s > 3e6);
    let actual = size(&plan, 250.0);
    assert!((actual.samples() as f64 / (250.0 * months_s) - 1.0).abs() < 1e-6);
    assert!(actual.bytes() > 50_000_000_000, "{actual:?}");
    // The estimate saturates at the largest integer.
    assert_eq!(size(&plan, 1e300).bytes(), u64::MAX);
}
