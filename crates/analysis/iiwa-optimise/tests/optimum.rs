//! The fastest version of a program: how fast it is, and what it leaves as it is.

use iiwa_kin::Robot;
use iiwa_optimise::{ChangeKind, Freedom, Optimum};
use iiwa_program::{Motion, Program};

use crate::untouched::{assert_untouched, optimiser};

const PALLETISING: &str = include_str!("../../../../fixtures/sunrise/cell/expected.json");
const PICK_AND_PLACE: &str = include_str!("../../../../fixtures/pick-and-place.json");

fn optimum(text: &str, freedom: Freedom) -> (Program, Optimum) {
    let program = Program::from_json(text).unwrap();
    let optimum = optimiser(&program).with_freedom(freedom).optimise(&program).unwrap();
    (program, optimum)
}

/// Share of the cycle time that is saved.
fn saved(optimum: &Optimum) -> f64 {
    1.0 - optimum.changed_cycle_time_s / optimum.cycle_time_s
}

/// Checks that the plan of the changed program, read from its text, takes as long as stated, and
/// that the listed changes lead to it.
#[track_caller]
fn assert_confirmed(program: &Program, optimum: &Optimum) {
    let optimiser = optimiser(program);
    let text = optimum.program.to_json();
    let planned = optimiser.plan(&Program::from_json(&text).unwrap()).unwrap();
    assert!((planned.cycle_time_s() - optimum.changed_cycle_time_s).abs() < 1e-6);
    let apply = |program: Program, change: &iiwa_optimise::Change| change.apply(&program);
    let changed = optimum.changes.iter().try_fold(program.clone(), apply).unwrap();
    assert_eq!(changed, optimum.program);
}

#[test]
fn elbow_angles_alone_make_palletising_faster() {
    let (program, optimum) = optimum(PALLETISING, Freedom::ELBOWS);
    assert!(saved(&optimum) > 0.077, "{}", saved(&optimum));
    assert!(optimum.is_complete && optimum.plans > 100);
    assert_untouched(&program, &optimum.program);
    assert_confirmed(&program, &optimum);
    let is_elbow = |kind: &ChangeKind| matches!(kind, ChangeKind::Elbow { .. });
    assert!(optimum.changes.iter().all(|change| is_elbow(&change.kind)));
    // Blends and speeds are those of the program.
    for (old, new) in program.motions.iter().zip(&optimum.program.motions) {
        assert_eq!((old.blend(), old.is_blocking()), (new.blend(), new.is_blocking()));
        if let (Motion::Cartesian(old), Motion::Cartesian(new)) = (old, new) {
            assert_eq!(old.shares, new.shares);
        }
    }
}

#[test]
fn elbow_angles_and_blends_make_palletising_faster() {
    let freedom = Freedom { speeds: false, ..Freedom::MOTIONS };
    let (program, optimum) = optimum(PALLETISING, freedom);
    assert!(saved(&optimum) > 0.14, "{}", saved(&optimum));
    assert_untouched(&program, &optimum.program);
    assert_confirmed(&program, &optimum);
    assert_listed_once(&optimum);
}

/// Each motion has one change of a kind, in order.
#[track_caller]
fn assert_listed_once(optimum: &Optimum) {
    let motions: Vec<_> = optimum.changes.iter().map(|change| change.motion).collect();
    assert!(motions.is_sorted(), "{motions:?}");
    for pair in optimum.changes.windows(2) {
        let kinds = [&pair[0].kind, &pair[1].kind].map(std::mem::discriminant);
        assert!(pair[0].motion != pair[1].motion || kinds[0] != kinds[1], "{pair:?}");
    }
}

#[test]
fn all_changes_make_pick_and_place_faster() {
    let (program, optimum) = optimum(PICK_AND_PLACE, Freedom::MOTIONS);
    assert!(saved(&optimum) > 0.15, "{}", saved(&optimum));
    assert_untouched(&program, &optimum.program);
    assert_confirmed(&program, &optimum);
    assert_listed_once(&optimum);
    // A round of advice finds nothing more.
    let advice = optimiser(&program).advise(&optimum.program).unwrap();
    assert!(advice.rows.is_empty(), "{:?}", advice.rows);
}

/// Two places with a stop at each: as fast as the fastest of all pairs of elbow angles, which have
/// to turn together.
#[test]
fn no_pair_of_elbow_angles_is_much_faster() {
    const STEP_DEG: f64 = 10.0;
    let frame = |x_mm: f64, y_mm: f64, z_mm: f64, e1_deg: f64| {
        format!(
            r#""frame": {{ "x_mm": {x_mm}, "y_mm": {y_mm}, "z_mm": {z_mm}, "a_deg": 0, "b_deg": 180,
                        "c_deg": 0, "e1_deg": {e1_deg}, "status": 2 }}"#
        )
    };
    let text = |e1_deg: [f64; 2]| {
        let [first, second] = e1_deg;
        format!(
            r#"{{ "version": 1, "start": {{ "joints_deg": [0, 30, 0, -60, 0, 90, 0] }}, "motions": [
                {{ "type": "ptp", {} }}, {{ "type": "lin", {} }},
                {{ "type": "ptp", {} }}, {{ "type": "lin", {} }}] }}"#,
            frame(450.0, -300.0, 400.0, first),
            frame(450.0, -300.0, 250.0, first),
            frame(450.0, 350.0, 400.0, second),
            frame(450.0, 350.0, 250.0, second)
        )
    };
    let mut least_s = f64::INFINITY;
    let angles = || (-9..=9).map(|step| STEP_DEG * f64::from(step));
    for first in angles() {
        for second in angles() {
            let program = Program::from_json(&text([first, second])).unwrap();
            if let Ok(trajectory) = optimiser(&program).plan(&program) {
                least_s = least_s.min(trajectory.cycle_time_s());
            }
        }
    }
    for e1_deg in [[0.0, 0.0], [-60.0, 50.0], [70.0, 70.0]] {
        let (_, optimum) = optimum(&text(e1_deg), Freedom::ELBOWS);
        let found_s = optimum.changed_cycle_time_s;
        assert!(found_s < 1.01 * least_s, "{e1_deg:?}: {found_s} s, {least_s} s by trial");
        assert!(found_s <= optimum.cycle_time_s);
    }
}

#[test]
fn a_search_without_freedom_returns_the_program() {
    for (text, freedom) in [
        (PICK_AND_PLACE, Freedom::NONE),
        (
            r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
              "motions": [{ "type": "wait", "seconds": 2 }] }"#,
            Freedom::MOTIONS,
        ),
        (
            r#"{ "version": 1, "start": { "joints_deg": [0, 0, 0, 0, 0, 0, 0] },
              "motions": [{ "type": "ptp", "joints_deg": [40, 0, 0, -60, 0, 0, 0] }] }"#,
            Freedom::MOTIONS,
        ),
    ] {
        let (program, optimum) = optimum(text, freedom);
        assert!(optimum.changes.is_empty() && optimum.is_complete, "{:?}", optimum.changes);
        assert_eq!(optimum.program, program);
        assert_eq!(optimum.changed_cycle_time_s, optimum.cycle_time_s);
    }
    let program = Program::from_json(PICK_AND_PLACE).unwrap();
    let optimum = optimiser(&program).optimise_within(&program, &|_| false).unwrap();
    assert!(optimum.changes.is_empty());
    assert_eq!(optimum.program, program);
}

#[test]
fn a_small_budget_ends_the_search() {
    let program = Program::from_json(PICK_AND_PLACE).unwrap();
    let optimum = optimiser(&program).with_budget(1).optimise(&program).unwrap();
    assert!(!optimum.is_complete);
    assert!(optimum.changed_cycle_time_s <= optimum.cycle_time_s);
}

/// The result does not depend on the number of threads.
#[test]
fn threads_make_no_difference() {
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let (_, optimum) = pool.install(|| optimum(PICK_AND_PLACE, Freedom::MOTIONS));
        (optimum.program.to_json(), optimum.plans)
    };
    assert_eq!(with_threads(1), with_threads(3));
}

/// Another robot has other limits.
#[test]
fn the_robot_matters() {
    let program = Program::from_deg([0.0, 20.0, 0.0, -70.0, 0.0, 60.0, 0.0])
        .ptp_deg([40.0, 20.0, 0.0, -70.0, 0.0, 60.0, 0.0])
        .ptp_deg([40.0, 40.0, 0.0, -50.0, 0.0, 60.0, 0.0])
        .build();
    let [small, large] = ["lbr_iiwa_7_r800", "lbr_iiwa_14_r820"].map(|name| {
        let robot = Robot::built_in(name).unwrap();
        let options = iiwa_plan::PlanOptions::default();
        iiwa_optimise::Optimiser::new(robot, options).optimise(&program).unwrap()
    });
    assert!(large.changed_cycle_time_s > small.changed_cycle_time_s);
}
