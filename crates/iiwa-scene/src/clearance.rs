//! The clearance of a pose.

use std::{collections::HashSet, f64::consts::TAU, sync::Arc};

use iiwa_kin::{Joints, Robot};
use serde::Serialize;

use crate::{
    arm::{self, Body, Part},
    arm_meshes::ArmMeshes,
    distance::{Near, near},
    placed::Placed,
    scene::Scene,
};

/// The smallest distance between the arm and the obstacles of a scene, and where it is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Clearance {
    /// In m; 0 if they touch or overlap.
    pub distance_m: f64,
    /// The link that is nearest to an obstacle, 2 to 7, or 8 for the tool.
    pub link: usize,
    /// The obstacle that it is nearest to: its place in [`Scene::obstacles`].
    pub obstacle: usize,
    /// The nearest point of the arm, in the base frame, in m.
    pub on_arm_m: [f64; 3],
    /// The nearest point of the obstacle, in the base frame, in m. Where they touch or overlap it is the
    /// same one: a point of both.
    pub on_obstacle_m: [f64; 3],
}

/// An arm in a scene, prepared for clearances.
///
/// The arm is made of the cylinders and spheres of [`Robot::link_shapes`], and of the scene's tool. Links 0 and 1 do not count: they
/// turn about their own axis only, so that their distances never change, and the foot may stand on an
/// obstacle. For the same reason the shoulder does not count next to what it is as far from at all poses, as the column below it,
/// unless they touch. Neither do pairs that the scene ignores, nor the arm's distances from itself.
///
/// A clone shares what was prepared: it costs next to nothing.
#[derive(Clone, Debug)]
pub struct ArmInScene {
    pub(crate) robot: Robot,
    scene: Arc<Scene>,
    pub(crate) parts: Arc<[Part]>,
    pub(crate) obstacles: Arc<[Placed]>,
    /// Whether a pair counts, part by part.
    counts: Arc<[bool]>,
}

/// A part of the arm and an obstacle, by their indices.
pub(crate) type Pair = (usize, usize);

impl ArmInScene {
    /// Prepares `robot` and `scene`.
    #[must_use]
    pub fn new(robot: &Robot, scene: &Scene) -> Self {
        Self::of_parts(
            robot,
            scene,
            [arm::parts(robot), arm::tool_parts(robot, scene.tool())].concat(),
        )
    }

    /// Prepares `robot` and `scene`: links are the convex hulls of their meshes, in place of cylinders and spheres.
    #[must_use]
    pub fn with_meshes(robot: &Robot, scene: &Scene, meshes: &ArmMeshes) -> Self {
        let parts = arm::mesh_parts(robot, &meshes.hulls);
        Self::of_parts(robot, scene, [parts, arm::tool_parts(robot, scene.tool())].concat())
    }

    fn of_parts(robot: &Robot, scene: &Scene, parts: Vec<Part>) -> Self {
        let obstacles: Arc<[Placed]> =
            scene.obstacles().iter().map(|o| Placed::new(&o.form)).collect();
        let ignored: HashSet<Pair> =
            scene.ignored().iter().map(|it| (it.link, it.obstacle)).collect();
        let counts = parts.iter().flat_map(|part| {
            let own = |o: usize| {
                !ignored.contains(&(part.shown, o)) && !is_constant(robot, part, &obstacles[o])
            };
            (0..obstacles.len()).map(own).collect::<Vec<_>>()
        });
        let counts = counts.collect();
        Self {
            robot: robot.clone(),
            scene: Arc::new(scene.clone()),
            parts: parts.into(),
            obstacles,
            counts,
        }
    }

    /// Whether the distance of a pair counts.
    pub(crate) fn counts(&self, (part, obstacle): Pair) -> bool {
        self.counts[part * self.obstacles.len() + obstacle]
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The clearance at `joints_rad`; none if the scene has no obstacles, or a joint is not finite.
    #[must_use]
    pub fn clearance(&self, joints_rad: &Joints) -> Option<Clearance> {
        if !joints_rad.iter().all(|q| q.is_finite()) {
            return None;
        }
        let bodies = self.bodies(joints_rad);
        self.nearest(&bodies, f64::MAX).map(|(pair, near)| self.told(pair, &near))
    }

    /// The farthest that any point of what counts of the arm moves, at most, in m, while the joints go evenly from one pose to
    /// another: no clearance on the way differs more from that at either end.
    #[must_use]
    pub fn travel_bound_m(&self, from_rad: &Joints, to_rad: &Joints) -> f64 {
        let way = |part: &Part| {
            let ways = std::iter::zip(from_rad, to_rad).map(|(from, to)| (to - from).abs());
            std::iter::zip(ways, &part.reach).map(|(way, reach)| way * reach).sum()
        };
        self.parts.iter().map(way).fold(0.0, f64::max)
    }

    pub(crate) fn bodies(&self, joints_rad: &Joints) -> Vec<Body<'_>> {
        let poses = self.robot.link_poses(joints_rad);
        self.parts.iter().map(|part| part.at(&poses[part.link])).collect()
    }

    /// The nearest pair of all, if it is nearer than `most`.
    pub(crate) fn nearest(&self, bodies: &[Body<'_>], most: f64) -> Option<(Pair, Near)> {
        let mut pairs = Vec::with_capacity(bodies.len() * self.obstacles.len());
        for (part, body) in bodies.iter().enumerate() {
            let bound = self.parts[part].bound;
            let least = |obstacle: &Placed| obstacle.distance(body.center) - bound;
            let counting = |o: &usize| self.counts((part, *o));
            let own = (0..self.obstacles.len()).filter(counting);
            pairs.extend(own.map(|o| (least(&self.obstacles[o]), (part, o))));
        }
        // The one that is likely to be nearest first: it rules out most of the others.
        let first = (0..pairs.len()).min_by(|a, b| pairs[*a].0.total_cmp(&pairs[*b].0))?;
        pairs.swap(0, first);
        let mut best: Option<(Pair, Near)> = None;
        for (least, pair) in pairs {
            let most = best.map_or(most, |(_, near)| near.distance);
            if least >= most {
                continue;
            }
            let found = near(&bodies[pair.0], &self.obstacles[pair.1], most);
            if let Some(found) = found
                && found.distance < most
            {
                best = Some((pair, found));
            }
        }
        best
    }

    pub(crate) fn told(&self, (part, obstacle): Pair, near: &Near) -> Clearance {
        Clearance {
            distance_m: near.distance,
            link: self.parts[part].shown,
            obstacle,
            on_arm_m: near.on_arm.into(),
            on_obstacle_m: near.on_obstacle.into(),
        }
    }
}

/// Whether a part, which only joint 1 moves, has the same distance from an obstacle at all poses. A part that touches it counts all the same.
fn is_constant(robot: &Robot, part: &Part, obstacle: &Placed) -> bool {
    /// Angles of joint 1: 5 degrees apart, at which the shoulder moves by less than a centimetre.
    const TURNS: u32 = 72;
    /// Error of two distances, in m.
    const SAME_M: f64 = 1e-6;
    if !part.turns_with_joint_1() {
        return false;
    }
    let distance = |turn: u32| {
        let mut joints_rad = [0.0; 7];
        joints_rad[0] = TAU * f64::from(turn) / f64::from(TURNS);
        let body = part.at(&robot.link_poses(&joints_rad)[part.link]);
        near(&body, obstacle, f64::MAX).map_or(0.0, |near| near.distance)
    };
    let first = distance(0);
    first > 0.0 && (1..TURNS).all(|turn| (distance(turn) - first).abs() < SAME_M)
}
