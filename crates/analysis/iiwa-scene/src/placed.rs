//! Obstacles, prepared for distances.

use parry3d_f64::math::Vector;

use crate::scene::Form;

/// An obstacle in the base frame.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Placed {
    Box(PlacedBox),
    Plane(PlacedPlane),
}

/// A box by its centre, its axes and half of its edges.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedBox {
    center: Vector,
    axes: [Vector; 3],
    pub(crate) half: Vector,
}

/// All points with `normal . x <= offset`.
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

    /// How far `point` is from the obstacle; 0 within.
    pub(crate) fn distance(&self, point: Vector) -> f64 {
        match self {
            Self::Box(cuboid) => {
                let local = cuboid.in_own_frame(point);
                (local - cuboid.nearest(local)).length()
            }
            Self::Plane(plane) => (plane.normal.dot(point) - plane.offset).max(0.0),
        }
    }

    /// The largest `direction . x` of its points, for a `direction` from it to a part that is outside.
    pub(crate) fn farthest_along(&self, direction: Vector) -> f64 {
        match self {
            Self::Box(cuboid) => cuboid.farthest_along(direction),
            // Only ever asked along the normal: across it there is no end to a half-space.
            Self::Plane(plane) => plane.offset,
        }
    }
}

impl PlacedBox {
    /// A point of the base frame in the box's own.
    pub(crate) fn in_own_frame(&self, point: Vector) -> Vector {
        self.turn_back(point - self.center)
    }

    /// A direction of the base frame in the box's own.
    pub(crate) fn turn_back(&self, direction: Vector) -> Vector {
        let [x, y, z] = self.axes;
        Vector::new(x.dot(direction), y.dot(direction), z.dot(direction))
    }

    /// A point of the box's own frame in that of the base.
    pub(crate) fn in_base_frame(&self, local: Vector) -> Vector {
        self.center + self.turn(local)
    }

    /// A direction of the box's own frame in that of the base.
    pub(crate) fn turn(&self, local: Vector) -> Vector {
        let [x, y, z] = self.axes;
        local.x * x + local.y * y + local.z * z
    }

    /// The point of the box that is nearest to `local`, both in its own frame.
    pub(crate) fn nearest(&self, local: Vector) -> Vector {
        local.clamp(-self.half, self.half)
    }

    fn farthest_along(&self, direction: Vector) -> f64 {
        self.center.dot(direction) + self.half.dot(self.turn_back(direction).abs())
    }
}

/// The turn about x, then y, then z, all of them axes of the frame that is turned in: three rows.
pub(crate) fn rotation([roll, pitch, yaw]: [f64; 3]) -> [[f64; 3]; 3] {
    let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
    [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
}

/// The direction of `normal`, however long or short that is.
pub(crate) fn unit(normal: [f64; 3]) -> Vector {
    let normal = Vector::from(normal);
    // Squares of huge and of tiny numbers are none.
    (normal / normal.abs().max_element()).normalize_or(Vector::Z)
}
