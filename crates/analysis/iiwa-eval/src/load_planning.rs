//! Effect of a stated payload on a planner.

use std::str::FromStr;

use iiwa_kin::Robot;
use iiwa_plan::PlanOptions;
use iiwa_program::{Motion, Program, Start};
use iiwa_traj::{PlanError, Timing};

/// Planning of PTP motions with a payload by a virtual robot. KUKA does not publish how its
/// controller plans them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum LoadPlanning {
    /// The payload has no effect.
    #[default]
    Ignored,
    /// All accelerations are lower by this share for each kg.
    FactorPerKg(f64),
    /// The accelerations of each motion are scaled such that no joint exceeds this share of its
    /// torque limit.
    Torque(f64),
}

/// Parses the names `none`, `factor` (2 % per kg) and `torque` (the full torque limits).
impl FromStr for LoadPlanning {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "none" => Ok(Self::Ignored),
            "factor" => Ok(Self::FactorPerKg(0.02)),
            "torque" => Ok(Self::Torque(1.0)),
            _ => Err("expected `none`, `factor` or `torque`".to_owned()),
        }
    }
}

/// Number of bisection steps for the share of the acceleration.
const SHARE_STEPS: i32 = 20;

/// Minimum share of the acceleration.
const MIN_SHARE: f64 = 0.05;

impl LoadPlanning {
    /// Returns the program with the accelerations that such a planner uses, for each PTP motion
    /// separately.
    ///
    /// # Errors
    ///
    /// If a motion cannot be planned.
    pub fn slowed(self, program: &Program, robot: &Robot) -> Result<Program, PlanError> {
        let mut slowed = program.clone();
        if self == Self::Ignored {
            return Ok(slowed);
        }
        let loads = program.loads();
        let mut at_rad = *PlanOptions::with_timing(Timing::jerk_limited())
            .plan(program, robot)?
            .path()
            .start_rad();
        for (motion, load) in slowed.motions.iter_mut().zip(loads) {
            let Motion::Ptp(ptp) = motion else { continue };
            let share = match self {
                Self::Ignored => 1.0,
                Self::FactorPerKg(per_kg) => {
                    let mass_kg = load.map_or(0.0, |load| load.mass_kg);
                    (1.0 - per_kg * mass_kg).max(MIN_SHARE)
                }
                Self::Torque(limit_rel) => {
                    let mut alone = program.clone();
                    alone.start = Start::Joints(at_rad);
                    let needs = |share: f64| {
                        let mut motion = ptp.clone();
                        motion.acceleration_rel = motion.acceleration_rel.map(|rel| share * rel);
                        motion.blend = None;
                        let carried = Motion::Load(load.map(Into::into));
                        alone.motions = vec![carried, Motion::Ptp(motion)];
                        let plan =
                            PlanOptions::with_timing(Timing::jerk_limited()).plan(&alone, robot)?;
                        let peaks = plan.torques().motions.into_iter().flat_map(|m| m.peak_rel);
                        Ok::<f64, PlanError>(peaks.fold(0.0, f64::max))
                    };
                    share_within(limit_rel, needs)?
                }
            };
            ptp.acceleration_rel = ptp.acceleration_rel.map(|rel| share * rel);
            at_rad = ptp.target_rad;
        }
        Ok(slowed)
    }
}

/// Returns the largest share at which a requirement that grows with the share is within a limit.
fn share_within(
    limit: f64,
    mut needs: impl FnMut(f64) -> Result<f64, PlanError>,
) -> Result<f64, PlanError> {
    if needs(1.0)? <= limit {
        return Ok(1.0);
    }
    let (mut within, mut beyond) = (MIN_SHARE, 1.0);
    for _ in 0..SHARE_STEPS {
        let share = f64::midpoint(within, beyond);
        if needs(share)? <= limit {
            within = share;
        } else {
            beyond = share;
        }
    }
    Ok(within)
}
