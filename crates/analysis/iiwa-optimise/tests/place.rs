//! Robot base positions: the program at the best one, and the search result.

use iiwa_optimise::{Optimiser, Place, PlaceGrid, PlaceMap};
use iiwa_program::Program;
use iiwa_scene::{AllowedClearances, ArmInScene, Form, Obstacle, Scene};
use iiwa_traj::Trajectory;

use crate::untouched::optimiser;

const PICK_AND_PLACE: &str = include_str!("../../../../fixtures/pick-and-place.json");
const APPENDIX_B: &str = include_str!("../../../../fixtures/appendix-b.json");

fn grid(x_mm: &[f64], y_mm: &[f64], yaw_deg: &[f64]) -> PlaceGrid {
    let m = |values: &[f64]| values.iter().map(|mm| 1e-3 * mm).collect();
    let yaws_rad = yaw_deg.iter().map(|deg: &f64| deg.to_radians()).collect();
    PlaceGrid { shifts_m: [m(x_mm), m(y_mm), vec![0.0]], yaws_rad }
}

#[test]
fn the_program_at_the_best_place_takes_as_long_as_stated() {
    let program = Program::from_json(PICK_AND_PLACE).unwrap();
    let optimiser = optimiser(&program);
    let grid = grid(&[-100.0, 0.0, 100.0], &[-100.0, 0.0, 100.0], &[0.0, 20.0]);
    let found = optimiser.place(&program, &grid).unwrap();
    assert_eq!((found.places.len(), grid.count()), (18, 18));
    // x changes fastest, then y, then the rotation.
    assert_eq!(found.places[1].place, Place { shift_m: [0.0, -0.1, 0.0], yaw_rad: 0.0 });
    assert_eq!(found.places[17].place.shift_m, [0.1, 0.1, 0.0]);
    // The present place, on the grid and planned as it is.
    let here_s = found.places[4].cycle_time_s.unwrap();
    assert!((here_s - found.cycle_time_s).abs() < 1e-6);

    let best = found.best.unwrap();
    let best_s = best.cycle_time_s.unwrap();
    assert!(found.cycle_time_s - best_s > 0.001);
    let on_grid = found.places.iter().filter_map(|place| place.cycle_time_s);
    assert!(best_s <= on_grid.fold(f64::INFINITY, f64::min));
    assert!(best.place.shift_m.iter().all(|shift| shift.abs() <= 0.1));
    let text = found.program.to_json();
    let planned = optimiser.plan(&Program::from_json(&text).unwrap()).unwrap();
    assert!((planned.cycle_time_s() - best_s).abs() < 1e-6);
    assert!(found.plans > 18);
}

/// Joint positions stay as they are.
#[test]
fn a_program_in_joints_takes_as_long_at_each_place() {
    let program = Program::from_json(APPENDIX_B).unwrap();
    let found = optimiser(&program).place(&program, &grid(&[-50.0, 50.0], &[0.0], &[0.0])).unwrap();
    assert!(found.places.iter().all(|place| place.cycle_time_s == Some(found.cycle_time_s)));
    assert!(found.best.is_none());
    assert_eq!(found.program, program);
}

#[test]
fn places_out_of_reach_have_no_cycle_time() {
    let program = Program::from_json(PICK_AND_PLACE).unwrap();
    let found = optimiser(&program).place(&program, &grid(&[-900.0, 0.0], &[0.0], &[0.0])).unwrap();
    let times: Vec<_> = found.places.iter().map(|place| place.cycle_time_s.is_some()).collect();
    assert_eq!(times, [false, true]);
}

/// Smallest distance of the arm from the obstacles at many instants with the robot at a place.
fn nearest_m(optimiser: &Optimiser, program: &Program, scene: &Scene, place: &Place) -> f64 {
    let scene = scene.with_cell_at(&place.cell(), &[]);
    let arm = ArmInScene::new(optimiser.robot(), &scene);
    let plan = optimiser.plan(&program.with_cell_at(&place.cell())).unwrap();
    let distances = plan.samples(1000.0).map(|state| arm.clearance(&state.q).unwrap().distance_m);
    distances.fold(f64::INFINITY, f64::min)
}

/// A bar behind the shoulder, to which the robot gets near at the fastest places.
fn bar() -> Scene {
    let form =
        Form::Box { center_m: [-0.3, 0.0, 0.45], size_m: [0.1, 1.0, 0.1], rpy_rad: [0.0; 3] };
    Scene::new(vec![Obstacle { name: "bar".to_owned(), form }]).unwrap()
}

#[test]
fn places_too_near_to_obstacles_are_rejected() {
    let program = Program::from_json(PICK_AND_PLACE).unwrap();
    let optimiser = optimiser(&program);
    let grid = grid(&[-100.0, -50.0, 0.0, 50.0], &[0.0], &[0.0]);
    let free = optimiser.place(&program, &grid).unwrap();
    assert!((free.best.unwrap().place.shift_m[0] + 0.1).abs() < 1e-9);
    assert!(free.places.iter().all(|place| !place.is_rejected));

    let scene = bar();
    let places = free.places.iter().map(|it| nearest_m(&optimiser, &program, &scene, &it.place));
    let places_m: Vec<_> = places.collect();
    assert!(places_m.is_sorted() && places_m[1] - places_m[0] > 0.03, "{places_m:?}");
    // The first place is too near.
    let min_m = f64::midpoint(places_m[0], places_m[1]);
    let unchanged = optimiser.plan(&program).unwrap();
    let arm = ArmInScene::new(optimiser.robot(), &scene);
    let clearances = AllowedClearances::new(&arm, &unchanged, min_m).unwrap();
    let with_robot = |with_robot: &[usize]| {
        let rule = |place: &Place, plan: &Trajectory| {
            clearances.allow_elsewhere(&place.cell(), with_robot, plan)
        };
        optimiser.place_within(&program, &grid, &rule).unwrap()
    };
    let found = with_robot(&[]);
    let rejected: Vec<_> = found.places.iter().map(|place| place.is_rejected).collect();
    assert_eq!(rejected, [true, false, false, false]);
    let times_s = |map: &PlaceMap| map.places.iter().map(|it| it.cycle_time_s).collect::<Vec<_>>();
    assert_eq!(times_s(&found), times_s(&free));
    let best = found.best.unwrap();
    assert!(!best.is_rejected && best.cycle_time_s > free.best.unwrap().cycle_time_s);
    // Between the first two places, and as near as allowed.
    let best_m = nearest_m(&optimiser, &program, &scene, &best.place);
    assert!(best_m > min_m - 2e-4 && best_m < places_m[1] - 1e-3, "{best_m} m, {min_m} m");
    assert!(best.cycle_time_s < found.places[1].cycle_time_s);

    // A bar that moves with the robot keeps its distance from the shoulder.
    let moving = with_robot(&[0]);
    assert_eq!((moving.places, moving.best), (free.places, free.best));
}

#[test]
fn a_rule_that_rejects_all_places_leaves_the_program_as_it_is() {
    let program = Program::from_json(PICK_AND_PLACE).unwrap();
    let optimiser = optimiser(&program);
    let grid = grid(&[-50.0, 50.0], &[0.0], &[0.0]);
    let free = optimiser.place(&program, &grid).unwrap();
    let all = optimiser.place_within(&program, &grid, &|_, _| true).unwrap();
    assert_eq!((&all.places, &all.best, all.plans), (&free.places, &free.best, free.plans));
    let none = optimiser.place_within(&program, &grid, &|_, _| false).unwrap();
    assert!(none.places.iter().all(|place| place.is_rejected && place.cycle_time_s.is_some()));
    assert!(none.best.is_none());
    assert_eq!(none.program, program);
    assert_eq!(none.changed_cycle_time_s(), none.cycle_time_s);
}
