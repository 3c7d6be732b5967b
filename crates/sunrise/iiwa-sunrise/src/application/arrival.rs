//! End positions of motions.

use iiwa_kin::{
    Joints, Pose, Robot, Status,
    rotation::{Vec3, apply, cross, dot, exp, norm, product, scaled, sub, transposed},
};

/// Solves the inverse kinematics of a TCP at `pose`: with the given E1 and status, otherwise with
/// those at `from_rad`. Joints are in rad. The error is the reason.
pub(crate) fn joints_at(
    robot: &Robot,
    from_rad: &Joints,
    (pose, tcp): (&Pose, &Pose),
    e1_rad: Option<f64>,
    status: Option<Status>,
) -> Result<Joints, String> {
    let status = status.unwrap_or_else(|| Status::of(robot, from_rad));
    let flange = pose.then(&tcp.inverse());
    let joints = robot.inverse(&flange, e1_rad.unwrap_or(from_rad[2]), status);
    let joints = joints.map_err(|fault| fault.to_string())?;
    robot.limits().check(&joints).map_err(|fault| fault.to_string())?;
    Ok(joints)
}

/// Returns the TCP pose after an offset along the axes `axes`.
pub(crate) fn moved_by(from: &Pose, offset: &Pose, axes: &[Vec3<f64>; 3]) -> Pose {
    let by = apply(axes, &offset.position_m);
    let turn = product(&product(axes, &offset.rotation), &transposed(axes));
    Pose {
        position_m: std::array::from_fn(|i| from.position_m[i] + by[i]),
        rotation: product(&turn, &from.rotation),
    }
}

/// Returns the point on the circle through three points at an angle from the first point, in the
/// direction of the second; `None` if the points are collinear.
pub(crate) fn on_circle(points_m: [&Vec3<f64>; 3], angle_rad: f64) -> Option<Vec3<f64>> {
    let [from, aux, to] = points_m;
    let (u, v) = (sub(aux, from), sub(to, from));
    let normal = cross(&u, &v);
    let square = dot(&normal, &normal);
    if square <= f64::EPSILON * dot(&u, &u) * dot(&v, &v) {
        return None;
    }
    let a = scaled(dot(&v, &v) / (2.0 * square), &cross(&normal, &u));
    let b = scaled(dot(&u, &u) / (2.0 * square), &cross(&normal, &v));
    // Vector from the first point to the centre.
    let to_center = sub(&a, &b);
    let turn = exp(&scaled(angle_rad / norm(&normal), &normal));
    let arm = apply(&turn, &to_center);
    Some(std::array::from_fn(|i| from[i] + to_center[i] - arm[i]))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn half_a_circle_is_across() {
        let circle = on_circle([&[1.0, 0.0, 0.2], &[0.0, 1.0, 0.2], &[-1.0, 0.0, 0.2]], PI);
        let circle = circle.unwrap_or_default();
        assert!(norm(&sub(&circle, &[-1.0, 0.0, 0.2])) < 1e-12, "{circle:?}");
        let quarter = on_circle([&[1.0, 0.0, 0.0], &[0.0, -1.0, 0.0], &[-1.0, 0.0, 0.0]], 0.5 * PI);
        assert!(norm(&sub(&quarter.unwrap_or_default(), &[0.0, -1.0, 0.0])) < 1e-12);
    }

    #[test]
    fn points_on_a_line_have_no_circle() {
        assert_eq!(on_circle([&[0.0; 3], &[1.0, 0.0, 0.0], &[2.0, 0.0, 0.0]], 1.0), None);
    }
}
