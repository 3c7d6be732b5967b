//! Obstacles, prepared for distance queries.

use parry3d_f64::math::Vector;

use crate::scene::Form;

/// Obstacle in the base frame.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Placed {
    Box(PlacedBox),
    Plane(PlacedPlane),
}

/// Box by its centre, its axes and half of its edge lengths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedBox {
    center: Vector,
    axes: [Vector; 3],
    pub(crate) half: Vector,
}

/// Half-space of all points with `normal . x <= offset`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedPlane {
    pub(crate) normal: Vector,
    pub(crate) offset: f64,
}

impl Placed {
    pub(crate) fn new(form: &Form) -> Self {
        match *form {
            Form::Box { center_m, size_m, rpy_rad } => {
                let rows = rotation(rpy_rad).map(Vector::from);
                Self::Box(PlacedBox {
                    center: center_m.into(),
                    axes: std::array::from_fn(|i| Vector::new(rows[0][i], rows[1][i], rows[2][i])),
                    half: 0.5 * Vector::from(size_m),
                })
            }
            Form::Plane { point_m, normal } => {
                let normal = unit(normal);
                Self::Plane(PlacedPlane { normal, offset: normal.dot(point_m.into()) })
            }
        }
    }

    /// Returns the distance of `point` from the obstacle; 0 inside.
    pub(crate) fn distance(&self, point: Vector) -> f64 {
        match self {
            Self::Box(cuboid) => {
                let local = cuboid.in_box_frame(point);
                (local - cuboid.nearest(local)).length()
            }
            Self::Plane(plane) => (plane.normal.dot(point) - plane.offset).max(0.0),
        }
    }

    /// Returns the largest `direction . x` of the obstacle's points, for a `direction` from the
    /// obstacle to a part outside.
    pub(crate) fn farthest_along(&self, direction: Vector) -> f64 {
        match self {
            Self::Box(cuboid) => cuboid.farthest_along(direction),
            // Only called along the normal: a half-space is unbounded across it.
            Self::Plane(plane) => plane.offset,
        }
    }
}

impl PlacedBox {
    /// Transforms a point from the base frame to the box frame.
    pub(crate) fn in_box_frame(&self, point: Vector) -> Vector {
        self.turn_back(point - self.center)
    }

    /// Transforms a direction from the base frame to the box frame.
    pub(crate) fn turn_back(&self, direction: Vector) -> Vector {
        let [x, y, z] = self.axes;
        Vector::new(x.dot(direction), y.dot(direction), z.dot(direction))
    }

    /// Transforms a point from the box frame to the base frame.
    pub(crate) fn in_base_frame(&self, local: Vector) -> Vector {
        self.center + self.turn(local)
    }

    /// Transforms a direction from the box frame to the base frame.
    pub(crate) fn turn(&self, local: Vector) -> Vector {
        let [x, y, z] = self.axes;
        local.x * x + local.y * y + local.z * z
    }

    /// Returns the point of the box nearest to `local`, both in the box frame.
    pub(crate) fn nearest(&self, local: Vector) -> Vector {
        local.clamp(-self.half, self.half)
    }

    fn farthest_along(&self, direction: Vector) -> f64 {
        self.center.dot(direction) + self.half.dot(self.turn_back(direction).abs())
    }
}

/// Returns the rotation about x, then y, then z, the fixed axes of the reference frame, as three
/// rows.
pub(crate) fn rotation([roll, pitch, yaw]: [f64; 3]) -> [[f64; 3]; 3] {
    let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
}

/// Returns the unit vector along `normal`, for any length of `normal`.
pub(crate) fn unit(normal: [f64; 3]) -> Vector {
    let normal = Vector::from(normal);
    // Scaled first: squares of very large and very small numbers overflow or vanish.
    (normal / normal.abs().max_element()).normalize_or(Vector::Z)
}
