//! Robot base positions: the program at the best one, and the search result.

use iiwa_optimise::{Place, PlaceGrid};
use iiwa_program::Program;

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
