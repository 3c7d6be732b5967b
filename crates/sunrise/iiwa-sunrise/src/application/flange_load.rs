//! Combined load of several bodies at the flange.

use iiwa_kin::{
    Load, Pose, RigidBody,
    rotation::{Mat3, apply, product, transposed},
};
use iiwa_program::Frame;

/// Combines loads, each given in its own frame relative to the flange, into one; `None` without
/// loads.
pub(crate) fn together(loads: &[(Frame, Load)]) -> Option<Load> {
    match loads {
        [] => None,
        // A load given in the flange frame keeps its numbers as written.
        [(frame, load)] if *frame == Frame::default() => Some(*load),
        _ => {
            let bodies = loads.iter().map(|(frame, load)| moved(&frame.pose(), &load.body()));
            bodies.reduce(|all, body| all.with(&body)).map(|body| as_load(&body))
        }
    }
}

/// Transforms a body by `pose`.
fn moved(pose: &Pose, body: &RigidBody) -> RigidBody {
    let [xx, xy, xz, yy, yz, zz] = body.inertia_kg_m2;
    let inertia = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let turned = product(&product(&pose.rotation, &inertia), &transposed(&pose.rotation));
    let center = apply(&pose.rotation, &body.center_m);
    RigidBody {
        mass_kg: body.mass_kg,
        center_m: std::array::from_fn(|i| pose.position_m[i] + center[i]),
        inertia_kg_m2: six(&turned),
    }
}

fn six(i: &Mat3<f64>) -> [f64; 6] {
    [i[0][0], i[0][1], i[0][2], i[1][1], i[1][2], i[2][2]]
}

/// Converts a body to a load with principal axes.
fn as_load(body: &RigidBody) -> Load {
    let [xx, xy, xz, yy, yz, zz] = body.inertia_kg_m2;
    let (moments, axes) = principal([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
    Load {
        mass_kg: body.mass_kg,
        center_mm: body.center_m.map(|m| 1e3 * m),
        inertia_kg_m2: moments,
        abc_rad: Pose { position_m: [0.0; 3], rotation: axes }.abc_rad(),
    }
}

/// Returns the eigenvalues of a symmetric matrix, and the rotation whose columns are its
/// eigenvectors, by Jacobi rotations, which keep a matrix that is diagonal up to rounding.
fn principal(mut i: Mat3<f64>) -> ([f64; 3], Mat3<f64>) {
    /// Maximum number of sweeps: convergence is quadratic, and a few are enough.
    const SWEEPS: usize = 30;
    /// Off-diagonal elements below this fraction of the diagonal are rounding errors.
    const ROUNDING: f64 = 1e-15;
    let mut axes = Pose::IDENTITY.rotation;
    for _ in 0..SWEEPS {
        let size = i[0][0].abs() + i[1][1].abs() + i[2][2].abs();
        let mut is_diagonal = true;
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if i[p][q].abs() <= ROUNDING * size {
                continue;
            }
            is_diagonal = false;
            // Of the two rotations that zero this element, the smaller one.
            let angle = 0.5 * (2.0 * i[p][q]).atan2(i[q][q] - i[p][p]);
            let angle = if angle.abs() > std::f64::consts::FRAC_PI_4 {
                angle - std::f64::consts::FRAC_PI_2.copysign(angle)
            } else {
                angle
            };
            let (sin, cos) = angle.sin_cos();
            let mut turn = Pose::IDENTITY.rotation;
            (turn[p][p], turn[q][q], turn[p][q], turn[q][p]) = (cos, cos, sin, -sin);
            i = product(&product(&transposed(&turn), &i), &turn);
            axes = product(&axes, &turn);
        }
        if is_diagonal {
            break;
        }
    }
    ([i[0][0], i[1][1], i[2][2]], axes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_on_one_axis_keep_their_axes() {
        let tool = Load { mass_kg: 2.0, center_mm: [0.0, 0.0, 50.0], ..Load::default() };
        let part = Load { mass_kg: 2.0, center_mm: [0.0, 0.0, 10.0], ..Load::default() };
        let grip = Frame { xyz_mm: [0.0, 0.0, 140.0], abc_rad: [0.0; 3] };
        let both = together(&[(Frame::default(), tool), (grip, part)]).unwrap_or_default();
        assert!((both.center_mm[2] - 100.0).abs() < 1e-9);
        // Each centre is 50 mm from the combined centre.
        assert!(
            (both.inertia_kg_m2[0] - 0.01).abs() < 1e-12 && both.inertia_kg_m2[2].abs() < 1e-15
        );
        assert_eq!(both.abc_rad, [0.0; 3]);
    }

    /// The combined load describes the same body, whatever its axes.
    #[test]
    fn principal_axes_describe_the_same_body() {
        let tool = Load {
            mass_kg: 1.5,
            center_mm: [10.0, -4.0, 60.0],
            inertia_kg_m2: [0.01, 0.02, 0.015],
            abc_rad: [0.3, -0.2, 1.1],
        };
        let part = Load { mass_kg: 0.8, center_mm: [5.0, 20.0, 0.0], ..tool };
        let grip = Frame { xyz_mm: [30.0, 0.0, 140.0], abc_rad: [0.5, 1.0, -0.7] };
        let expected = tool.body().with(&moved(&grip.pose(), &part.body()));
        let combined =
            together(&[(Frame::default(), tool), (grip, part)]).unwrap_or_default().body();
        for (actual, expected) in combined.inertia_kg_m2.iter().zip(expected.inertia_kg_m2) {
            assert!((actual - expected).abs() < 1e-12, "{actual} {expected}");
        }
    }
}
