//! Shapes of the arm, cylinders and spheres: its URDF needs no mesh files, and links of which only
//! the mass is known get an inertia.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

use crate::{RigidBody, Robot};

impl Robot {
    /// Shapes of link 0 to link 7, each in its link frame, in m.
    ///
    /// The shapes of [`Robot::to_urdf`], in the frames of [`Robot::link_poses`]. Neighbouring
    /// shapes of a limb overlap. Without a tool, link 7 ends at the flange face.
    ///
    /// ```
    /// use iiwa_kin::{Robot, Solid};
    ///
    /// let links = Robot::lbr_iiwa_7_r800().link_shapes();
    /// let flange = &links[7][1];
    /// assert!(matches!(flange.solid, Solid::Cylinder { radius_m, .. } if radius_m == 0.045));
    /// ```
    #[must_use]
    pub fn link_shapes(&self) -> [Vec<Shape>; 8] {
        of_links(self.offsets())
    }
}

/// Shapes of link 0 to link 7, each in its link frame.
///
/// A limb is split in two where joint 1, 3, 5 or 7 of the iiwa splits it. The frames are at both
/// ends of the limbs, d1, d3, d5 and d7 (links 0 and 1: base; 2 and 3: shoulder; 4 and 5: elbow; 6
/// and 7: wrist); the z axis of an odd link points along its limb, that of an even link across it.
fn of_links([base, upper_arm, forearm, flange]: [f64; 4]) -> [Vec<Shape>; 8] {
    let (base_cut, upper_cut) = (0.45 * base, 0.5 * upper_arm);
    let (fore_cut, flange_cut) = (0.5 * forearm, 0.55 * flange);
    let limb = |radius, from, to| Shape::cylinder(Along::Z, radius, from, to, SILVER);
    let half_limb = |radius, to| Shape::cylinder(Along::Y, radius, 0.0, to, SILVER);
    let ring = |radius, offset: f64, width| {
        Shape::cylinder(Along::Z, radius, offset - width / 2.0, offset + width / 2.0, ORANGE)
    };
    let hub = |radius, half_width: f64| {
        Shape::cylinder(Along::Z, radius, -half_width, half_width, ORANGE)
    };
    let ball = |radius, offset| Shape::sphere(radius, offset, SILVER);
    [
        vec![
            Shape::cylinder(Along::Z, 0.115, 0.0, 0.2 * base, GRAPHITE),
            limb(0.09, 0.2 * base, base_cut),
        ],
        vec![ring(0.087, base_cut, 0.02), limb(0.08, base_cut, base), ball(0.082, base)],
        // The upper arm runs along -y.
        vec![hub(0.074, 0.096), half_limb(0.076, -upper_cut)],
        vec![
            ring(0.081, upper_cut, 0.02),
            limb(0.072, upper_cut, upper_arm),
            ball(0.077, upper_arm),
        ],
        // The forearm runs along +y.
        vec![hub(0.07, 0.09), half_limb(0.07, fore_cut)],
        vec![ring(0.075, fore_cut, 0.02), limb(0.058, fore_cut, forearm), ball(0.064, forearm)],
        // The flange extends along -y.
        vec![hub(0.058, 0.075), half_limb(0.054, -flange_cut)],
        vec![
            ring(0.051, flange_cut, 0.01),
            Shape::cylinder(Along::Z, 0.045, flange_cut, flange, GRAPHITE),
        ],
    ]
}

/// A primitive shape in its link frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Geometry.
    pub solid: Solid,
    /// Centre, in m.
    pub center_m: [f64; 3],
    pub(crate) paint: Paint,
}

/// A primitive solid about its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solid {
    /// A cylinder with flat ends.
    Cylinder {
        /// Axis of the cylinder.
        along: Along,
        /// Radius, in m.
        radius_m: f64,
        /// Length from end to end, in m.
        length_m: f64,
    },
    /// A sphere.
    Sphere {
        /// Radius, in m.
        radius_m: f64,
    },
}

/// An axis of a link frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// The y axis.
    Y,
    /// The z axis, about which the link rotates.
    Z,
}

/// A colour and its name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Paint {
    pub(crate) name: &'static str,
    pub(crate) rgba: &'static str,
}

const SILVER: Paint = Paint { name: "iiwa_silver", rgba: "0.78 0.79 0.8 1" };
const ORANGE: Paint = Paint { name: "iiwa_orange", rgba: "0.95 0.42 0.08 1" };
const GRAPHITE: Paint = Paint { name: "iiwa_graphite", rgba: "0.3 0.31 0.33 1" };

impl Shape {
    fn cylinder(along: Along, radius_m: f64, from: f64, to: f64, paint: Paint) -> Self {
        let middle = f64::midpoint(from, to);
        let center_m = match along {
            Along::Y => [0.0, middle, 0.0],
            Along::Z => [0.0, 0.0, middle],
        };
        let solid = Solid::Cylinder { along, radius_m, length_m: (to - from).abs() };
        Self { solid, center_m, paint }
    }

    fn sphere(radius_m: f64, height_m: f64, paint: Paint) -> Self {
        Self { solid: Solid::Sphere { radius_m }, center_m: [0.0, 0.0, height_m], paint }
    }
}

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
