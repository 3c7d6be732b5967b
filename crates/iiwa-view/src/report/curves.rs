//! The curves of an arm's joints, and where they come from.

use serde::Serialize;

use super::{
    curve::{Curve, Samples},
    measured::Measured,
    planned::Planned,
};

/// The curves of an arm's joints.
#[derive(Debug, Serialize)]
pub(crate) struct Curves {
    position: Curve,
    velocity: Curve,
    acceleration: Curve,
    jerk: Curve,
    /// The source of velocity, acceleration and jerk, as text.
    method: String,
}

impl Curves {
    pub(crate) fn of_plan(planned: Planned, smooth: bool, shift_s: f64) -> Self {
        let Planned { position, velocity, acceleration, jerk } = planned;
        let method = if smooth {
            "from the nodes of the trajectory; jerk is the mean from node to node"
        } else {
            "from the nodes of the trajectory; planned without limits of jerk: acceleration jumps"
        };
        Self::of([position, velocity, acceleration, jerk], method.to_owned(), shift_s)
    }

    pub(crate) fn of_recording(measured: Measured, shift_s: f64) -> Self {
        let Measured { position, velocity, acceleration, jerk, half_s } = measured;
        let window_ms = 2e3 * half_s;
        let method = if velocity.rows.is_empty() {
            format!("shorter than {window_ms:.0} ms, too short for velocity, acceleration and jerk")
        } else {
            format!(
                "velocity, acceleration and jerk are those of the best cubic over \
                 {window_ms:.0} ms: shorter peaks are lower here than they were"
            )
        };
        Self::of([position, velocity, acceleration, jerk], method, shift_s)
    }

    fn of(samples: [Samples; 4], method: String, shift_s: f64) -> Self {
        let [position, velocity, acceleration, jerk] =
            samples.map(|samples| Curve::new(&samples, shift_s));
        Self { position, velocity, acceleration, jerk, method }
    }
}
