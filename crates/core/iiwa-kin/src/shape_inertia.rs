//! Inertia of shapes, for links of which only the mass is known.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

use crate::{Along, RigidBody, Shape, Solid};

impl Shape {
    /// Volume, in m^3.
    fn volume(&self) -> f64 {
        match self.solid {
            Solid::Cylinder { radius_m, length_m, .. } => PI * radius_m * radius_m * length_m,
            Solid::Sphere { radius_m } => 4.0 / 3.0 * PI * radius_m.powi(3),
        }
    }

    /// Moments of inertia about the shape's centre, divided by the mass, in m^2.
    fn inertia_per_kg(&self) -> [f64; 3] {
        match self.solid {
            Solid::Cylinder { along, radius_m, length_m } => {
                let spin = radius_m * radius_m / 2.0;
                let tilt = (3.0 * radius_m * radius_m + length_m * length_m) / 12.0;
                match along {
                    Along::Y => [tilt, spin, tilt],
                    Along::Z => [tilt, tilt, spin],
                }
            }
            Solid::Sphere { radius_m } => [0.4 * radius_m * radius_m; 3],
        }
    }
}

/// Rigid body of `shapes` at uniform density; overlapping volumes count twice.
pub(crate) fn body(shapes: &[Shape], mass_kg: f64) -> RigidBody {
    let volume: f64 = shapes.iter().map(Shape::volume).sum();
    let share = |shape: &Shape| shape.volume() / volume;
    let center = shapes
        .iter()
        .fold(Vector3::zeros(), |sum, shape| sum + Vector3::from(shape.center_m) * share(shape));
    let mut inertia = Matrix3::zeros();
    for shape in shapes {
        let arm = Vector3::from(shape.center_m) - center;
        let steiner = Matrix3::from_diagonal_element(arm.norm_squared()) - arm * arm.transpose();
        let about_center = Matrix3::from_diagonal(&Vector3::from(shape.inertia_per_kg()));
        inertia += (about_center + steiner) * (share(shape) * mass_kg);
    }
    let inertia_kg_m2 =
        [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|place| inertia[place]);
    RigidBody { mass_kg, center_m: center.into(), inertia_kg_m2 }
}
