//! Boxes as obstacles, and around other shapes.

use parry3d_f64::math::Vector;

/// Box by its centre, its axes and half of its edge lengths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedBox {
    center: Vector,
    axes: [Vector; 3],
    pub(crate) half: Vector,
}

impl PlacedBox {
    /// Creates the box with this centre and these edge lengths, whose axes are the columns of
    /// `rows`.
    pub(crate) fn new(center_m: [f64; 3], size_m: [f64; 3], rows: [[f64; 3]; 3]) -> Self {
        Self {
            center: center_m.into(),
            axes: std::array::from_fn(|i| Vector::new(rows[0][i], rows[1][i], rows[2][i])),
            half: 0.5 * Vector::from(size_m),
        }
    }

    /// Creates the box between two corners, along the axes of the base.
    pub(crate) fn between(low: Vector, high: Vector) -> Self {
        let axes = [Vector::X, Vector::Y, Vector::Z];
        Self { center: 0.5 * (low + high), axes, half: 0.5 * (high - low) }
    }

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

    /// Returns the largest `direction . x` of the box's points.
    pub(crate) fn farthest_along(&self, direction: Vector) -> f64 {
        self.center.dot(direction) + self.half.dot(self.turn_back(direction).abs())
    }
}
