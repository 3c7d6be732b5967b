//! Joint curves of an arm, and their source.

use serde::Serialize;

use super::{
    curve::{CurveColumns, TimeSeries},
    measured::MeasuredCurves,
    planned::PlannedCurves,
};

/// Joint curves of an arm.
#[derive(Debug, Serialize)]
pub(crate) struct Curves {
    position: CurveColumns,
    velocity: CurveColumns,
    acceleration: CurveColumns,
    jerk: CurveColumns,
    /// Snap; without columns for a recording.
    snap: CurveColumns,
    /// Source of velocity, acceleration, jerk and snap, as text.
    method: String,
}

impl Curves {
    pub(crate) fn of_plan(planned: PlannedCurves, timing: Option<&str>, shift_s: f64) -> Self {
        let PlannedCurves { position, velocity, acceleration, jerk, snap } = planned;
        let method = match timing {
            Some("acceleration") => {
                "from the nodes of the trajectory; planned without jerk limits: acceleration jumps"
            }
            Some("sunrise") => {
                "from the nodes of the trajectory; from node to node, jerk is linear. Sunrise's \
                 ramps may have more jerk than its limit, which holds for blends, LIN and CIRC"
            }
            _ => "from the nodes of the trajectory; from node to node, jerk is linear",
        };
        let samples = [position, velocity, acceleration, jerk, snap];
        Self::of(samples, method.to_owned(), shift_s)
    }

    pub(crate) fn of_recording(measured: MeasuredCurves, shift_s: f64) -> Self {
        let MeasuredCurves { position, velocity, acceleration, jerk, half_s } = measured;
        let window_ms = 2e3 * half_s;
        let method = if velocity.rows.is_empty() {
            format!("shorter than {window_ms:.0} ms, too short for velocity, acceleration and jerk")
        } else {
            format!(
                "velocity, acceleration and jerk are those of the best cubic over \
                 {window_ms:.0} ms: shorter peaks are lower here than they were"
            )
        };
        let samples = [position, velocity, acceleration, jerk, TimeSeries::default()];
        Self::of(samples, method, shift_s)
    }

    fn of(samples: [TimeSeries; 5], method: String, shift_s: f64) -> Self {
        let [position, velocity, acceleration, jerk, snap] =
            samples.map(|samples| CurveColumns::new(&samples, shift_s));
        Self { position, velocity, acceleration, jerk, snap, method }
    }
}
