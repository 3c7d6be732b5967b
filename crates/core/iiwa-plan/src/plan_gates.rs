//! Acceptance limits of a plan: cycle time, clearance and torque.

use iiwa_json::printable;
use iiwa_kin::part_name;

use serde::Serialize;

use crate::{ClearanceRecord, LargestTorque, PlanFigures, SelfClearanceRecord};

/// Acceptance limits of a plan: cycle time, clearance and torque.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlanGates {
    /// Largest cycle time, in s.
    pub max_cycle_time_s: Option<f64>,
    /// Smallest clearance, in mm. Contact with an obstacle or of the arm with itself fails any
    /// limit.
    pub min_clearance_mm: Option<f64>,
    /// Largest torque of any joint on the output side of its gear, in per cent of the robot's
    /// limit.
    pub max_torque_percent: Option<f64>,
}

/// Acceptance limits that a plan violates, with messages.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnmetGates {
    /// Message of an exceeded cycle time.
    pub too_long: Option<String>,
    /// Message of a clearance that is too small, or of a self-collision.
    pub too_near: Option<String>,
    /// Message of an exceeded torque.
    pub overloaded: Option<String>,
}

/// An acceptance limit with the value of a plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GateRecord {
    /// Limit.
    pub limit: f64,
    /// Value of the plan; `None` if the plan has none, such as a clearance without obstacles.
    pub value: Option<f64>,
    /// True if the plan meets the limit.
    pub met: bool,
}

/// Acceptance limits with the values of a plan; a limit that is not set is left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct GateRecords {
    /// Cycle time, in s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_cycle_time_s: Option<GateRecord>,
    /// Clearance, in mm; 0 if the arm touches itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min_clearance_mm: Option<GateRecord>,
    /// Torque of any joint, in per cent of the robot's limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_torque_percent: Option<GateRecord>,
}

impl PlanGates {
    /// Acceptance limits that are set, with the values of a plan by its figures.
    #[must_use]
    pub fn records(&self, figures: &PlanFigures) -> GateRecords {
        let UnmetGates { too_long, too_near, overloaded } = self.judge(figures);
        let record = |limit: Option<f64>, value: Option<f64>, unmet: Option<String>| {
            limit.map(|limit| GateRecord { limit, value, met: unmet.is_none() })
        };
        let clearance_mm = figures.clearance.as_ref().map(|nearest| nearest.distance_mm);
        let touches_itself = figures.self_clearance.as_ref().filter(|it| it.distance_mm == 0.0);
        let clearance_mm = touches_itself.map_or(clearance_mm, |_| Some(0.0));
        let percent = figures.largest_torque().map(|largest| largest.percent);
        GateRecords {
            max_cycle_time_s: record(self.max_cycle_time_s, Some(figures.cycle_time_s), too_long),
            min_clearance_mm: record(self.min_clearance_mm, clearance_mm, too_near),
            max_torque_percent: record(self.max_torque_percent, percent, overloaded),
        }
    }

    /// Checks a plan by its figures.
    #[must_use]
    pub fn judge(&self, figures: &PlanFigures) -> UnmetGates {
        let cycle_time_s = figures.cycle_time_s;
        let too_long = self
            .max_cycle_time_s
            .filter(|limit| is_above(cycle_time_s, *limit, 3))
            .map(|limit| format!("takes {cycle_time_s:.3} s, more than {limit} s"));
        let too_near = self.min_clearance_mm.and_then(|limit_mm| {
            let nearest = figures.clearance.as_ref();
            let scene = nearest.and_then(|nearest| too_near(limit_mm, nearest, figures));
            let nearest = figures.self_clearance.as_ref();
            scene.or_else(|| nearest.and_then(|nearest| touches_itself(nearest, figures)))
        });
        let overloaded = self.max_torque_percent.and_then(|limit| {
            let LargestTorque { motion, joint, percent, at_s, .. } = figures.largest_torque()?;
            is_above(percent, limit, 1).then(|| {
                format!(
                    "needs {percent:.1} % of {joint}'s torque, more than {limit} %: motion \
                     {motion} at {at_s:.3} s"
                )
            })
        });
        UnmetGates { too_long, too_near, overloaded }
    }
}

impl UnmetGates {
    /// Message of all violated limits, if any.
    #[must_use]
    pub fn complaint(&self) -> Option<String> {
        let Self { too_long, too_near, overloaded } = self;
        let unmet: Vec<&str> =
            [too_long, too_near, overloaded].into_iter().flatten().map(String::as_str).collect();
        (!unmet.is_empty()).then(|| unmet.join(", and "))
    }
}

/// Returns true if a value is above a limit, both exactly and after it is rounded to `decimals`,
/// the promised precision of a figure. A message such as "20.0 mm, less than 20 mm" is therefore
/// impossible. For a lower limit, negate both numbers.
///
/// ```
/// use iiwa_plan::is_above;
///
/// assert!(!is_above(20.04, 20.0, 1)); // Printed as 20.0.
/// assert!(is_above(20.06, 20.0, 1)); // Printed as 20.1.
/// assert!(!is_above(20.06, 20.08, 1)); // Printed as 20.1, but not above the limit.
/// ```
#[must_use]
pub fn is_above(value: f64, limit: f64, decimals: usize) -> bool {
    let printed = format!("{value:.decimals$}").parse().unwrap_or(value);
    value > limit && printed > limit
}

/// Message of a clearance below the limit, if it is. Contact fails any limit, including 0.
fn too_near(limit_mm: f64, nearest: &ClearanceRecord, figures: &PlanFigures) -> Option<String> {
    let ClearanceRecord { distance_mm, link, obstacle, at_s } = nearest;
    let obstacle = printable(obstacle);
    let place = format!("{} {}", part_name(*link), printable(&figures.place_at(*at_s)));
    if *distance_mm == 0.0 {
        Some(format!("touches {obstacle}: {place}"))
    } else if is_above(-distance_mm, -limit_mm, 1) {
        Some(format!(
            "comes within {distance_mm:.1} mm of {obstacle}, less than {limit_mm} mm: {place}"
        ))
    } else {
        None
    }
}

/// Message of a self-collision, if any. Adjacent links are always close to each other, so no
/// positive distance is a fault.
fn touches_itself(nearest: &SelfClearanceRecord, figures: &PlanFigures) -> Option<String> {
    let SelfClearanceRecord { distance_mm, link, other_link, at_s } = nearest;
    let [part, other] = [*link, *other_link].map(part_name);
    let place = printable(&figures.place_at(*at_s));
    (*distance_mm == 0.0).then(|| format!("touches itself: {part} and {other} {place}"))
}

#[cfg(test)]
mod tests {
    use iiwa_kin::Robot;
    use iiwa_traj::Timing;

    use super::*;

    /// Checks values near a limit: a value that is printed as the limit meets the gate.
    #[test]
    fn gates_agree_with_the_printed_values() {
        let mut figures = PlanFigures::new(Timing::default(), &Robot::lbr_iiwa_7_r800(), 100);
        let near = [
            (19.96, 20.0, None),
            (19.94, 20.0, Some("comes within 19.9 mm of column, less than 20 mm")),
            (20.04, 20.0, None),
            (19.96, 19.97, None),
            (19.94, 19.93, None),
        ];
        for (distance_mm, limit_mm, expected) in near {
            let obstacle = "column".to_owned();
            figures.clearance = Some(ClearanceRecord { distance_mm, link: 7, obstacle, at_s: 1.0 });
            let gates = PlanGates { min_clearance_mm: Some(limit_mm), ..PlanGates::default() };
            let message = gates.judge(&figures).complaint();
            let message = message.as_deref().and_then(|message| message.split(':').next());
            assert_eq!(message, expected, "{distance_mm} mm");
        }
        let long = [(7.0004, None), (7.0006, Some("takes 7.001 s, more than 7 s"))];
        for (cycle_time_s, expected) in long {
            figures.cycle_time_s = cycle_time_s;
            let gates = PlanGates { max_cycle_time_s: Some(7.0), ..PlanGates::default() };
            assert_eq!(gates.judge(&figures).complaint().as_deref(), expected);
        }
    }
}
