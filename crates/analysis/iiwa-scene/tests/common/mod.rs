//! Random scenes.

#![expect(clippy::unwrap_used, reason = "a failed test panics")]

use iiwa_scene::{Form, Obstacle, Scene};

/// Creates up to `max_count` boxes and planes within reach of the arm; a third of the boxes are
/// axis-aligned.
pub(crate) fn scene(random: &mut fastrand::Rng, max_count: usize) -> Scene {
    let count = random.usize(1..=max_count);
    let obstacles = (0..count).map(|i| {
        let mut between = |from: f64, to: f64| from + (to - from) * random.f64();
        let mut three = |from, to| [between(from, to), between(from, to), between(from, to)];
        let place = three(-1.1, 1.1);
        let (size_m, turn) = (three(0.005, 0.8), three(-3.1, 3.1));
        let form = match random.u8(0..6) {
            0 => Form::Plane { point_m: place, normal: place.map(|v| -v) },
            1 | 2 => Form::Box { center_m: place, size_m, rpy_rad: [0.0; 3] },
            _ => Form::Box { center_m: place, size_m, rpy_rad: turn },
        };
        Obstacle { name: format!("obstacle {i}"), form }
    });
    Scene::new(obstacles.collect()).unwrap()
}
