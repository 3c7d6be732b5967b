//! Samples in file order, each compared with the previous one.

use iiwa_kin::Joint;

use super::{FilePlace, JointLog, JointLogError, Loss, PositionSource};

/// Bound on joint positions, rad. The widest joint range of any LBR iiwa is 175 degrees (3.054
/// rad); the margin is for joints measured slightly outside their range.
const REACH_RAD: f64 = 3.2;

/// A step this many times the median one is a gap: two samples are missing, rather than one being
/// late.
const GAP_STEPS: f64 = 2.5;

/// The unit of a joint's positions in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum PositionUnit {
    #[default]
    Radians,
    Degrees,
    /// Radians, unless a position is beyond every joint range in rad: then degrees.
    Unstated,
}

/// Collects samples in the order of the file.
#[derive(Debug, Default)]
pub(super) struct SampleCollector {
    log: JointLog,
    /// Loss by repeated samples.
    repeated: Option<Loss>,
    units: [PositionUnit; 7],
    /// Assumption of degrees for positions without a unit, if made.
    assumed: Option<Loss>,
}

impl SampleCollector {
    pub(super) fn new(source: PositionSource, units: [PositionUnit; 7]) -> Self {
        let log = JointLog { source: Some(source), ..JointLog::default() };
        Self { log, units, ..Self::default() }
    }

    pub(super) fn log(&mut self) -> &mut JointLog {
        &mut self.log
    }

    pub(super) fn len(&self) -> u64 {
        self.log.t_s.len() as u64
    }

    /// Converts positions without a unit from degrees if one of them is beyond every joint range in
    /// rad, including those of earlier samples.
    fn assume_degrees(&mut self, place: FilePlace, degrees: &[f64; 7]) {
        // The names of a table can state a unit: one damaged value must not change that of all
        // others.
        if self.log.source == Some(PositionSource::Table) {
            return;
        }
        let is_far =
            |(unit, q): (PositionUnit, f64)| unit == PositionUnit::Unstated && q.abs() > REACH_RAD;
        let Some(far) = self.units.into_iter().zip(*degrees).position(is_far) else { return };
        let joint = Joint::ALL[far].number();
        self.assumed = Some(Loss::DegreesAssumed { place, joint, found_deg: degrees[far] });
        for (j, unit) in
            self.units.iter_mut().enumerate().filter(|it| *it.1 == PositionUnit::Unstated)
        {
            *unit = PositionUnit::Degrees;
            self.log.q_rad.iter_mut().for_each(|q| q[j] = q[j].to_radians());
        }
    }

    /// Adds a sample: a finite time, and positions in the units of the file.
    pub(super) fn push(
        &mut self,
        place: FilePlace,
        t_s: f64,
        positions: [f64; 7],
    ) -> Result<(), JointLogError> {
        self.assume_degrees(place, &positions);
        let mut q_rad = positions;
        for (q, unit) in q_rad.iter_mut().zip(self.units) {
            if unit == PositionUnit::Degrees {
                *q = q.to_radians();
            }
        }
        // Not `any(|q| q > REACH)`: that would accept NaN.
        if !q_rad.iter().all(|q| q.abs() <= REACH_RAD) {
            return Err(self.out_of_reach(place, &q_rad));
        }
        if let (Some(&last_s), Some(last_rad)) = (self.log.t_s.last(), self.log.q_rad.last()) {
            if t_s < last_s {
                return Err(JointLogError::Backwards { place, t_s, previous_s: last_s });
            }
            if t_s == last_s {
                if q_rad != *last_rad {
                    return Err(JointLogError::SameTime { place, t_s });
                }
                match &mut self.repeated {
                    Some(Loss::Repeated { count, .. }) => *count += 1,
                    other => *other = Some(Loss::Repeated { first: place, t_s, count: 1 }),
                }
                return Ok(());
            }
        }
        self.log.t_s.push(t_s);
        self.log.q_rad.push(q_rad);
        Ok(())
    }

    /// Adds torques, in Nm, to the last sample.
    pub(super) fn add_torques(&mut self, torques_nm: [f64; 7]) {
        self.log.torques_nm.resize(self.log.t_s.len(), None);
        if let Some(last) = self.log.torques_nm.last_mut() {
            *last = Some(torques_nm);
        }
    }

    fn out_of_reach(&self, place: FilePlace, q_rad: &[f64; 7]) -> JointLogError {
        let joints = Joint::ALL.into_iter().zip(q_rad).zip(self.units);
        for ((joint, &found_rad), unit) in joints {
            if !found_rad.is_finite() {
                return JointLogError::NotFinite { place, joint, found_rad };
            }
            if found_rad.abs() > REACH_RAD {
                return if unit == PositionUnit::Degrees {
                    let found_deg = found_rad.to_degrees();
                    JointLogError::OutOfReach { place, joint, found_deg }
                } else {
                    JointLogError::Degrees { place, joint, found_rad }
                };
            }
        }
        JointLogError::NoSamples
    }

    /// Returns the log with its gaps, and `end`, the loss at the end of the file.
    pub(super) fn finish(mut self, end: Option<Loss>) -> Result<JointLog, JointLogError> {
        if self.log.t_s.is_empty() {
            return Err(JointLogError::NoSamples);
        }
        if !self.log.torques_nm.is_empty() {
            self.log.torques_nm.resize(self.log.t_s.len(), None);
        }
        let is_unstated = self.units.contains(&PositionUnit::Unstated);
        if self.log.source == Some(PositionSource::Table) && is_unstated {
            self.log.losses.push(Loss::RadiansAssumed);
        }
        self.log.losses.extend(self.assumed);
        self.log.losses.extend(self.repeated);
        add_gaps(&mut self.log);
        self.log.losses.extend(end);
        Ok(self.log)
    }
}

fn add_gaps(log: &mut JointLog) {
    let Some(usual_s) = log.period_s() else { return };
    for pair in log.t_s.windows(2) {
        let &[from_s, to_s] = pair else { continue };
        let steps = (to_s - from_s) / usual_s;
        if steps > GAP_STEPS {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "above 1, and a count that is too large for an integer becomes the largest"
            )]
            let missing = steps.round() as u64 - 1;
            log.losses.push(Loss::Gap { from_s, to_s, missing });
        }
    }
}
