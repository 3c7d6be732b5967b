//! Plausibility checks of positions against a robot.

use iiwa_kin::{Joint, Robot};

use super::{JointLog, JointLogError};

/// Tolerance for measured positions outside the joint range, rad: half a degree.
const OUTSIDE_RAD: f64 = 0.009;

/// Time over which speeds are averaged, s, so that stamps in bursts cause no false alarms.
const STRETCH_S: f64 = 0.05;

/// Three times the highest joint speed of any LBR iiwa, 180 degrees per second.
const FASTEST_RAD_S: f64 = 3.0 * std::f64::consts::PI;

/// Accepted ratio of a joint speed to its limit.
const TOO_FAST: f64 = 1.5;

/// Extent above which a joint is considered to move, rad: some ten times the encoder noise and the
/// sway of the arm.
const STILL_RAD: f64 = 1e-3;

/// Longest plausible time between samples, s. The fastest robot logs at 1 kHz, the slowest useful
/// rate is some 50 Hz; mistaking milliseconds for seconds turns these periods into 1 s and 20 s.
const LONGEST_PERIOD_S: f64 = 0.4;

/// Shortest plausible time between samples, s: a thousandth of the period at 50 Hz is less.
const SHORTEST_PERIOD_S: f64 = 3e-5;

impl JointLog {
    /// Checks that the positions are possible for `robot`: the range of each joint, with a
    /// tolerance of half a degree, and one and a half times its speed limit, over sections of at
    /// least 0.05 s.
    ///
    /// The speed check detects degrees read as radians where the motion is too small for the range
    /// check.
    ///
    /// # Errors
    ///
    /// [`JointLogError::OutsideLimits`] and [`JointLogError::TooFast`] at the first sample that
    /// fails. [`JointLogError::WrongRobot`] if the recording names another built-in robot.
    pub fn check_robot(&self, robot: &Robot) -> Result<(), JointLogError> {
        if let Some(found) = self.other_robot(robot) {
            let expected = robot.name().to_owned();
            return Err(JointLogError::WrongRobot { found: found.to_owned(), expected });
        }
        let limits = robot.limits();
        for (&t_s, q_rad) in self.t_s.iter().zip(&self.q_rad) {
            for (joint, &found_rad) in Joint::ALL.into_iter().zip(q_rad) {
                let [lower, upper] = limits.range_rad(joint);
                // NaN is in no range.
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

    /// Returns the built-in robot that the recording names, if `robot` is another built-in one. A
    /// custom robot has the arm of a built-in one, and any name.
    #[must_use]
    pub fn other_robot(&self, robot: &Robot) -> Option<&str> {
        let built_in = |name: &str| Robot::BUILT_IN.contains(&name);
        let other = |recorded: &&str| *recorded != robot.name() && built_in(recorded);
        self.robot.as_deref().filter(other).filter(|_| built_in(robot.name()))
    }

    /// Checks that at least one joint moves by more than 1e-3 rad.
    ///
    /// # Errors
    ///
    /// [`JointLogError::NoMotion`] if no joint does.
    pub fn check_motion(&self) -> Result<(), JointLogError> {
        let max_rad = self.extent_rad();
        if max_rad > STILL_RAD {
            return Ok(());
        }
        Err(JointLogError::NoMotion { max_rad, duration_s: self.duration_s() })
    }

    /// Checks that the sample rate is plausible for a recorded motion: milliseconds or microseconds
    /// read as seconds make all speeds too small, and times that are too small may leave no section
    /// long enough to compute a speed.
    ///
    /// # Errors
    ///
    /// [`JointLogError::Rate`] if the median time between samples exceeds 0.4 s, or the mean is
    /// below 30 microseconds.
    pub fn check_rate(&self) -> Result<(), JointLogError> {
        let usual_s = self.period_s().filter(|period_s| *period_s > LONGEST_PERIOD_S);
        // The mean, not the median: stamps may come in bursts.
        let steps = self.t_s.len().saturating_sub(1);
        let mean_s = (steps > 0).then(|| self.duration_s() / steps as f64);
        let mean_s = mean_s.filter(|period_s| *period_s < SHORTEST_PERIOD_S);
        match usual_s.or(mean_s) {
            Some(period_s) => Err(JointLogError::Rate { period_s }),
            None => Ok(()),
        }
    }

    /// Largest difference between the extreme positions of any joint, rad.
    #[must_use]
    pub fn extent_rad(&self) -> f64 {
        let extent = |joint: usize| {
            let (mut min_rad, mut max_rad) = (f64::INFINITY, f64::NEG_INFINITY);
            for q_rad in &self.q_rad {
                (min_rad, max_rad) = (min_rad.min(q_rad[joint]), max_rad.max(q_rad[joint]));
            }
            max_rad - min_rad
        };
        (0..7).map(extent).fold(0.0, f64::max)
    }

    /// Checks that the speeds are possible for any LBR iiwa, which detects wrong units.
    pub(super) fn check_units(&self) -> Result<(), JointLogError> {
        self.check_speed(&[FASTEST_RAD_S; 7])
    }

    /// Compares the speed over consecutive sections with `max_rad_s`.
    fn check_speed(&self, max_rad_s: &[f64; 7]) -> Result<(), JointLogError> {
        let mut samples = self.t_s.iter().zip(&self.q_rad);
        let Some(mut from) = samples.next() else { return Ok(()) };
        for to in samples {
            let span_s = to.0 - from.0;
            if span_s < STRETCH_S {
                continue;
            }
            for (joint, &max_rad_s) in Joint::ALL.into_iter().zip(max_rad_s) {
                let found_rad_s = (to.1[joint.index()] - from.1[joint.index()]).abs() / span_s;
                if found_rad_s > max_rad_s {
                    return Err(JointLogError::TooFast {
                        joint,
                        t_s: 0.5 * (from.0 + to.0),
                        found_rad_s,
                        max_rad_s,
                    });
                }
            }
            from = to;
        }
        Ok(())
    }
}
