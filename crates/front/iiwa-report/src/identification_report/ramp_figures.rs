//! Identified ramps of PTP motions.

use std::fmt::Write as _;

use iiwa_eval::{
    Estimate,
    identify::{Identified, LineLaw, RampEstimates},
};
use iiwa_kin::RampLaw;
use serde::Serialize;

use super::figure::Figure;

/// Law of the ramps; null for joints that never limit a ramp in the recordings.
#[derive(Clone, Debug, Serialize)]
pub(super) struct RampFigures {
    /// Parameter S.
    torque_snap_nm_s2: [Option<Figure>; 7],
    /// Parameter R at the start and at the end.
    start_nm_s: [Option<Figure>; 7],
    stop_nm_s: [Option<Figure>; 7],
    /// Number of motions with such ramps.
    motions: usize,
    /// Root mean squares over these motions: residual of the law, residual of constant jerk, and
    /// noise.
    residual_deg: f64,
    jerk_residual_deg: f64,
    noise_deg: f64,
}

impl RampFigures {
    pub(super) fn new(ramps: &RampEstimates) -> Self {
        let figures = |all: &[Option<Estimate>; 7]| all.map(|figure| figure.map(Figure::from));
        Self {
            torque_snap_nm_s2: figures(&ramps.torque_snap_nm_s2),
            start_nm_s: figures(&ramps.start_nm_s),
            stop_nm_s: figures(&ramps.stop_nm_s),
            motions: ramps.motions,
            residual_deg: ramps.residual_rad.to_degrees(),
            jerk_residual_deg: ramps.jerk_residual_rad.to_degrees(),
            noise_deg: ramps.noise_rad.to_degrees(),
        }
    }

    pub(super) fn write(&self, text: &mut String, model: &RampLaw) {
        let Self { motions, residual_deg, jerk_residual_deg, noise_deg, .. } = self;
        let _ = writeln!(
            text,
            "Ramps begin with constant snap, as under Sunrise: {motions} motions, \
             residual {residual_deg:.1e} deg, with constant jerk {jerk_residual_deg:.1e} deg, \
             noise {noise_deg:.1e} deg"
        );
        for (name, figures, model) in [
            ("S, Nm/s^2", &self.torque_snap_nm_s2, &model.torque_snap_nm_s2),
            ("R at starts, Nm/s", &self.start_nm_s, &model.start_nm_s),
            ("R at stops, Nm/s", &self.stop_nm_s, &model.stop_nm_s),
        ] {
            let shown: Vec<_> = (1..)
                .zip(figures.iter().zip(model))
                .filter_map(|(joint, (figure, model))| {
                    let figure = (*figure)?;
                    Some(format!("A{joint} {figure} (n {}, model {model:.0})", figure.count))
                })
                .collect();
            let shown = if shown.is_empty() { "not found".to_owned() } else { shown.join(", ") };
            let _ = writeln!(text, "  {name}: {shown}");
        }
        text.push_str(
            "  S and R of other joints, B, c and the width of a phase cannot be identified: they \
             keep the values of the model\n",
        );
    }
}

/// Returns a note about motions that no known law explains, if any.
pub(super) fn unexplained(identified: &Identified) -> Option<String> {
    let all = identified.lines.iter().filter(|line| line.is_unexplained());
    let worst = all.clone().max_by(|a, b| a.residual_rad.total_cmp(&b.residual_rad))?;
    let law = match worst.law {
        LineLaw::Jerk => "constant jerk",
        LineLaw::Snap => "constant snap",
    };
    Some(format!(
        "{} of {} motions are not explained: motion {} has a residual of {:.1e} deg with {law}, \
         and the noise is {:.1e} deg; their figures are less certain than stated. Did the robot \
         run the whole program, at the stated override?",
        all.count(),
        identified.lines.len(),
        worst.motion,
        worst.residual_rad.to_degrees(),
        worst.noise_rad.to_degrees(),
    ))
}
