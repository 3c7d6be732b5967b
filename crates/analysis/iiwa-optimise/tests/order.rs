//! The fastest order of tasks: compared with the exact cycle times of all orders.

use iiwa_optimise::{Optimiser, OrderedTasks, SequenceTimes};
use iiwa_program::Program;
use iiwa_traj::{PlanError, Trajectory};
use serde_json::{Value, json};

use crate::untouched::optimiser;

const SCREWS: &str = include_str!("../../../../fixtures/screws.json");

fn order(program: &Program) -> OrderedTasks {
    optimiser(program).order(program).unwrap()
}

/// A program with a task for each of these positions of A1, in degrees: there, down and up again.
/// `end` is the motion after the tasks.
fn text(
    positions_deg: &[f64],
    after: &[(usize, usize)],
    blend_mm: f64,
    end: Option<Value>,
) -> String {
    let group = |task: usize| format!("task {task}");
    let tasks = (0..positions_deg.len()).map(|task| {
        let after = after.iter().filter(|pair| pair.0 == task).map(|pair| group(pair.1));
        json!({ "group": group(task), "after": after.collect::<Vec<_>>() })
    });
    let motions = positions_deg.iter().enumerate().flat_map(|(task, a1_deg)| {
        let up = if blend_mm > 0.0 { json!({ "cart_mm": blend_mm }) } else { Value::Null };
        [
            json!({ "type": "ptp", "joints_deg": [a1_deg, 30, 0, -60, 0, 90, 0] }),
            json!({ "type": "lin_rel", "offset": { "z_mm": 40.0 + 10.0 * task as f64 } }),
            json!({ "type": "lin_rel", "offset": { "z_mm": -60 }, "blend": up }),
        ]
        .map(|mut motion| {
            motion["group"] = json!(group(task));
            motion
        })
    });
    let motions: Vec<_> = motions.chain(end).collect();
    json!({
        "version": 1,
        "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
        "tasks": tasks.collect::<Vec<_>>(),
        "motions": motions,
    })
    .to_string()
}

fn home() -> Value {
    json!({ "type": "ptp", "joints_deg": [0, 30, 0, -60, 0, 90, 0] })
}

/// Shortest of the exact cycle times of all orders that the program allows, in s.
fn by_trial(optimiser: &Optimiser, program: &Program, is_last_free: bool) -> f64 {
    let count = program.tasks().unwrap().len();
    let mut orders = vec![Vec::new()];
    for _ in 0..count {
        let next = |order: &Vec<usize>| {
            let free = (0..count).filter(|task| !order.contains(task)).collect::<Vec<_>>();
            let order = order.clone();
            free.into_iter().map(move |task| [&order[..], &[task]].concat()).collect::<Vec<_>>()
        };
        orders = orders.iter().flat_map(next).collect();
    }
    let is_allowed = |order: &&Vec<usize>| is_last_free || order.last() == Some(&(count - 1));
    let times = orders.iter().filter(is_allowed).filter_map(|order| {
        let (ordered, _) = program.with_task_order(order).ok()?;
        Some(optimiser.plan(&ordered).ok()?.cycle_time_s())
    });
    times.fold(f64::INFINITY, f64::min)
}

#[test]
fn the_order_is_the_fastest_of_all() {
    let positions_deg = [40.0, -50.0, 20.0, 60.0];
    for (after, blend_mm, end) in [
        (&[][..], 0.0, Some(home())),
        (&[(2, 1), (3, 0)][..], 0.0, Some(home())),
        (&[][..], 0.0, None),
        (&[(3, 0)][..], 30.0, Some(home())),
        (&[][..], 0.0, Some(json!({ "type": "lin_rel", "offset": { "z_mm": 20 } }))),
    ] {
        let is_last_free = end.as_ref().is_some_and(|end| end["type"] == "ptp");
        let program = Program::from_json(&text(&positions_deg, after, blend_mm, end)).unwrap();
        let optimiser = optimiser(&program);
        let found = order(&program);
        let least_s = by_trial(&optimiser, &program, is_last_free);
        assert!(found.is_exact);
        // With blends between tasks, the time of a task depends on more than the one before.
        let tolerance_s = if blend_mm > 0.0 { 0.01 * least_s } else { 1e-6 };
        let above_s = found.changed_cycle_time_s - least_s;
        assert!((-1e-9..=tolerance_s).contains(&above_s), "{after:?} {blend_mm}: {above_s} s");
        let again_s = optimiser.plan(&found.program).unwrap().cycle_time_s();
        assert!((again_s - found.changed_cycle_time_s).abs() < 1e-9);
        assert!(is_last_free || found.order.last() == Some(&3), "{:?}", found.order);
    }
}

#[test]
fn screws_are_tightened_faster_in_another_order() {
    let program = Program::from_json(SCREWS).unwrap();
    let found = order(&program);
    assert!(found.is_exact && found.plans > 50);
    assert!(found.changed_cycle_time_s < 0.95 * found.cycle_time_s, "{found:?}");
    // The first two screws come first, as the program states.
    let mut first = found.order[..2].to_vec();
    first.sort_unstable();
    assert_eq!(first, [0, 1]);
    // The same on a second search, whatever the number of threads.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    assert_eq!(pool.install(|| order(&program)).order, found.order);
}

#[test]
fn nothing_changes_without_a_faster_order() {
    // In the fastest order already, one task, none.
    let program = Program::from_json(SCREWS).unwrap();
    let fastest = order(&program).program;
    let again = order(&fastest);
    assert_eq!(again.program, fastest);
    assert_eq!(again.changed_cycle_time_s, again.cycle_time_s);
    let one = Program::from_json(&text(&[30.0], &[], 0.0, Some(home()))).unwrap();
    assert_eq!(order(&one).program, one);
    let none = Program::from_json(&text(&[], &[], 0.0, Some(home()))).unwrap();
    assert_eq!(order(&none).program, none);
}

/// A wait or an output directly after the tasks has to be executed where the last task ends.
#[test]
fn what_follows_the_last_task_keeps_its_position() {
    let positions_deg = [40.0, -50.0, 20.0];
    let text = |after: &[Value]| {
        let mut program: Value =
            serde_json::from_str(&text(&positions_deg, &[], 0.0, None)).unwrap();
        program["motions"].as_array_mut().unwrap().extend_from_slice(after);
        Program::from_json(&program.to_string()).unwrap()
    };
    let free = text(&[home()]);
    assert_ne!(order(&free).order.last(), Some(&2));
    let output = json!({ "type": "set", "io": "Gripper.close", "value": true });
    let during = json!({ "type": "wait", "seconds": 0.1, "overlap_motions": 2 });
    let frame = json!({ "type": "ptp", "frame": { "x_mm": 500, "y_mm": 0, "z_mm": 500,
        "a_deg": 0, "b_deg": 180, "c_deg": 0 } });
    for after in [
        [output, home()],
        [json!({ "type": "wait", "seconds": 1 }), home()],
        [home(), during],
        [frame, home()],
    ] {
        let program = text(&after);
        assert_eq!(order(&program).order.last(), Some(&2), "{after:?}");
    }
}

/// A payload that is picked up before the tasks is carried in all of them.
#[test]
fn tasks_are_timed_with_the_payload_that_they_carry() {
    let positions_deg = [20.0, -50.0, 60.0];
    let mut heavy: Value =
        serde_json::from_str(&text(&positions_deg, &[], 0.0, Some(home()))).unwrap();
    heavy["limit_torque_percent"] = json!(60);
    let load = json!({ "type": "load", "load": { "mass_kg": 6, "center_mm": [0, 0, 100] } });
    heavy["motions"].as_array_mut().unwrap().insert(0, load);
    let program = Program::from_json(&heavy.to_string()).unwrap();
    let found = order(&program);
    let least_s = by_trial(&optimiser(&program), &program, true);
    assert!((found.changed_cycle_time_s - least_s).abs() < 1e-6);
    let mut light = heavy;
    light["motions"][0]["load"] = Value::Null;
    let light = order(&Program::from_json(&light.to_string()).unwrap());
    assert!(light.changed_cycle_time_s < found.changed_cycle_time_s);
}

/// More tasks than all orders of which are compared.
#[test]
fn many_tasks_become_faster() {
    let count = SequenceTimes::EXACT_TASKS + 4;
    let positions_deg: Vec<f64> = (0..count).map(|task| (task * 37 % 120) as f64 - 60.0).collect();
    let program = Program::from_json(&text(&positions_deg, &[(7, 3)], 0.0, Some(home()))).unwrap();
    let found = order(&program);
    assert!(!found.is_exact);
    assert!(found.changed_cycle_time_s < 0.9 * found.cycle_time_s);
    let place = |task: usize| found.order.iter().position(|other| *other == task);
    assert!(place(3) < place(7));
}

/// A rule that excludes one task after another one leads to the fastest order without that.
#[test]
fn a_rule_excludes_successions() {
    let program =
        Program::from_json(&text(&[40.0, -50.0, 20.0, -10.0], &[], 0.0, Some(home()))).unwrap();
    let optimiser = optimiser(&program);
    let free = optimiser.order(&program).unwrap();
    let [first, second] = [free.order[0], free.order[1]].map(|task| 3 * task);
    let follows = |origins: &[usize]| {
        // The second task begins directly after the last motion of the first one; a part of the
        // program begins where the first task ends.
        origins.windows(2).any(|pair| pair == [first + 2, second])
    };
    let start_rad = |program: &Program| program.start.joints_rad().copied();
    let rule = |part: &Program, _: &Trajectory, origins: &[usize]| {
        let is_part = start_rad(part) != start_rad(&program) && origins.first() == Some(&second);
        !follows(origins) && !is_part
    };
    let found = optimiser.order_within(&program, &rule).unwrap();
    assert!(found.order.windows(2).all(|pair| pair != &free.order[..2]), "{:?}", found.order);
    assert!(found.changed_cycle_time_s >= free.changed_cycle_time_s);
    // If nothing is allowed, the program is unchanged.
    let none = optimiser.order_within(&program, &|_, _, _| false).unwrap();
    assert_eq!(none.program, program);
}

#[test]
fn errors_are_those_of_the_program() {
    let far = text(&[40.0, 175.0], &[], 0.0, Some(home()));
    let program = Program::from_json(&far).unwrap();
    let error = optimiser(&program).order(&program).unwrap_err();
    assert!(matches!(error, PlanError::Fault(_)), "{error}");
}
