//! Robot identity: model name and link lengths.

use std::fmt;

use iiwa_kin::{Lengths, Robot};
use serde::{Deserialize, Serialize};

use crate::message::{refusal::Refusal, text::shortened};

/// Tolerance of equal lengths, in mm.
const TOLERANCE_MM: f64 = 0.05;

/// Identity of a robot. Two robots are the same if their link lengths are equal: then equal joint
/// positions give equal TCP poses. Names and limits may differ, such as in a robot profile.
///
/// ```
/// use iiwa_kin::Robot;
/// use iiwa_link::message::RobotIdentity;
///
/// let small = RobotIdentity::from(&Robot::lbr_iiwa_7_r800());
/// assert_eq!(small.to_string(), "lbr_iiwa_7_r800 with a flange of 152 mm");
/// assert!(!small.is_same_arm(&RobotIdentity::from(&Robot::lbr_iiwa_14_r820())));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RobotIdentity {
    /// Name of the model or the profile.
    pub model: String,
    /// Link lengths.
    pub lengths_mm: LengthsMm,
}

/// Link lengths of a robot, in mm, as in robot profiles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LengthsMm {
    /// d1: base to shoulder.
    pub base: f64,
    /// d3: shoulder to elbow.
    pub upper_arm: f64,
    /// d5: elbow to wrist.
    pub forearm: f64,
    /// d7: wrist to flange face.
    pub flange: f64,
}

impl LengthsMm {
    fn all(self) -> [f64; 4] {
        [self.base, self.upper_arm, self.forearm, self.flange]
    }
}

impl RobotIdentity {
    /// Returns true if both robots have the same link lengths.
    #[must_use]
    pub fn is_same_arm(&self, other: &Self) -> bool {
        let mut lengths = self.lengths_mm.all().into_iter().zip(other.lengths_mm.all());
        lengths.all(|(a, b)| (a - b).abs() <= TOLERANCE_MM)
    }

    /// Checks that the drive controls the robot that a run was planned for.
    ///
    /// # Errors
    ///
    /// [`Code::BadRequest`](crate::message::Code::BadRequest) with both robots.
    pub fn check_run(&self, planned_for: &Self) -> Result<(), Refusal> {
        if self.is_same_arm(planned_for) {
            return Ok(());
        }
        Err(Refusal::bad(format!(
            "the program is for {planned_for}, and the drive controls {self}: plan it for that \
             robot, or start the drive with the robot that is there"
        )))
    }

    /// Checks that the robot at the cabinet matches the drive's.
    ///
    /// # Errors
    ///
    /// [`Code::Robot`](crate::message::Code::Robot) with both robots.
    pub fn check_cabinet(&self, at_cabinet: &Self) -> Result<(), Refusal> {
        if self.is_same_arm(at_cabinet) {
            return Ok(());
        }
        Err(Refusal::robot(format!(
            "the drive is set up for {self}, and the robot program reports {at_cabinet}: start the \
             drive with that robot, or correct the robot program's settings"
        )))
    }
}

impl From<&Robot> for RobotIdentity {
    fn from(robot: &Robot) -> Self {
        let Lengths { base_m, upper_arm_m, forearm_m, flange_m, .. } = *robot.lengths();
        // Rounded to a tenth of a micrometre: a length in m times 1000 may have many digits.
        let mm = |length_m: f64| (length_m * 1e7).round() / 1e4;
        let lengths_mm = LengthsMm {
            base: mm(base_m),
            upper_arm: mm(upper_arm_m),
            forearm: mm(forearm_m),
            flange: mm(flange_m),
        };
        Self { model: robot.name().to_owned(), lengths_mm }
    }
}

impl fmt::Display for RobotIdentity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let LengthsMm { base, upper_arm, forearm, flange } = self.lengths_mm;
        write!(f, "{} with a flange of {flange} mm", shortened(&self.model))?;
        // A profile name does not imply the lengths.
        let is_built_in = Robot::built_in(&self.model).is_some_and(|robot| {
            let lengths_mm = LengthsMm { flange, ..Self::from(&robot).lengths_mm };
            self.is_same_arm(&Self { lengths_mm, ..self.clone() })
        });
        if !is_built_in {
            write!(f, " (base {base} mm, upper arm {upper_arm} mm, forearm {forearm} mm)")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::Code;

    fn robots() -> [RobotIdentity; 4] {
        [Robot::lbr_iiwa_7_r800(), Robot::lbr_iiwa_14_r820()]
            .map(|robot| [robot.clone(), robot.with_flange_m(0.126).unwrap()])
            .map(|pair| pair.map(|robot| RobotIdentity::from(&robot)))
            .concat()
            .try_into()
            .unwrap()
    }

    #[test]
    fn each_model_and_flange_is_another_arm() {
        for (i, a) in robots().iter().enumerate() {
            for (j, b) in robots().iter().enumerate() {
                assert_eq!(a.is_same_arm(b), i == j, "{a}, {b}");
                let [run, cabinet] = [a.check_run(b), a.check_cabinet(b)];
                assert_eq!((run.is_ok(), cabinet.is_ok()), (i == j, i == j));
                for (refusal, code) in [(run, Code::BadRequest), (cabinet, Code::Robot)] {
                    let Err(refusal) = refusal else { continue };
                    assert_eq!(refusal.code, code);
                    assert!(refusal.message.contains(&a.to_string()), "{}", refusal.message);
                    assert!(refusal.message.contains(&b.to_string()), "{}", refusal.message);
                }
            }
        }
    }

    #[test]
    fn a_profile_of_the_same_lengths_is_the_same_arm() {
        let text =
            r#"{"version": 1, "name": "cell 3", "velocity_limit_deg_s": [9, 9, 9, 9, 9, 9, 9]}"#;
        let profile = RobotIdentity::from(&Robot::from_profile(text).unwrap());
        let [model, ..] = robots();
        model.check_run(&profile).unwrap();
        let text = "cell 3 with a flange of 152 mm (base 340 mm, upper arm 400 mm, forearm 400 mm)";
        assert_eq!(profile.to_string(), text);
    }

    #[test]
    fn it_is_read_as_written() {
        for robot in robots() {
            let text = serde_json::to_string(&robot).unwrap();
            assert_eq!(serde_json::from_str::<RobotIdentity>(&text).unwrap(), robot);
        }
        let missing = r#"{"model": "x", "lengths_mm": {"base": 1, "upper_arm": 1, "forearm": 1}}"#;
        assert!(serde_json::from_str::<RobotIdentity>(missing).is_err());
    }
}
