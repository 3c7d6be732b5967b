//! The clearance of a pose.

use std::{collections::HashSet, f64::consts::TAU, sync::Arc};

use iiwa_kin::{Joints, Robot, part_name};
use serde::Serialize;

use crate::{
    arm::{self, Body, Part},
    arm_meshes::ArmMeshes,
    distance::{Near, near, near_part},
    links::{FIRST_LINK, MAY_TOUCH},
    placed::Placed,
    scene::Scene,
};

/// The smallest distance between the arm and the obstacles of a scene, or between parts of the arm, and where it is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Clearance {
    /// In m; 0 if they touch or overlap.
    pub distance_m: f64,
    /// The link that is nearest to something, 2 to 7, or 8 for the tool.
    pub link: usize,
    /// What it is nearest to.
    pub other: Other,
    /// The nearest point of the link, in the base frame, in m.
    pub on_link_m: [f64; 3],
    /// The nearest point of the other, in the base frame, in m. Where they touch or overlap it is the
    /// same one: a point of both.
    pub on_other_m: [f64; 3],
}

/// What a link is near to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Other {
    /// An obstacle: its place in [`Scene::obstacles`].
    Obstacle(usize),
    /// A link of the arm, 0 to 5, which comes before the other one.
    Link(usize),
}

/// An arm in a scene, prepared for clearances.
///
/// The arm is made of the cylinders and spheres of [`Robot::link_shapes`], and of the scene's tool. Links 0 and 1 do not count: they
/// turn about their own axis only, so that their distances never change, and the foot may stand on an
/// obstacle. For the same reason the shoulder does not count next to what it is as far from at all poses, as the column below it,
/// unless they touch. Neither do pairs that the scene ignores.
///
/// [Of its distances from itself](Self::self_clearance), those of parts count that are three links or more apart, the tool being
/// the link after the last one: nearer ones cannot touch within the limits of the joints. That is an assumption. Pairs of parts
/// that are as far apart at all poses do not count there, either.
///
/// A clone shares what was prepared: it costs next to nothing.
#[derive(Clone, Debug)]
pub struct ArmInScene {
    pub(crate) robot: Robot,
    scene: Arc<Scene>,
    pub(crate) parts: Arc<[Part]>,
    pub(crate) obstacles: Arc<[Placed]>,
    /// Whether a pair of a part and an obstacle counts, part by part.
    counts: Arc<[bool]>,
    /// The pairs of parts that count.
    own_pairs: Arc<[Pair]>,
}

/// A part of the arm and what it may come near to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pair {
    pub(crate) part: usize,
    pub(crate) target: Target,
}

/// An obstacle or another part, by its index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Target {
    Obstacle(usize),
    Part(usize),
}

/// Which distances are taken.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Among {
    Obstacles,
    OwnParts,
}

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
        let ignored: HashSet<(usize, usize)> =
            scene.ignored().iter().map(|it| (it.link, it.obstacle)).collect();
        let counts = parts.iter().flat_map(|part| {
            let own = |o: usize| {
                part.shown >= FIRST_LINK
                    && !ignored.contains(&(part.shown, o))
                    && !is_constant(robot, part, &obstacles[o])
            };
            (0..obstacles.len()).map(own).collect::<Vec<_>>()
        });
        let counts = counts.collect();
        let may_touch = |part: usize, other: usize| {
            parts[other].shown + MAY_TOUCH <= parts[part].shown
                && !is_rigid(robot, &parts[part], &parts[other])
        };
        let own_pairs = (0..parts.len()).flat_map(|part| {
            let others = (0..parts.len()).filter(move |other| may_touch(part, *other));
            others.map(move |other| Pair { part, target: Target::Part(other) })
        });
        let own_pairs = own_pairs.collect();
        Self {
            robot: robot.clone(),
            scene: Arc::new(scene.clone()),
            parts: parts.into(),
            obstacles,
            counts,
            own_pairs,
        }
    }

    /// The pairs whose distances count, part by part.
    pub(crate) fn pairs(&self, among: Among) -> impl Iterator<Item = Pair> {
        let (obstacles, own) = match among {
            Among::Obstacles => (self.obstacles.len(), &[][..]),
            Among::OwnParts => (0, &*self.own_pairs),
        };
        let of_scene = (0..self.parts.len()).flat_map(move |part| {
            let counting = move |o: &usize| self.counts[part * obstacles + o];
            let pair = move |o| Pair { part, target: Target::Obstacle(o) };
            (0..obstacles).filter(counting).map(pair)
        });
        of_scene.chain(own.iter().copied())
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The clearance at `joints_rad`; none if the scene has no obstacles, or a joint is not finite.
    #[must_use]
    pub fn clearance(&self, joints_rad: &Joints) -> Option<Clearance> {
        self.clearance_among(Among::Obstacles, joints_rad)
    }

    /// The smallest distance of two parts of the arm, the tool included, at `joints_rad`; none if a joint is not finite.
    #[must_use]
    pub fn self_clearance(&self, joints_rad: &Joints) -> Option<Clearance> {
        self.clearance_among(Among::OwnParts, joints_rad)
    }

    fn clearance_among(&self, among: Among, joints_rad: &Joints) -> Option<Clearance> {
        if !joints_rad.iter().all(|q| q.is_finite()) {
            return None;
        }
        let bodies = self.bodies(joints_rad);
        self.nearest(among, &bodies, f64::MAX).map(|(pair, near)| self.told(pair, &near))
    }

    /// What something near is called: the obstacle's name, or the link.
    #[must_use]
    pub fn name_of(&self, other: Other) -> String {
        match other {
            Other::Obstacle(o) => {
                self.scene.obstacles().get(o).map(|it| it.name.clone()).unwrap_or_default()
            }
            Other::Link(link) => part_name(link),
        }
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
    pub(crate) fn nearest(
        &self,
        among: Among,
        bodies: &[Body<'_>],
        most: f64,
    ) -> Option<(Pair, Near)> {
        let body = |part: usize| bodies[part];
        let least = |pair| (self.least(pair, &body(pair.part), body), pair);
        let mut pairs: Vec<_> = self.pairs(among).map(least).collect();
        // The one that is likely to be nearest first: it rules out most of the others.
        let first = (0..pairs.len()).min_by(|a, b| pairs[*a].0.total_cmp(&pairs[*b].0))?;
        pairs.swap(0, first);
        let mut best: Option<(Pair, Near)> = None;
        for (least, pair) in pairs {
            let most = best.map_or(most, |(_, near)| near.distance);
            if least >= most {
                continue;
            }
            let found = self.near(pair, &body(pair.part), body, most);
            if let Some(found) = found
                && found.distance < most
            {
                best = Some((pair, found));
            }
        }
        best
    }

    /// A lower bound of a pair's distance, by the spheres around parts.
    pub(crate) fn least<'b>(
        &self,
        Pair { part, target }: Pair,
        body: &Body<'_>,
        bodies: impl Fn(usize) -> Body<'b>,
    ) -> f64 {
        let of_center = match target {
            Target::Obstacle(o) => self.obstacles[o].distance(body.center),
            Target::Part(other) => {
                (bodies(other).center - body.center).length() - self.parts[other].bound
            }
        };
        of_center - self.parts[part].bound
    }

    /// The nearest points of a pair, unless they are certainly farther apart than `most`.
    pub(crate) fn near<'b>(
        &self,
        pair: Pair,
        body: &Body<'_>,
        bodies: impl Fn(usize) -> Body<'b>,
        most: f64,
    ) -> Option<Near> {
        match pair.target {
            Target::Obstacle(o) => near(body, &self.obstacles[o], most),
            Target::Part(other) => near_part(body, &bodies(other), most),
        }
    }

    pub(crate) fn told(&self, Pair { part, target }: Pair, near: &Near) -> Clearance {
        Clearance {
            distance_m: near.distance,
            link: self.parts[part].shown,
            other: match target {
                Target::Obstacle(o) => Other::Obstacle(o),
                Target::Part(other) => Other::Link(self.parts[other].shown),
            },
            on_link_m: near.on_part.into(),
            on_other_m: near.on_other.into(),
        }
    }
}

/// Whether two parts of the arm have the same distance at all poses, as what turns about a ball's middle has. Parts that touch
/// count all the same.
fn is_rigid(robot: &Robot, part: &Part, other: &Part) -> bool {
    /// Poses all over the joints' ranges. Two of them tell nearly all pairs.
    const POSES: u32 = 16;
    /// Error of two distances, in m.
    const SAME_M: f64 = 1e-6;
    let distance = |pose: u32| {
        // Shares of a Kronecker sequence: of roots of primes, which have no common period.
        let shares = [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0]
            .map(|prime| 2.0 * (f64::from(pose) * prime.sqrt()).fract() - 1.0);
        let poses = robot.link_poses(&robot.limits().at_shares(&shares));
        let [body, near] = [part, other].map(|it| it.at(&poses[it.link]));
        near_part(&body, &near, f64::MAX).map_or(0.0, |near| near.distance)
    };
    let first = distance(1);
    first > 0.0 && (2..=POSES).all(|pose| (distance(pose) - first).abs() < SAME_M)
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
