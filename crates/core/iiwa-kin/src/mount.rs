//! Mounting of the robot.

use std::str::FromStr;

use crate::{load::numbers, trig};

/// Acceleration of gravity, in m/s^2, as robot controllers use it.
const GRAVITY_M_S2: f64 = 9.81;

/// Orientation of the robot base in the world, whose z axis points up; on the floor by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mount {
    /// Roll, pitch and yaw, in rad: R = Rz(yaw) Ry(pitch) Rx(roll), as in a URDF.
    pub rpy_rad: [f64; 3],
}

/// Parses `ROLL,PITCH,YAW` in degrees.
impl FromStr for Mount {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let angles = numbers(text)?.try_into();
        let rpy_deg = angles.map_err(|_| "expected roll, pitch and yaw in degrees")?;
        Ok(Self::from_rpy_deg(rpy_deg))
    }
}

impl Mount {
    /// Mounting at roll, pitch and yaw in degrees.
    ///
    /// ```
    /// use iiwa_kin::Mount;
    ///
    /// // On the ceiling, and on a wall with the base x axis pointing down.
    /// assert!((Mount::from_rpy_deg([180.0, 0.0, 0.0]).gravity_m_s2()[2] - 9.81).abs() < 1e-12);
    /// assert!((Mount::from_rpy_deg([0.0, 90.0, 0.0]).gravity_m_s2()[0] - 9.81).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn from_rpy_deg(rpy_deg: [f64; 3]) -> Self {
        Self { rpy_rad: rpy_deg.map(f64::to_radians) }
    }

    /// Gravity vector in the base frame, in m/s^2.
    #[must_use]
    pub fn gravity_m_s2(&self) -> [f64; 3] {
        let ([roll_sin, pitch_sin, _], [roll_cos, pitch_cos, _]) = trig::sin_cos(&self.rpy_rad);
        [pitch_sin, -pitch_cos * roll_sin, -pitch_cos * roll_cos].map(|part| part * GRAVITY_M_S2)
    }
}
