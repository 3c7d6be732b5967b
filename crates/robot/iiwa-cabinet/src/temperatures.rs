//! Simulated thermometers.

use iiwa_kin::Joints;

/// Room temperature, in degrees Celsius.
const ROOM_C: f64 = 25.0;
/// Final temperature rise of a joint in continuous motion at full speed, in K.
const HEATING_K: f64 = 25.0;
/// Time constant of warming up, in s.
const WARMING_S: f64 = 900.0;

/// Joint temperatures, heated by motion and cooled by the air. The model is plausible, not
/// measured.
#[derive(Clone, Debug)]
pub(crate) struct Temperatures(Joints);

impl Temperatures {
    pub(crate) fn new() -> Self {
        Self([ROOM_C; 7])
    }

    /// Advances by `dt_s` at velocities given as shares of the limits.
    pub(crate) fn advance(&mut self, speed_rel: &Joints, dt_s: f64) {
        for (temperature, speed) in self.0.iter_mut().zip(speed_rel) {
            let target = ROOM_C + HEATING_K * speed.abs();
            *temperature += (target - *temperature) * dt_s / WARMING_S;
        }
    }

    /// Returns the temperatures in degrees Celsius.
    pub(crate) fn celsius(&self) -> Joints {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_that_move_get_warmer() {
        let mut temperatures = Temperatures::new();
        for _ in 0..600 {
            temperatures.advance(&[1.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0], 1.0);
        }
        let [a1, a2, a3, ..] = temperatures.celsius();
        assert!(a1 > a2 && a2 > a3 && a3 == ROOM_C && a1 < ROOM_C + HEATING_K);
    }
}
