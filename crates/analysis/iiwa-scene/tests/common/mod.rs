//! Random scenes.

#![expect(clippy::unwrap_used, reason = "a failed test panics")]

use std::f64::consts::{PI, TAU};

use iiwa_scene::{Form, Obstacle, Scene, TriangleSurface};

/// Creates up to `max_count` obstacles of all shapes within reach of the arm; some of the boxes are
/// axis-aligned.
pub(crate) fn scene(random: &mut fastrand::Rng, max_count: usize) -> Scene {
    of_shapes(random, max_count, 9)
}

/// Creates obstacles as [`scene`], without meshes.
pub(crate) fn solids(random: &mut fastrand::Rng, max_count: usize) -> Scene {
    of_shapes(random, max_count, 8)
}

fn of_shapes(random: &mut fastrand::Rng, max_count: usize, shapes: u8) -> Scene {
    let count = random.usize(1..=max_count);
    let obstacles = (0..count).map(|i| {
        let mut between = |from: f64, to: f64| from + (to - from) * random.f64();
        let mut three = |from, to| [between(from, to), between(from, to), between(from, to)];
        let place = three(-1.1, 1.1);
        let (size_m, turn) = (three(0.005, 0.8), three(-3.1, 3.1));
        let radius_m = 0.5 * size_m[0];
        let form = match random.u8(0..shapes) {
            0 => Form::Plane { point_m: place, normal: place.map(|v| -v) },
            1 | 2 => Form::Box { center_m: place, size_m, rpy_rad: [0.0; 3] },
            3 => Form::Sphere { center_m: place, radius_m },
            4 => {
                let length_m = size_m[1];
                Form::Cylinder { center_m: place, radius_m, length_m, rpy_rad: turn }
            }
            8 => {
                let surface = ball(0.02 + radius_m, 5);
                Form::Mesh { surface, origin_m: place, rpy_rad: turn }
            }
            _ => Form::Box { center_m: place, size_m, rpy_rad: turn },
        };
        Obstacle { name: format!("obstacle {i}"), form }
    });
    Scene::new(obstacles.collect()).unwrap()
}

/// Creates the surface of a sphere around the origin, of rings with 2 `steps` points each.
pub(crate) fn ball(radius_m: f64, steps: u32) -> TriangleSurface {
    let sides = 2 * steps;
    let at = |ring: u32, side: u32| {
        let (sin, cos) = (PI * f64::from(ring) / f64::from(steps)).sin_cos();
        let (y, x) = (TAU * f64::from(side) / f64::from(sides)).sin_cos();
        [radius_m * sin * x, radius_m * sin * y, radius_m * cos]
    };
    let rings = (0..=steps).flat_map(|ring| (0..sides).map(move |side| at(ring, side)));
    let index = move |ring: u32, side: u32| ring * sides + side % sides;
    let triangles = (0..steps).flat_map(|ring| {
        (0..sides).flat_map(move |side| {
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)];
            let [a, b, c, d] = corners.map(|(down, along)| index(ring + down, side + along));
            [[a, b, c], [a, c, d]]
        })
    });
    TriangleSurface::new(rings.collect::<Vec<_>>(), triangles).unwrap()
}
