//! Start and end of a motion, from the commanded joint positions, which are free of noise.

use iiwa_kin::Joints;

use super::events::Observation;

/// Start and end of a motion, exact to one cycle. The start is the time stamp of the last message
/// before the first change, the end is the time stamp of the first message with the final value.
#[derive(Debug, Default)]
pub(super) struct CommandedTimes {
    /// The current value, and the stamps of the first and of the last message with this value, in
    /// s.
    held: Option<(Joints, f64, f64)>,
    /// The start, in s.
    start_s: Option<f64>,
    /// Messages since the last change.
    unchanged: u32,
}

/// Threshold below which positions count as equal, in rad: far less than a joint moves in the first
/// millisecond.
const SAME_RAD: f64 = 1e-10;

impl CommandedTimes {
    /// Takes a message into account.
    pub(super) fn observe(&mut self, observation: &Observation) {
        let (Some(rad), t_s) = (observation.commanded_rad, observation.t_s) else { return };
        match &mut self.held {
            Some((held, _, last_s)) if is_same(held, &rad) => {
                *last_s = t_s;
                self.unchanged += 1;
            }
            held => {
                if let Some((.., last_s)) = held {
                    self.start_s.get_or_insert(*last_s);
                }
                *held = Some((rad, t_s, t_s));
                self.unchanged = 0;
            }
        }
    }

    /// Returns true if at least `messages` messages have the current value, or if the messages
    /// contain no commanded positions: then no end is awaited.
    pub(super) fn is_unchanged_for(&self, messages: u32) -> bool {
        self.held.is_none() || self.unchanged >= messages
    }

    /// Returns start and end, in s.
    ///
    /// # Errors
    ///
    /// The messages contain no commanded positions, or the positions did not change.
    pub(super) fn times_s(&self) -> Result<[f64; 2], &'static str> {
        let Some((_, end_s, _)) = self.held else {
            return Err("the robot program tells no times, and FRI sends no commanded positions");
        };
        let start_s = self.start_s.ok_or("the commanded positions did not change")?;
        Ok([start_s, end_s])
    }
}

fn is_same(a: &Joints, b: &Joints) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME_RAD)
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use iiwa_fri::{Quality, Safety, SessionState};

    use super::*;

    fn observation(t_s: f64, commanded_rad: Option<f64>) -> Observation {
        Observation {
            t_s,
            clock_ahead_s: 0.0,
            joints_rad: [0.0; 7],
            commanded_rad: commanded_rad.map(|rad| [rad; 7]),
            torques_nm: None,
            session: SessionState::MonitoringReady,
            quality: Quality::Excellent,
            safety: Safety::Normal,
            lost: 0,
            late: 0,
            at: Instant::now(),
        }
    }

    fn times_of(values: &[f64]) -> CommandedTimes {
        let mut times = CommandedTimes::default();
        for (i, value) in (0_u32..).zip(values) {
            times.observe(&observation(f64::from(i), Some(*value)));
        }
        times
    }

    #[test]
    fn a_motion_begins_before_its_first_change_and_ends_with_its_last() {
        let times = times_of(&[0.5, 0.5, 0.5, 0.6, 0.7, 0.7, 0.8, 0.8, 0.8]);
        assert_eq!(times.times_s(), Ok([2.0, 6.0]));
        assert!(times.is_unchanged_for(2) && !times.is_unchanged_for(3));
    }

    #[test]
    fn a_motion_back_to_its_start_has_times() {
        assert_eq!(times_of(&[0.5, 0.6, 0.5, 0.5]).times_s(), Ok([0.0, 2.0]));
    }

    #[test]
    fn rounding_is_no_motion_and_a_slow_one_is() {
        assert!(times_of(&[0.5, 0.5 + 1e-12, 0.5]).times_s().is_err());
        let slow: Vec<f64> = (0..10).map(|i| f64::from(i) * 6e-11).collect();
        assert!(times_of(&slow).times_s().is_ok());
    }

    #[test]
    fn missing_commanded_positions_are_reported() {
        let mut times = CommandedTimes::default();
        times.observe(&observation(0.0, None));
        assert!(times.times_s().unwrap_err().contains("FRI sends no commanded positions"));
    }
}
