//! The lower bound of the cycle time: it equals the fastest program of an exhaustive search.

use std::{fs, path::Path};

use iiwa_optimise::{Change, ChangeKind, Freedom, Optimiser, Optimum};
use iiwa_plan::PlanOptions;
use iiwa_program::{MotionIndex, Program};
use iiwa_traj::{SweepOptions, Timing};

use crate::untouched::{assert_untouched, optimiser};

/// Groups of two motions to frames at these places, in mm, with these E1, in degrees. With
/// `is_joined`, the first motion of each group ends in a blend.
fn program(places: &[([f64; 2], f64)], is_joined: bool) -> Program {
    let blend = if is_joined { r#", "blend": { "cart_mm": 20 }"# } else { "" };
    let groups: Vec<String> = places
        .iter()
        .map(|([x_mm, y_mm], e1_deg)| {
            let frame = |z_mm: f64| {
                format!(
                    r#""frame": {{ "x_mm": {x_mm}, "y_mm": {y_mm}, "z_mm": {z_mm}, "a_deg": 0,
                        "b_deg": 180, "c_deg": 0, "e1_deg": {e1_deg}, "status": 2 }}"#
                )
            };
            format!(
                r#"{{ "type": "ptp", {} {blend} }}, {{ "type": "lin", {} }},
                    {{ "type": "wait", "seconds": 0.1 }}"#,
                frame(400.0),
                frame(300.0)
            )
        })
        .collect();
    let text = format!(
        r#"{{ "version": 1, "start": {{ "joints_deg": [0, 30, 0, -60, 0, 90, 0] }}, "motions": [
            {}, {{ "type": "ptp", "joints_deg": [20, 30, 0, -60, 0, 90, 0] }}] }}"#,
        groups.join(", ")
    );
    Program::from_json(&text).unwrap()
}

fn optimum(program: &Program) -> Optimum {
    optimiser(program).with_freedom(Freedom::ELBOWS).optimise(program).unwrap()
}

fn bound_s(optimum: &Optimum) -> f64 {
    let bound = optimum.lower_bound.unwrap();
    assert_eq!(bound.step_deg, 1);
    bound.cycle_time_s
}

/// The cycle time of each program with these turns of the groups, if the robot can execute it.
fn turned_s(program: &Program, turns_deg: &[f64]) -> Option<f64> {
    let turn = |program: Program, (group, by_deg): (usize, &f64)| {
        let motion = MotionIndex::new(3 * group);
        let last = MotionIndex::new(3 * group + 1);
        let to_rad = by_deg.to_radians();
        Change { motion, kind: ChangeKind::Elbow { from_rad: 0.0, to_rad, last } }.apply(&program)
    };
    let turned = turns_deg.iter().enumerate().try_fold(program.clone(), turn)?;
    Some(optimiser(program).plan(&turned).ok()?.cycle_time_s())
}

#[test]
fn one_group_has_the_fastest_of_all_elbow_angles() {
    let program = program(&[([420.0, 350.0], 25.0)], false);
    let all = (-195..=145).filter_map(|by_deg| turned_s(&program, &[f64::from(by_deg)]));
    let least_s = all.fold(f64::INFINITY, f64::min);
    let optimum = optimum(&program);
    assert!((bound_s(&optimum) - least_s).abs() < 1e-6, "{optimum:?}, {least_s} s by trial");
    assert!(optimum.changed_cycle_time_s < least_s + 1e-3);
    assert_untouched(&program, &optimum.program);
}

/// All pairs about the fastest one, in whole degrees, and all others in steps of 15 degrees.
#[test]
fn no_pair_of_elbow_angles_is_faster_than_the_bound() {
    let program = program(&[([450.0, -300.0], -40.0), ([450.0, 350.0], 30.0)], false);
    let optimum = optimum(&program);
    let bound_s = bound_s(&optimum);
    let turns = optimum.changes.iter().map(|change| match change.kind {
        ChangeKind::Elbow { from_rad, to_rad, .. } => (to_rad - from_rad).to_degrees().round(),
        _ => panic!("{change:?}"),
    });
    let turns: Vec<f64> = turns.collect();
    assert_eq!(turns.len(), 2, "{optimum:?}");
    let mut least_s = f64::INFINITY;
    let mut compare = |pair: [f64; 2]| {
        least_s = least_s.min(turned_s(&program, &pair).unwrap_or(f64::INFINITY));
    };
    for first in -4..=4 {
        for second in -4..=4 {
            compare([turns[0] + f64::from(first), turns[1] + f64::from(second)]);
        }
    }
    for first in (-120..=120).step_by(15) {
        for second in (-120..=120).step_by(15) {
            compare([first, second].map(f64::from));
        }
    }
    assert!(least_s > bound_s - 1e-6 && least_s < bound_s + 1e-6, "{least_s} s, {bound_s} s");
    assert!(optimum.changed_cycle_time_s < bound_s + 2e-3);
}

/// The given E1 has no influence on the bound, since all of them differ by whole degrees.
#[test]
fn the_bound_does_not_depend_on_the_given_elbow_angles() {
    let of = |e1_deg: [f64; 3]| {
        let [first, second, third] = e1_deg;
        let places = [([450.0, -300.0], first), ([500.0, 0.0], second), ([450.0, 350.0], third)];
        bound_s(&optimum(&program(&places, false)))
    };
    let bound_s = of([0.0; 3]);
    for e1_deg in [[-60.0, 10.0, 45.0], [35.0, -20.0, -70.0]] {
        assert!((of(e1_deg) - bound_s).abs() < 1e-6, "{e1_deg:?}");
    }
}

#[test]
fn only_elbow_angles_between_stops_have_a_bound() {
    let places = [([450.0, -300.0], 0.0), ([450.0, 350.0], 0.0)];
    assert!(optimum(&program(&places, true)).lower_bound.is_none());
    // Blends may change as well.
    let stops = program(&places, false);
    let freedom = Freedom { speeds: false, ..Freedom::MOTIONS };
    let optimum = optimiser(&stops).with_freedom(freedom).optimise(&stops).unwrap();
    assert!(optimum.lower_bound.is_none());
}

/// A rule only removes versions of the program; one that accepts all changes nothing.
#[test]
fn the_bound_disregards_rules() {
    let program = program(&[([420.0, 350.0], 25.0)], false);
    let optimiser = optimiser(&program).with_freedom(Freedom::ELBOWS);
    let free = optimum(&program);
    let ruled = optimiser.optimise_within(&program, &|_| false).unwrap();
    assert_eq!(ruled.lower_bound, free.lower_bound);
    assert_eq!(ruled.program, program);
    let accepted = optimiser.optimise_within(&program, &|_| true).unwrap();
    assert_eq!(accepted.program, free.program);
}

/// With a small budget, the bound is lower; with a smaller one, it is not known.
#[test]
fn a_bound_needs_a_budget() {
    let program = program(&[([450.0, -300.0], -40.0), ([450.0, 350.0], 30.0)], false);
    let with_budget = |budget: u64| {
        let optimiser = optimiser(&program).with_freedom(Freedom::ELBOWS).with_budget(budget);
        optimiser.optimise(&program).unwrap()
    };
    let exact_s = bound_s(&optimum(&program));
    let small = with_budget(200);
    assert!(bound_s(&small) < exact_s && bound_s(&small) > 0.5 * exact_s, "{small:?}");
    assert!(small.changed_cycle_time_s >= exact_s - 1e-6);
    assert!(with_budget(50).lower_bound.is_none());
}

/// A group of one motion, and a group at the end of a program.
#[test]
fn groups_may_be_short_and_last() {
    let frame = |y_mm: f64, e1_deg: f64| {
        format!(
            r#"{{ "type": "ptp", "frame": {{ "x_mm": 450, "y_mm": {y_mm}, "z_mm": 400, "a_deg": 0,
                "b_deg": 180, "c_deg": 0, "e1_deg": {e1_deg}, "status": 2 }} }}"#
        )
    };
    let [near, far] = [frame(0.0, 50.0), frame(300.0, -30.0)];
    let wait = r#"{ "type": "wait", "seconds": 0.1 }"#;
    for motions in
        [near.clone(), format!("{near}, {far}"), format!("{wait}, {near}, {wait}, {far}, {wait}")]
    {
        let text = format!(
            r#"{{ "version": 1, "start": {{ "joints_deg": [0, 30, 0, -60, 0, 90, 0] }},
                "motions": [{motions}] }}"#
        );
        let optimum = optimum(&Program::from_json(&text).unwrap());
        let bound_s = bound_s(&optimum);
        assert!(bound_s > 0.3 && optimum.changed_cycle_time_s < bound_s + 2e-3, "{motions}");
    }
}

/// The arm picks up a payload that it cannot hold where the program starts.
#[test]
fn payloads_are_where_they_are_carried() {
    let frame = |z_mm: f64| {
        format!(
            r#""frame": {{ "x_mm": 450, "y_mm": 200, "z_mm": {z_mm}, "a_deg": 0, "b_deg": 180,
                "c_deg": 0, "e1_deg": -10, "status": 2 }}"#
        )
    };
    let text = format!(
        r#"{{ "version": 1, "limit_torque_percent": 56.5,
            "start": {{ "joints_deg": [0, 70, 0, 110, 0, 30, 0] }}, "motions": [
            {{ "type": "ptp", "joints_deg": [0, 30, 50, -80, 0, 70, 0] }},
            {{ "type": "load", "load": {{ "mass_kg": 7, "center_mm": [0, 0, 60] }} }},
            {{ "type": "ptp", {} }}, {{ "type": "lin", {} }},
            {{ "type": "ptp", "joints_deg": [0, 30, 50, -80, 0, 70, 0] }}] }}"#,
        frame(400.0),
        frame(380.0)
    );
    let program = Program::from_json(&text).unwrap();
    let timing = Timing::Acceleration(SweepOptions::default());
    let options = PlanOptions { timing, ..PlanOptions::default() };
    let optimiser = Optimiser::new(optimiser(&program).robot().clone(), options);
    let optimum = optimiser.with_freedom(Freedom::ELBOWS).optimise(&program).unwrap();
    let bound_s = bound_s(&optimum);
    assert!(optimum.changed_cycle_time_s < bound_s + 1e-3, "{optimum:?}");
}

/// All production programs with `IIWASIM_LONG`, which takes half a minute.
#[test]
fn production_programs_are_as_fast_as_their_bounds() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/production");
    let is_long = std::env::var_os("IIWASIM_LONG").is_some();
    let mut bounds = 0;
    for file in fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
        let is_short =
            file.ends_with("move-a-casting.json") || file.ends_with("press-buttons.json");
        if !file.is_file() || !(is_short || is_long) {
            continue;
        }
        let program = Program::from_json(&fs::read_to_string(&file).unwrap()).unwrap();
        let optimum = optimum(&program);
        if optimum.lower_bound.is_some() {
            let gap = 1.0 - bound_s(&optimum) / optimum.changed_cycle_time_s;
            println!("{:5.2} %  {}", 100.0 * gap, file.display());
            assert!((-1e-9..1e-3).contains(&gap), "{file:?}: {gap}");
            bounds += 1;
        }
    }
    assert_eq!(bounds, if is_long { 11 } else { 1 });
}
