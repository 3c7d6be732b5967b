//! How fast a joint may go and still come to rest in time.

/// The fastest that a joint may go over the next `step_s`, in rad/s, so that it comes to rest within
/// `room_rad` from where it is, when it brakes by `deceleration_rad_s2` from then on, step by step.
pub(crate) fn fastest(room_rad: f64, deceleration_rad_s2: f64, step_s: f64) -> f64 {
    // v h / 2 + v^2 / 2a is the way of this step and of those after it, each slower by a h.
    let half_s = 0.5 * step_s;
    let left = 2.0 * room_rad.max(0.0) / deceleration_rad_s2;
    deceleration_rad_s2 * ((half_s * half_s + left).sqrt() - half_s)
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
                let mut way = 0.0;
                while speed > 0.0 {
                    way += speed * step_s;
                    speed -= DECELERATION * step_s;
                }
                // But for what the last step, shorter than the others, takes.
                let most = room_rad + DECELERATION * step_s * step_s / 8.0 + 1e-12;
                assert!(way <= most, "{way} of {room_rad} rad at steps of {step_s} s");
            }
        }
    }
}
