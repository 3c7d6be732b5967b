//! Clearance of a pose.

use std::{collections::HashSet, f64::consts::TAU, ops::Range, sync::Arc};

use iiwa_kin::{Joints, Robot, part_name};
use iiwa_program::MotionIndex;
use serde::Serialize;

use crate::{
    arm::{self, ArmPart, PosedPart},
    arm_meshes::ArmMeshes,
    carried::{BodiesOfMotion, CarriedBodies},
    distance::{Near, near, near_convex, to_surface_part},
    links::{FIRST_LINK, IgnoredPair, may_touch},
    placed::Placed,
    placed_box::PlacedBox,
    placed_mesh::SurfacePart,
    scene::Scene,
};

/// Smallest distance between the arm and the obstacles of a scene, or between parts of the arm, and
/// its location.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Clearance {
    /// Distance in m; 0 if the shapes touch or overlap.
    pub distance_m: f64,
    /// Nearest link, 2 to 7, 8 for the tool, or 9 for the workpiece.
    pub link: usize,
    /// Obstacle or link to which the distance applies.
    pub other: Other,
    /// Nearest point of the link, in the base frame, in m.
    pub on_link_m: [f64; 3],
    /// Nearest point of the obstacle or other link, in the base frame, in m. If the shapes touch or
    /// overlap, both points are the same common point.
    pub on_other_m: [f64; 3],
}

/// Obstacle or link near a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Other {
    /// Obstacle, by its index in [`Scene::obstacles`].
    Obstacle(usize),
    /// Link of the arm, 0 to 5, with a lower number than the first one.
    Link(usize),
}

/// Arm in a scene, prepared for clearances.
///
/// The arm consists of the cylinders and spheres of [`Robot::link_shapes`], of the scene's tool,
/// and of the shapes that a program [carries](Self::carrying). Links 0 and 1 are not checked: they
/// are fixed or rotate about their own axis only, so that
/// their distances never change, and the robot base may be mounted on an obstacle. For the same
/// reason the shoulder is not checked against obstacles at a constant distance, such as the column
/// below it, unless they touch. Pairs that the scene ignores are not checked either.
///
/// [The self-clearance](Self::self_clearance) covers parts that are three links or more apart, with
/// the tool as the link after the last one: closer ones cannot touch within the joint limits. This
/// is an assumption. Pairs of parts with the same distance at all poses are not checked there
/// either.
///
/// Clones share the prepared data and are cheap.
#[derive(Clone, Debug)]
pub struct ArmInScene {
    pub(crate) robot: Robot,
    scene: Arc<Scene>,
    carried: Arc<CarriedBodies>,
    /// Parts that are always present, then those of the carried bodies.
    pub(crate) parts: Arc<[ArmPart]>,
    /// Number of parts that are always present.
    always: usize,
    /// Parts of each carried body.
    body_parts: Arc<[Range<usize>]>,
    pub(crate) obstacles: Arc<[Placed]>,
    /// Flags for all pairs of a part and an obstacle, part by part: `true` if the pair is checked.
    counts: Arc<[bool]>,
    /// Pairs of parts that are checked, part by part.
    self_pairs: Arc<[Pair]>,
}

/// Part of the arm and its possible collision partner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pair {
    pub(crate) part: usize,
    pub(crate) target: ClearanceTarget,
}

/// Obstacle or other part, by its index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ClearanceTarget {
    Obstacle(usize),
    /// Node of the surface of a mesh, and the index of this obstacle.
    Surface {
        obstacle: usize,
        node: usize,
    },
    Part(usize),
}

/// Set of pairs to be checked.
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

    /// Prepares `robot` and `scene`, with the convex hulls of link meshes in place of cylinders and
    /// spheres.
    #[must_use]
    pub fn with_meshes(robot: &Robot, scene: &Scene, meshes: &ArmMeshes) -> Self {
        let parts = arm::mesh_parts(robot, &meshes.hulls);
        Self::of_parts(robot, scene, [parts, arm::tool_parts(robot, scene.tool())].concat())
    }

    /// Returns the arm with the shapes that a program carries, in place of those that it carries
    /// already. They count in the clearances of the program's motions, [of a
    /// trajectory](Self::clearance_of) and [at a pose](Self::clearance_during), and as the tool in
    /// the self-clearance.
    #[must_use]
    pub fn carrying(&self, carried: &CarriedBodies) -> Self {
        let parts = self.parts.iter().filter(|part| !part.is_carried).cloned();
        let mut parts = parts.collect::<Vec<_>>();
        let ranges = carried.bodies().iter().map(|body| {
            let first = parts.len();
            parts.extend(arm::carried_parts(&self.robot, body));
            first..parts.len()
        });
        let body_parts = ranges.collect();
        let arm = Self::of_parts(&self.robot, &self.scene, parts);
        Self { carried: Arc::new(carried.clone()), body_parts, ..arm }
    }

    /// Returns the arm with its tool and the shapes that it carries, among the obstacles of another
    /// scene. Distances that no motion changes are checked as well.
    pub(crate) fn among_obstacles_of(&self, scene: Scene) -> Self {
        let (obstacles, counts) = placed(&scene, &self.parts, |_, _| true);
        Self { scene: Arc::new(scene), obstacles, counts, ..self.clone() }
    }

    /// Returns the arm without the distances from obstacles of those pairs that `is_checked`
    /// excludes.
    pub(crate) fn checking(&self, is_checked: impl Fn(IgnoredPair) -> bool) -> Self {
        let obstacles = self.obstacles.len();
        let counts = self.counts.iter().enumerate().map(|(index, counts)| {
            let (part, obstacle) = (index / obstacles, index % obstacles);
            *counts && is_checked(IgnoredPair { link: self.parts[part].shown, obstacle })
        });
        Self { counts: counts.collect(), ..self.clone() }
    }

    /// Returns the distance of links 0 and 1 from each obstacle, in m. It is the same at all joint
    /// positions, and no other clearance includes it.
    pub(crate) fn base_clearances_m(&self) -> Vec<f64> {
        let poses = self.robot.link_poses(&[0.0; 7]);
        let parts = self.parts.iter().filter(|part| part.shown < FIRST_LINK);
        let base: Vec<_> = parts.map(|part| part.at(&poses[part.link])).collect();
        let distance_m = |obstacle: &Placed| {
            let distances = base.iter().filter_map(|part| near(part, obstacle, f64::MAX));
            distances.map(|near| near.distance).fold(f64::INFINITY, f64::min)
        };
        self.obstacles.iter().map(distance_m).collect()
    }

    fn of_parts(robot: &Robot, scene: &Scene, parts: Vec<ArmPart>) -> Self {
        let changes = |part: &ArmPart, obstacle: &Placed| !is_constant(robot, part, obstacle);
        let (obstacles, counts) = placed(scene, &parts, changes);
        let may_touch = |part: usize, other: usize| {
            may_touch(parts[part].shown, parts[other].shown)
                && !is_rigid(robot, &parts[part], &parts[other])
        };
        // Parts that a carried body may touch are those of the arm.
        let always = parts.iter().take_while(|part| !part.is_carried).count();
        let self_pairs = (0..parts.len()).flat_map(|part| {
            let others = (0..always).filter(move |other| may_touch(part, *other));
            others.map(move |other| Pair { part, target: ClearanceTarget::Part(other) })
        });
        let self_pairs = self_pairs.collect();
        Self {
            robot: robot.clone(),
            scene: Arc::new(scene.clone()),
            carried: Arc::default(),
            parts: parts.into(),
            always,
            body_parts: Arc::default(),
            obstacles,
            counts,
            self_pairs,
        }
    }

    /// Returns the shapes that a program carries.
    pub(crate) fn carried(&self) -> &CarriedBodies {
        &self.carried
    }

    /// Returns the bodies at the flange during a motion; none without a motion.
    pub(crate) fn bodies_during(&self, motion: Option<MotionIndex>) -> BodiesOfMotion {
        motion.map(|motion| self.carried.at(motion)).unwrap_or_default()
    }

    /// Returns the checked pairs with these bodies at the flange, part by part.
    pub(crate) fn pairs(&self, among: Among, bodies: BodiesOfMotion) -> impl Iterator<Item = Pair> {
        let (obstacles, self_pairs) = match among {
            Among::Obstacles => (self.obstacles.len(), &[][..]),
            Among::OwnParts => (0, &*self.self_pairs),
        };
        let present = self.present(bodies);
        let of_scene = present.clone().into_iter().flatten().flat_map(move |part| {
            let counting = move |o: &usize| self.counts[part * obstacles + o];
            let pair = move |o| Pair { part, target: ClearanceTarget::Obstacle(o) };
            (0..obstacles).filter(counting).map(pair)
        });
        let self_pairs = present.into_iter().flat_map(move |parts| {
            let [from, to] = [parts.start, parts.end]
                .map(|part| self_pairs.partition_point(|pair| pair.part < part));
            self_pairs[from..to].iter().copied()
        });
        of_scene.chain(self_pairs)
    }

    /// Returns the parts with these bodies at the flange, in order.
    fn present(&self, bodies: BodiesOfMotion) -> [Range<usize>; 3] {
        let [tool, workpiece] = bodies.present().map(|body| {
            body.and_then(|body| self.body_parts.get(body).cloned()).unwrap_or_default()
        });
        [0..self.always, tool, workpiece]
    }

    /// Returns the scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Returns the clearance at `joints_rad`; none if the scene has no obstacles, or a joint is not
    /// finite.
    #[must_use]
    pub fn clearance(&self, joints_rad: &Joints) -> Option<Clearance> {
        self.clearance_among(Among::Obstacles, None, joints_rad)
    }

    /// Returns the smallest distance of two parts of the arm, including the tool, at `joints_rad`;
    /// none if a joint is not finite.
    #[must_use]
    pub fn self_clearance(&self, joints_rad: &Joints) -> Option<Clearance> {
        self.clearance_among(Among::OwnParts, None, joints_rad)
    }

    /// Returns the clearance at `joints_rad` during a motion of the program whose shapes the arm
    /// [carries](Self::carrying), as [`clearance`](Self::clearance) otherwise.
    #[must_use]
    pub fn clearance_during(&self, motion: MotionIndex, joints_rad: &Joints) -> Option<Clearance> {
        self.clearance_among(Among::Obstacles, Some(motion), joints_rad)
    }

    /// Returns the self-clearance at `joints_rad` during a motion of the program whose shapes the
    /// arm [carries](Self::carrying), as [`self_clearance`](Self::self_clearance) otherwise.
    #[must_use]
    pub fn self_clearance_during(
        &self,
        motion: MotionIndex,
        joints_rad: &Joints,
    ) -> Option<Clearance> {
        self.clearance_among(Among::OwnParts, Some(motion), joints_rad)
    }

    fn clearance_among(
        &self,
        among: Among,
        motion: Option<MotionIndex>,
        joints_rad: &Joints,
    ) -> Option<Clearance> {
        if !joints_rad.iter().all(|q| q.is_finite()) {
            return None;
        }
        self.nearest(among, self.bodies_during(motion), joints_rad, f64::MAX)
            .map(|(pair, near)| self.to_clearance(pair, &near))
    }

    /// Returns the name of an obstacle or a link.
    #[must_use]
    pub fn name_of(&self, other: Other) -> String {
        match other {
            Other::Obstacle(o) => {
                self.scene.obstacles().get(o).map(|it| it.name.clone()).unwrap_or_default()
            }
            Other::Link(link) => part_name(link),
        }
    }

    /// Returns an upper bound of the motion of any point of the checked parts, in m, for a linear
    /// joint motion from one pose to another. No clearance on the way differs by more from that at
    /// either end.
    #[must_use]
    pub fn travel_bound_m(&self, from_rad: &Joints, to_rad: &Joints) -> f64 {
        let way = |part: &ArmPart| {
            let ways = std::iter::zip(from_rad, to_rad).map(|(from, to)| (to - from).abs());
            std::iter::zip(ways, &part.reach).map(|(way, reach)| way * reach).sum()
        };
        self.parts.iter().map(way).fold(0.0, f64::max)
    }

    /// Returns the nearest pair at `joints_rad`, if it is nearer than `max_distance`.
    pub(crate) fn nearest(
        &self,
        among: Among,
        carried: BodiesOfMotion,
        joints_rad: &Joints,
        max_distance: f64,
    ) -> Option<(Pair, Near)> {
        let poses = self.robot.link_poses(joints_rad);
        let present = self.present(carried);
        let posed = present.clone().map(|parts| {
            let parts = self.parts[parts].iter().map(|part| part.at(&poses[part.link]));
            parts.collect::<Vec<_>>()
        });
        let body = |part: usize| {
            let is_in = |parts: &Range<usize>| parts.contains(&part);
            let group = present.iter().position(is_in).unwrap_or_default();
            posed[group][part - present[group].start]
        };
        let lower_bound = |pair| (self.lower_bound(pair, &body(pair.part), body), pair);
        let mut pairs: Vec<_> = self.pairs(among, carried).map(lower_bound).collect();
        // The pair with the smallest bound first: it excludes most of the others.
        let first = (0..pairs.len()).min_by(|a, b| pairs[*a].0.total_cmp(&pairs[*b].0))?;
        pairs.swap(0, first);
        let mut best: Option<(Pair, Near)> = None;
        for (lower_bound, pair) in pairs {
            let max_distance = best.map_or(max_distance, |(_, near)| near.distance);
            if lower_bound >= max_distance {
                continue;
            }
            let near = self.near(pair, &body(pair.part), body, max_distance);
            if let Some(near) = near
                && near.distance < max_distance
            {
                best = Some((pair, near));
            }
        }
        best
    }

    /// Returns a lower bound of a pair's distance, from the bounding spheres of the parts.
    pub(crate) fn lower_bound<'b>(
        &self,
        Pair { part, target }: Pair,
        body: &PosedPart<'_>,
        bodies: impl Fn(usize) -> PosedPart<'b>,
    ) -> f64 {
        let of_center = match target {
            ClearanceTarget::Obstacle(o) => self.obstacles[o].distance(body.center),
            ClearanceTarget::Surface { obstacle, node } => match &self.obstacles[obstacle] {
                Placed::Mesh(mesh) => mesh.lower_bound_of(node, body.center),
                placed => placed.distance(body.center),
            },
            ClearanceTarget::Part(other) => {
                (bodies(other).center - body.center).length() - self.parts[other].bound
            }
        };
        of_center - self.parts[part].bound
    }

    /// Returns the nearest points of a pair; none if they are farther apart than `max_distance` for
    /// certain.
    pub(crate) fn near<'b>(
        &self,
        pair: Pair,
        body: &PosedPart<'_>,
        bodies: impl Fn(usize) -> PosedPart<'b>,
        max_distance: f64,
    ) -> Option<Near> {
        match pair.target {
            ClearanceTarget::Obstacle(o) => near(body, &self.obstacles[o], max_distance),
            ClearanceTarget::Surface { obstacle, node } => match &self.obstacles[obstacle] {
                Placed::Mesh(mesh) => to_surface_part(body, &mesh.part(node), max_distance),
                placed => near(body, placed, max_distance),
            },
            ClearanceTarget::Part(other) => near_convex(body, &bodies(other), max_distance),
        }
    }

    /// Returns the pair of a part and the root of a surface's tree, if the obstacle is a mesh.
    pub(crate) fn rooted(&self, pair: Pair) -> Pair {
        match pair.target {
            ClearanceTarget::Obstacle(obstacle)
                if matches!(self.obstacles[obstacle], Placed::Mesh(_)) =>
            {
                Pair { target: ClearanceTarget::Surface { obstacle, node: 0 }, ..pair }
            }
            _ => pair,
        }
    }

    /// Returns the box at a node of a surface, with the index of the first one of its two nodes;
    /// none for a triangle, and for other targets.
    pub(crate) fn bounding_box(&self, target: ClearanceTarget) -> Option<(PlacedBox, usize)> {
        let ClearanceTarget::Surface { obstacle, node } = target else { return None };
        let Placed::Mesh(mesh) = &self.obstacles[obstacle] else { return None };
        match mesh.part(node) {
            SurfacePart::Box(cuboid, first) => Some((cuboid, first)),
            SurfacePart::Face(_) => None,
        }
    }

    pub(crate) fn to_clearance(&self, Pair { part, target }: Pair, near: &Near) -> Clearance {
        Clearance {
            distance_m: near.distance,
            link: self.parts[part].shown,
            other: match target {
                ClearanceTarget::Obstacle(o) | ClearanceTarget::Surface { obstacle: o, .. } => {
                    Other::Obstacle(o)
                }
                ClearanceTarget::Part(other) => Other::Link(self.parts[other].shown),
            },
            on_link_m: near.on_part.into(),
            on_other_m: near.on_other.into(),
        }
    }
}

/// Returns the obstacles of a scene, and for all pairs of a part and an obstacle, part by part,
/// `true` if the pair is checked: if neither the scene nor `is_checked` excludes it.
fn placed(
    scene: &Scene,
    parts: &[ArmPart],
    is_checked: impl Fn(&ArmPart, &Placed) -> bool,
) -> (Arc<[Placed]>, Arc<[bool]>) {
    let obstacles: Arc<[Placed]> = scene.obstacles().iter().map(|o| Placed::new(&o.form)).collect();
    let ignored: HashSet<(usize, usize)> =
        scene.ignored().iter().map(|it| (it.link, it.obstacle)).collect();
    let counts = parts.iter().flat_map(|part| {
        let counts = |o: usize| {
            part.shown >= FIRST_LINK
                && !ignored.contains(&(part.shown, o))
                && is_checked(part, &obstacles[o])
        };
        (0..obstacles.len()).map(counts).collect::<Vec<_>>()
    });
    let counts = counts.collect();
    (obstacles, counts)
}

/// Returns true if two parts of the arm have the same positive distance at all poses, such as a
/// part that rotates about the centre of a sphere. Parts that touch are checked in any case.
fn is_rigid(robot: &Robot, part: &ArmPart, other: &ArmPart) -> bool {
    /// Number of poses, distributed over the joint ranges. Two of them decide almost all pairs.
    const POSES: u32 = 16;
    /// Error of two distances, in m.
    const SAME_M: f64 = 1e-6;
    let distance = |pose: u32| {
        // Kronecker sequence: multiples of the square roots of primes, which have no common period.
        let shares = [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0]
            .map(|prime| 2.0 * (f64::from(pose) * prime.sqrt()).fract() - 1.0);
        let poses = robot.link_poses(&robot.limits().at_shares(&shares));
        let [body, near] = [part, other].map(|it| it.at(&poses[it.link]));
        near_convex(&body, &near, f64::MAX).map_or(0.0, |near| near.distance)
    };
    let first = distance(1);
    first > 0.0 && (2..=POSES).all(|pose| (distance(pose) - first).abs() < SAME_M)
}

/// Returns true if a part that only joint 1 moves has the same positive distance from an obstacle
/// at all poses. A part that touches an obstacle is checked in any case.
fn is_constant(robot: &Robot, part: &ArmPart, obstacle: &Placed) -> bool {
    /// Number of angles of joint 1: 5 degrees apart, between which the shoulder moves by less than
    /// a centimetre.
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
