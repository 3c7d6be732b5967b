//! Limits that are linear in the acceleration along the path and in the square of the speed.

use std::fmt;

use iiwa_kin::Joints;

/// A row at a place of a path, `a u + b x + c`, with the acceleration u along the path and the
/// square x of the speed. It is divided by its limit, and is feasible between -1 and 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathRow {
    /// Coefficient a of the acceleration.
    pub acceleration: f64,
    /// Coefficient b of the square of the speed.
    pub square: f64,
    /// Offset c: the share of the limit at rest.
    pub offset: f64,
}

impl PathRow {
    /// Share of the limit at a speed and an acceleration along the path.
    #[must_use]
    pub fn at(&self, speed: f64, acceleration: f64) -> f64 {
        self.acceleration * acceleration + self.square * speed * speed + self.offset
    }
}

/// A limit of a segment other than velocity, acceleration and jerk limits, as rows
/// `-1 <= a u + b x + c <= 1`.
///
/// With position q and its derivatives q' and q'' with respect to the path parameter, a limit of
/// `M(q) d2q/dt2 + h(q, dq/dt) + g(q)` with h quadratic in the velocity has `a = M q'`,
/// `b = M q'' + h(q, q')` and `c = g`, each over the limit. Examples are torques, accelerations of
/// a point of the robot, and linear combinations of joint accelerations.
pub trait RowLimit: fmt::Debug + Send + Sync {
    /// Number of rows at each place.
    fn row_count(&self) -> usize;

    /// Rows at places of a path, place after place, from the joint positions in rad and their first
    /// and second derivatives with respect to the path parameter.
    fn rows(
        &self,
        joints_rad: &[Joints],
        derivative: &[Joints],
        second_derivative: &[Joints],
    ) -> Vec<PathRow>;

    /// Shares of the limits at instants of a motion, instant after instant: joints in rad,
    /// velocities in rad/s, accelerations in rad/s^2.
    fn shares(
        &self,
        joints_rad: &[Joints],
        velocity_rad_s: &[Joints],
        acceleration_rad_s2: &[Joints],
    ) -> Vec<f64> {
        // With time as the path parameter, the speed is 1 and the acceleration 0.
        let rows = self.rows(joints_rad, velocity_rad_s, acceleration_rad_s2);
        rows.iter().map(|row| row.at(1.0, 0.0)).collect()
    }
}

/// All further limits of a segment.
#[derive(Debug, Default)]
pub struct RowLimits {
    limits: Vec<Box<dyn RowLimit>>,
    count: usize,
}

impl RowLimits {
    /// Concatenates the rows of all limits, in order.
    #[must_use]
    pub fn new(limits: Vec<Box<dyn RowLimit>>) -> Self {
        let count = limits.iter().map(|limit| limit.row_count()).sum();
        Self { limits, count }
    }

    /// Number of rows at each place.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Rows at places of a path, place after place: see [`RowLimit::rows`].
    #[must_use]
    pub fn rows(
        &self,
        joints_rad: &[Joints],
        derivative: &[Joints],
        second_derivative: &[Joints],
    ) -> Vec<PathRow> {
        let rows_of = |limit: &dyn RowLimit| limit.rows(joints_rad, derivative, second_derivative);
        self.joined(joints_rad.len(), rows_of)
    }

    /// Shares of the limits at instants of a motion, instant after instant: see
    /// [`RowLimit::shares`].
    #[must_use]
    pub fn shares(
        &self,
        joints_rad: &[Joints],
        velocity_rad_s: &[Joints],
        acceleration_rad_s2: &[Joints],
    ) -> Vec<f64> {
        let bends_of =
            |limit: &dyn RowLimit| limit.shares(joints_rad, velocity_rad_s, acceleration_rad_s2);
        self.joined(joints_rad.len(), bends_of)
    }

    /// Values of all limits, place after place.
    fn joined<T: Copy>(
        &self,
        places: usize,
        values_of: impl Fn(&dyn RowLimit) -> Vec<T>,
    ) -> Vec<T> {
        if let [limit] = self.limits.as_slice() {
            return values_of(limit.as_ref());
        }
        let values: Vec<(usize, Vec<T>)> = self
            .limits
            .iter()
            .map(|limit| (limit.row_count(), values_of(limit.as_ref())))
            .collect();
        let at = |place: usize| {
            values.iter().flat_map(move |(count, rows)| &rows[place * count..(place + 1) * count])
        };
        (0..places).flat_map(at).copied().collect()
    }
}
