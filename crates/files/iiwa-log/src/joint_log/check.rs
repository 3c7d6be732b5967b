//! Whether positions can be those of a robot.

use iiwa_kin::{Joint, Robot};

use super::{JointLog, JointLogError};

/// How far outside its range a joint may be measured, rad: half a degree.
const OUTSIDE_RAD: f64 = 0.009;

/// Speeds are taken over this long, s, so that stamps that come in bursts do no harm.
const STRETCH_S: f64 = 0.05;

/// Three times the fastest speed of any LBR iiwa, 180 degrees a second.
const FASTEST_RAD_S: f64 = 3.0 * std::f64::consts::PI;

/// How many times its limit of speed a joint may have.
const TOO_FAST: f64 = 1.5;

/// A motion that is not wider is none: some ten times an encoder's noise and an arm's sway, rad.
const STILL_RAD: f64 = 1e-3;

/// Samples farther apart than this show no motion, s: the fastest robot logs at 1 kHz, the slowest that
/// can be evaluated at some 50 Hz, and a thousand times these are 1 s and 20 s.
const LONGEST_PERIOD_S: f64 = 0.4;

/// Nothing records joints so often, s: a thousandth of the time between samples at 50 Hz is less.
const SHORTEST_PERIOD_S: f64 = 3e-5;

impl JointLog {
    /// Whether the positions can be those of `robot`: its range of each joint, with half a degree to
    /// spare, and one and a half times its limit of speed, over sections of 0.05 s and more.
    ///
    /// The limit of speed finds degrees that were taken for radians where the motion is so small that
    /// the range does not.
    ///
    /// # Errors
    ///
    /// [`JointLogError::OutsideLimits`] and [`JointLogError::TooFast`] at the first sample that does
    /// not fit. [`JointLogError::WrongRobot`] when the recording names another built-in robot.
    pub fn check_robot(&self, robot: &Robot) -> Result<(), JointLogError> {
        if let Some(found) = self.other_robot(robot) {
            let expected = robot.name().to_owned();
            return Err(JointLogError::WrongRobot { found: found.to_owned(), expected });
        }
        let limits = robot.limits();
        for (&t_s, q_rad) in self.t_s.iter().zip(&self.q_rad) {
            for (joint, &found_rad) in Joint::ALL.into_iter().zip(q_rad) {
                let [lower, upper] = limits.range_rad(joint);
                // What is not a number is in no range.
                if !(lower - OUTSIDE_RAD..=upper + OUTSIDE_RAD).contains(&found_rad) {
                    return Err(JointLogError::OutsideLimits {
                        robot: robot.name().to_owned(),
                        joint,
                        t_s,
                        found_rad,
                        limit_rad: if found_rad < lower { lower } else { upper },
                    });
                }
            }
        }
        self.check_speed(&limits.velocity_rad_s.map(|limit| TOO_FAST * limit))
    }

    /// The built-in robot that the recording names, if `robot` is another built-in one. A robot of one's
    /// own has the arm of a built-in one, and any name.
    #[must_use]
    pub fn other_robot(&self, robot: &Robot) -> Option<&str> {
        let built_in = |name: &str| Robot::BUILT_IN.contains(&name);
        let other = |found: &&str| *found != robot.name() && built_in(found);
        self.robot.as_deref().filter(other).filter(|_| built_in(robot.name()))
    }

    /// Whether any joint moves by more than 1e-3 rad.
    ///
    /// # Errors
    ///
    /// [`JointLogError::NoMotion`] if none does.
    pub fn check_motion(&self) -> Result<(), JointLogError> {
        let most_rad = self.extent_rad();
        if most_rad > STILL_RAD {
            return Ok(());
        }
        Err(JointLogError::NoMotion { most_rad, duration_s: self.duration_s() })
    }

    /// Whether the samples follow each other as those of a recorded motion do: a time in milliseconds or
    /// microseconds that was taken for seconds makes all speeds too small, and a time that is too small
    /// may leave nothing that is long enough to have a speed.
    ///
    /// # Errors
    ///
    /// [`JointLogError::Rate`] if they usually are more than 0.4 s apart, or less than 30 microseconds
    /// on average.
    pub fn check_rate(&self) -> Result<(), JointLogError> {
        let usual_s = self.period_s().filter(|period_s| *period_s > LONGEST_PERIOD_S);
        // Not the usual one: stamps may come in bursts.
        let steps = self.t_s.len().saturating_sub(1);
        let mean_s = (steps > 0).then(|| self.duration_s() / steps as f64);
        let mean_s = mean_s.filter(|period_s| *period_s < SHORTEST_PERIOD_S);
        match usual_s.or(mean_s) {
            Some(period_s) => Err(JointLogError::Rate { period_s }),
            None => Ok(()),
        }
    }

    /// How far the joint that moves most is between its ends, rad.
    #[must_use]
    pub fn extent_rad(&self) -> f64 {
        let extent = |joint: usize| {
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            for q_rad in &self.q_rad {
                (least, most) = (least.min(q_rad[joint]), most.max(q_rad[joint]));
            }
            most - least
        };
        (0..7).map(extent).fold(0.0, f64::max)
    }

    /// Whether the positions can be those of any LBR iiwa, by their speed.
    pub(super) fn check_units(&self) -> Result<(), JointLogError> {
        self.check_speed(&[FASTEST_RAD_S; 7])
    }

    /// Holds the speed over sections that follow each other against `most_rad_s`.
    fn check_speed(&self, most_rad_s: &[f64; 7]) -> Result<(), JointLogError> {
        let mut samples = self.t_s.iter().zip(&self.q_rad);
        let Some(mut from) = samples.next() else { return Ok(()) };
        for to in samples {
            let span_s = to.0 - from.0;
            if span_s < STRETCH_S {
                continue;
            }
            for (joint, &most_rad_s) in Joint::ALL.into_iter().zip(most_rad_s) {
                let found_rad_s = (to.1[joint.index()] - from.1[joint.index()]).abs() / span_s;
                if found_rad_s > most_rad_s {
                    return Err(JointLogError::TooFast {
                        joint,
                        t_s: 0.5 * (from.0 + to.0),
                        found_rad_s,
                        most_rad_s,
                    });
                }
            }
            from = to;
        }
        Ok(())
    }
}
