//! Obstacles, prepared for distance queries.

use glam::DVec3 as Vector;

use crate::{
    arm::{PosedPart, Volume},
    placed_box::PlacedBox,
    placed_mesh::PlacedMesh,
    rotation::{rotation, unit},
    scene::Form,
};

/// Obstacle in the base frame.
#[derive(Debug)]
pub(crate) enum Placed {
    Box(PlacedBox),
    Plane(PlacedPlane),
    /// Cylinder or sphere.
    Round(PosedPart<'static>),
    Mesh(PlacedMesh),
}

/// Half-space of all points with `normal . x <= offset`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedPlane {
    pub(crate) normal: Vector,
    pub(crate) offset: f64,
}

impl Placed {
    pub(crate) fn new(form: &Form) -> Self {
        let center = |center_m: [f64; 3]| Vector::from(center_m);
        match *form {
            Form::Box { center_m, size_m, rpy_rad } => {
                Self::Box(PlacedBox::new(center_m, size_m, rotation(rpy_rad)))
            }
            Form::Plane { point_m, normal } => {
                let normal = unit(normal);
                Self::Plane(PlacedPlane { normal, offset: normal.dot(point_m.into()) })
            }
            Form::Cylinder { center_m, radius_m, length_m, rpy_rad } => Self::Round(PosedPart {
                center: center(center_m),
                axis: rotation(rpy_rad).map(|row| row[2]).into(),
                form: Volume::Cylinder { radius: radius_m, half: 0.5 * length_m },
            }),
            Form::Sphere { center_m, radius_m } => Self::Round(PosedPart {
                center: center(center_m),
                axis: Vector::Z,
                form: Volume::Ball { radius: radius_m },
            }),
            Form::Mesh { ref surface, origin_m, rpy_rad } => {
                Self::Mesh(PlacedMesh::new(surface, origin_m, rotation(rpy_rad)))
            }
        }
    }

    /// Returns the distance of `point` from the obstacle, for a mesh a lower bound of it; 0 inside.
    pub(crate) fn distance(&self, point: Vector) -> f64 {
        match self {
            Self::Box(cuboid) => (point - cuboid.nearest(point)).length(),
            Self::Plane(plane) => (plane.normal.dot(point) - plane.offset).max(0.0),
            Self::Round(solid) => (point - solid.nearest(point)).length(),
            Self::Mesh(mesh) => mesh.lower_bound(point),
        }
    }

    /// Returns the largest `direction . x` of the obstacle's points, for a `direction` from the
    /// obstacle to a part outside.
    pub(crate) fn farthest_along(&self, direction: Vector) -> f64 {
        match self {
            Self::Box(cuboid) => cuboid.farthest_along(direction),
            // Only called along the normal: a half-space is unbounded across it.
            Self::Plane(plane) => plane.offset,
            Self::Round(solid) => solid.farthest_along(direction),
            Self::Mesh(mesh) => mesh.farthest_along(0, direction),
        }
    }

    /// Returns the largest `direction . x` of the points at a node of a mesh; for other obstacles
    /// as [`farthest_along`](Self::farthest_along).
    pub(crate) fn node_farthest_along(&self, node: usize, direction: Vector) -> f64 {
        match self {
            Self::Mesh(mesh) => mesh.farthest_along(node, direction),
            other => other.farthest_along(direction),
        }
    }
}
