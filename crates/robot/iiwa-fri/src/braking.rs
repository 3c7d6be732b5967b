//! Braking of a joint before the end of its range.

/// Returns the largest velocity of a joint over the next `step_s`, in rad/s, from which the joint
/// can stop within `room_rad` of its position, with constant deceleration afterwards, in rad/s^2,
/// step by step.
#[must_use]
pub fn fastest(room_rad: f64, deceleration_rad_s2: f64, step_s: f64) -> f64 {
    // v h / 2 + v^2 / 2a is the distance of this step and the following ones, each slower by a h.
    let half_s = 0.5 * step_s;
    let margin = 2.0 * room_rad.max(0.0) / deceleration_rad_s2;
    deceleration_rad_s2 * ((half_s * half_s + margin).sqrt() - half_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fastest_speed_can_be_braked() {
        const DECELERATION: f64 = 8.5;
        for step_s in [1e-3, 5e-3, 0.05] {
            for room_rad in [0.0, 1e-6, 1e-3, 0.05, 0.2] {
                let mut speed = fastest(room_rad, DECELERATION, step_s);
                let mut distance = 0.0;
                while speed > 0.0 {
                    distance += speed * step_s;
                    speed -= DECELERATION * step_s;
                }
                // All of the room, up to the distance of the last step, which is shorter than the
                // others.
                let last_step = DECELERATION * step_s * step_s / 8.0 + 1e-12;
                assert!(
                    (distance - room_rad).abs() <= last_step,
                    "{distance} of {room_rad} rad at steps of {step_s} s"
                );
            }
        }
    }
}
