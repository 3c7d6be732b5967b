//! Loads and friction, as JSON and as text.

use std::fmt::Write as _;

use iiwa_eval::{
    Estimate,
    identify::{LoadEstimate, TorqueEstimates},
};
use iiwa_kin::Load;
use serde::Serialize;

use crate::table::table;

use super::figure::Figure;

/// Results from recorded torques.
#[derive(Clone, Debug, Serialize)]
pub(super) struct TorqueResults {
    loads: Vec<LoadRow>,
    /// Joints A1 to A7; null if a joint hardly moves.
    viscous_nm_s_rad: [Option<Figure>; 7],
    coulomb_nm: [Option<Figure>; 7],
    /// Residual torque of each joint, root mean square over windows of `window_s`.
    residual_nm: [f64; 7],
    window_s: f64,
    /// `true` if the sign of the recorded torques is not that of their format, and was inverted.
    turned: bool,
}

#[derive(Clone, Debug, Serialize)]
struct LoadRow {
    /// Recordings, from 1.
    recordings: Vec<usize>,
    /// Load stated by the programs.
    stated: Option<ProgramLoad>,
    mass_kg: Option<Figure>,
    center_mm: [Option<Figure>; 3],
    /// Quantities that the recordings do not determine.
    untold: Vec<&'static str>,
    /// Load in program format.
    load: Option<ProgramLoad>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct ProgramLoad {
    mass_kg: f64,
    center_mm: [f64; 3],
}

impl From<&Load> for ProgramLoad {
    fn from(load: &Load) -> Self {
        let rounded = |value: f64, places: f64| (value * places).round() / places + 0.0;
        let center_mm = load.center_mm.map(|mm| rounded(mm, 10.0));
        Self { mass_kg: rounded(load.mass_kg, 1e3), center_mm }
    }
}

impl From<&LoadEstimate> for LoadRow {
    fn from(load: &LoadEstimate) -> Self {
        Self {
            recordings: load.recordings.iter().map(|recording| recording + 1).collect(),
            stated: load.stated.as_ref().map(ProgramLoad::from),
            mass_kg: load.mass_kg.map(Figure::from),
            center_mm: load.center_mm.map(|center| center.map(Figure::from)),
            untold: load.untold(),
            load: load.load().as_ref().map(ProgramLoad::from),
        }
    }
}

impl TorqueResults {
    pub(super) fn new(torques: &TorqueEstimates) -> Self {
        let figures = |estimates: &[Option<Estimate>; 7]| {
            estimates.map(|estimate| estimate.map(Figure::from))
        };
        Self {
            loads: torques.loads.iter().map(LoadRow::from).collect(),
            viscous_nm_s_rad: figures(&torques.viscous_nm_s_rad),
            coulomb_nm: figures(&torques.coulomb_nm),
            residual_nm: torques.residual_nm,
            window_s: torques.window_s,
            turned: torques.turned,
        }
    }

    pub(super) fn write(&self, text: &mut String) {
        let shown = |figure: &Option<Figure>| {
            figure.map_or_else(|| "not found".to_owned(), |figure| figure.to_string())
        };
        let mut rows = table(&["joint", "viscous Nm s/rad", "Coulomb Nm", "residual Nm"]);
        for joint in 0..7 {
            let friction = [&self.viscous_nm_s_rad[joint], &self.coulomb_nm[joint]];
            let [viscous, coulomb] = friction.map(shown);
            let left = format!("{:.3}", self.residual_nm[joint]);
            rows.add_row([format!("A{}", joint + 1), viscous, coulomb, left]);
        }
        let _ = writeln!(text, "{rows}\n");
        for load in &self.loads {
            let [x, y, z] = load.center_mm.each_ref().map(shown);
            let _ = write!(text, "Load: {} kg, centre ({x}, {y}, {z}) mm", shown(&load.mass_kg));
            if self.loads.len() > 1 {
                let recordings: Vec<_> = load.recordings.iter().map(usize::to_string).collect();
                let _ = write!(text, "; recordings {}", recordings.join(", "));
            }
            if let Some(stated) = &load.stated {
                let _ = write!(text, "; the program states {} kg", stated.mass_kg);
            }
            text.push('\n');
            if let Some(load) = &load.load {
                let load = serde_json::to_string(load).unwrap_or_default();
                let _ = writeln!(text, "      in programs: \"load\": {load}");
            } else if load.mass_kg.is_none_or(|mass| !mass.is_zero_within(0.0)) {
                let _ = writeln!(
                    text,
                    "      not found: {}; this needs motions that turn A2, A4 and A6, and the \
                     flange away from straight down",
                    load.untold.join(", ")
                );
            }
        }
        if self.turned {
            text.push_str(
                "Torques inverted: by the arm's weight, their sign is not that of their format\n",
            );
        }
    }
}
