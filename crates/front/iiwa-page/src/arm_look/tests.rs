//! Tests of the built-in shells.

use std::collections::HashMap;

use iiwa_kin::Robot;

use super::{
    shells::{at, shells},
    skin::Skin,
    surface::{Surface, cross, difference, dot, unit},
};

fn arms() -> Vec<Robot> {
    let short = Robot::lbr_iiwa_7_r800().with_flange_m(0.05).expect("a length");
    vec![
        Robot::lbr_iiwa_7_r800(),
        Robot::lbr_iiwa_14_r820(),
        Robot::lbr_iiwa_7_r800().with_flange_m(0.152).expect("a length"),
        short,
    ]
}

fn skins() -> impl Iterator<Item = (String, Skin)> {
    arms().into_iter().flat_map(|robot| {
        let links = shells(&robot).into_iter().enumerate();
        links.flat_map(move |(link, skins)| {
            let name = format!("{}, link {link}", robot.name());
            skins.into_iter().enumerate().map(move |(i, skin)| (format!("{name}, {i}"), skin))
        })
    })
}

/// Merges corners at equal positions, and removes triangles without area.
fn welded(surface: &Surface) -> Vec<[usize; 3]> {
    let mut known = HashMap::new();
    let numbers: Vec<usize> = surface
        .positions
        .iter()
        .map(|position| {
            let count = known.len();
            *known.entry(position.map(|v| ((v * 1e9).round() + 0.0).to_bits())).or_insert(count)
        })
        .collect();
    let triangles = surface.triangles.iter().map(|corners| corners.map(|it| numbers[it as usize]));
    triangles.filter(|[a, b, c]| a != b && b != c && c != a).collect()
}

#[test]
fn shells_are_watertight() {
    for (name, Skin { surface, .. }) in skins() {
        let mut edges: HashMap<(usize, usize), i32> = HashMap::new();
        for [a, b, c] in welded(&surface) {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((from, to)).or_default() += 1;
            }
        }
        for ((from, to), count) in &edges {
            assert_eq!(*count, 1, "{name}: two triangles on one side of an edge");
            assert_eq!(edges.get(&(*to, *from)), Some(&1), "{name}: a hole");
        }
    }
}

#[test]
fn normals_are_of_length_one_and_outwards() {
    for (name, Skin { surface, .. }) in skins() {
        assert_eq!(surface.normals.len(), surface.positions.len());
        for normal in &surface.normals {
            assert!((dot(*normal, *normal) - 1.0).abs() < 1e-12, "{name}: {normal:?}");
        }
        let mut volume = 0.0;
        let (mut sum, mut to_grid_cell, mut slanted) = (0.0, 0.0, 0.0);
        for corners in &surface.triangles {
            let [a, b, c] = corners.map(|it| surface.positions[it as usize]);
            let across = cross(difference(b, a), difference(c, a));
            volume += dot(a, cross(b, c)) / 6.0;
            let area = dot(across, across).sqrt();
            if area < 1e-9 {
                continue;
            }
            for corner in corners {
                let along = dot(unit(across), surface.normals[*corner as usize]);
                (sum, to_grid_cell) = (sum + along * area, to_grid_cell + area);
                slanted += if along < 0.5 { area } else { 0.0 };
            }
        }
        // Except slivers in the crease between a limb and its housing.
        assert!(slanted / to_grid_cell < 0.002, "{name}: {}", slanted / to_grid_cell);
        assert!(sum / to_grid_cell > 0.98, "{name}: {}", sum / to_grid_cell);
        assert!(volume > 1e-6, "{name}: inside out, {volume} m3");
    }
}

/// Tests the upright arm: from the floor to the flange face, and within the clearance model, except
/// covers.
#[test]
fn shells_are_as_large_as_the_model() {
    for robot in arms() {
        let poses = robot.link_poses(&[0.0; 7]);
        let upright: Vec<[f64; 3]> = shells(&robot)
            .iter()
            .zip(&poses)
            .flat_map(|(skins, pose)| {
                let points = skins.iter().flat_map(|skin| &skin.surface.positions);
                points.map(|point| at(pose, *point)).collect::<Vec<_>>()
            })
            .collect();
        let lengths = robot.lengths();
        let height = lengths.base_m + lengths.upper_arm_m + lengths.forearm_m + lengths.flange_m;
        let low = upright.iter().map(|p| p[2]).fold(f64::MAX, f64::min);
        let high = upright.iter().map(|p| p[2]).fold(f64::MIN, f64::max);
        assert!(low.abs() < 1e-12, "{low}");
        assert!((high - height).abs() < 1e-9, "{high} of {height}");
        let wide = upright.iter().map(|p| p[0].hypot(p[1])).fold(0.0, f64::max);
        assert!((0.1..0.125).contains(&wide), "{wide}");
        // Axes 2, 4 and 6 agree with the model: their covers are centred on them.
        for (link, axis) in [(1, lengths.base_m), (2, lengths.base_m)] {
            let skins = &shells(&robot)[link];
            let cover = &skins[1].surface.positions;
            let count = cover.len() as f64;
            let middle = cover.iter().map(|p| at(&poses[link], *p)[2]).sum::<f64>() / count;
            assert!((middle - axis).abs() < 1e-9, "{middle}");
        }
    }
}

/// Tests for each link that there is no visible gap to its neighbours.
#[test]
fn lengths_move_the_shells() {
    let reach = |robot: &Robot, link: usize| {
        let skins = shells(robot);
        let all = skins[link].iter().flat_map(|skin| skin.surface.positions.clone());
        all.map(|p| p[2]).fold(f64::MIN, f64::max)
    };
    let (short, long) = (Robot::lbr_iiwa_7_r800(), Robot::lbr_iiwa_14_r820());
    assert!(reach(&long, 1) > reach(&short, 1));
    for flange_m in [0.126, 0.152] {
        let robot = short.clone().with_flange_m(flange_m).expect("a length");
        let actual = reach(&robot, 7);
        assert!((actual - flange_m).abs() < 1e-9, "{actual}");
    }
}
