//! Denavit-Hartenberg parameters.

use nalgebra::Matrix4;

/// One row of a Denavit-Hartenberg table in the standard convention (Larsen 2019, Table 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DhRow {
    /// Link length a, in m.
    pub a_m: f64,
    /// Link twist alpha, in rad.
    pub alpha_rad: f64,
    /// Link offset d, in m.
    pub d_m: f64,
}

impl DhRow {
    /// Transform from this link's frame to the previous link's frame at joint angle `theta_rad`
    /// (Larsen 2019, Eq. 8; the factor `Rot_x` there has a shifted row, but the product is right).
    #[must_use]
    pub fn transform(&self, theta_rad: f64) -> Matrix4<f64> {
        let (st, ct) = theta_rad.sin_cos();
        let (sa, ca) = self.alpha_rad.sin_cos();
        Matrix4::new(
            ct,
            -st * ca,
            st * sa,
            self.a_m * ct,
            st,
            ct * ca,
            -ct * sa,
            self.a_m * st,
            0.0,
            sa,
            ca,
            self.d_m,
            0.0,
            0.0,
            0.0,
            1.0,
        )
    }
}
