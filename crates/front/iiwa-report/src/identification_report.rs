//! Results of an identification from recordings, as JSON and as text.

mod figure;
mod ramp_figures;
mod tcp_figures;
mod torque_figures;

use std::{fmt::Write as _, path::Path};

use iiwa_eval::{
    Estimate,
    identify::{BlendObservation, Identified, LineLaw, LineObservation},
};
use iiwa_kin::{Joint, Robot};
use iiwa_log::{JointLog, Loss};
use serde::Serialize;

use crate::table::table;
use iiwa_json::printable;

use self::{
    figure::{EQUAL_SHARE, Figure, KappaFigure, blends},
    ramp_figures::{RampFigures, unexplained},
    tcp_figures::TcpFigures,
    torque_figures::TorqueResults,
};

/// Results of an identification from recordings. As JSON, this is the object of `iiwasim identify
/// --json`.
#[derive(Clone, Debug, Serialize)]
pub struct IdentificationReport {
    robot: String,
    recordings: Vec<String>,
    /// Joints A1 to A7; null if the recordings do not show a limit.
    velocity_deg_s: [Option<Figure>; 7],
    acceleration_deg_s2: [Option<Figure>; 7],
    jerk_deg_s3: [Option<Figure>; 7],
    /// Ramps of PTP motions; null if none begins with constant snap.
    ramps: Option<RampFigures>,
    settle: Option<SettleFigure>,
    kappa: Option<KappaFigure>,
    /// 0 if blends begin and end at equal distances (Larsen 2019, Algorithm 3), 1 if they do not.
    unequal_share: Option<Figure>,
    /// TCP paths, if any.
    tcp: Option<TcpFigures>,
    /// Load and friction; null if no recording has torques.
    torques: Option<TorqueResults>,
    lines: Vec<LineRow>,
    blends: Vec<BlendRow>,
    /// Missing parts of the recordings, and unused data.
    losses: Vec<String>,
    output: Option<String>,
}

#[derive(Clone, Debug, Serialize)]
struct SettleFigure {
    mean_s: Figure,
    deviation_s: f64,
}

/// Motion along a straight line in joint space.
#[derive(Clone, Debug, Serialize)]
struct LineRow {
    /// Recording and motion, from 1.
    recording: usize,
    motion: usize,
    /// Joint, from 1, if only one moves.
    joint: Option<usize>,
    start_s: f64,
    end_s: f64,
    /// Limits along the path (norm over the joints).
    velocity_deg_s: Option<f64>,
    acceleration_deg_s2: Option<f64>,
    jerk_deg_s3: Option<f64>,
    /// `jerk` if constant jerk explains the motion, `snap` if ramps that begin with constant snap
    /// do.
    law: &'static str,
    residual_deg: f64,
    noise_deg: f64,
}

impl From<&LineObservation> for LineRow {
    fn from(line: &LineObservation) -> Self {
        Self {
            recording: line.recording + 1,
            motion: line.motion.number(),
            joint: line.joint.map(Joint::number),
            start_s: line.time_s[0],
            end_s: line.time_s[1],
            velocity_deg_s: line.speed_rad_s.map(f64::to_degrees),
            acceleration_deg_s2: line.acceleration_rad_s2.map(f64::to_degrees),
            jerk_deg_s3: line.jerk_rad_s3.map(f64::to_degrees),
            law: match line.law {
                LineLaw::Jerk => "jerk",
                LineLaw::Snap => "snap",
            },
            residual_deg: line.residual_rad.to_degrees(),
            noise_deg: line.noise_rad.to_degrees(),
        }
    }
}

#[derive(Clone, Debug, Serialize)]
struct BlendRow {
    /// Recording and motion whose target is blended, from 1.
    recording: usize,
    motion: usize,
    gamma_deg: f64,
    kappa: f64,
    /// Standard deviation of kappa.
    deviation: f64,
    /// Expected distance from the target to both ends of the blend, and the measured distances.
    reach_deg: f64,
    found_reach_deg: Option<[f64; 2]>,
    residual_deg: f64,
}

impl From<&BlendObservation> for BlendRow {
    fn from(blend: &BlendObservation) -> Self {
        Self {
            recording: blend.recording + 1,
            motion: blend.motion.number(),
            gamma_deg: blend.gamma_deg,
            kappa: blend.kappa.0,
            deviation: blend.kappa.1,
            reach_deg: blend.reach_rad.to_degrees(),
            found_reach_deg: blend.found_reach_rad.map(|reach| reach.map(f64::to_degrees)),
            residual_deg: blend.residual_rad.to_degrees(),
        }
    }
}

impl IdentificationReport {
    /// Creates the report on a model `identified` from `recordings` in the same order; `robot` is
    /// the name of the identified robot, and `output` the file of its profile, if written.
    #[must_use]
    pub fn new(
        recordings: &[(&str, &JointLog)],
        robot: &str,
        identified: &Identified,
        output: Option<&Path>,
    ) -> Self {
        let degrees = |figures: &[Option<Estimate>; 7]| {
            figures.map(|figure| figure.map(|figure| figure.scaled(1_f64.to_degrees()).into()))
        };
        let lost = recordings.iter().flat_map(|(name, log)| {
            losses(log).into_iter().map(move |loss| format!("{name}: {loss}"))
        });
        let left_out = identified.left_out.iter().map(|left| {
            format!("{}, motion {}: {}", recordings[left.recording].0, left.motion, left.why)
        });
        let unused = identified.unused_torques.iter();
        let unused = unused.map(|(recording, why)| format!("{}: {why}", recordings[*recording].0));
        Self {
            robot: robot.to_owned(),
            recordings: recordings.iter().map(|(name, _)| (*name).to_owned()).collect(),
            velocity_deg_s: degrees(&identified.velocity_rad_s),
            acceleration_deg_s2: degrees(&identified.acceleration_rad_s2),
            jerk_deg_s3: degrees(&identified.jerk_rad_s3),
            ramps: identified.ramps.as_ref().map(RampFigures::new),
            settle: identified.settle.map(|settle| SettleFigure {
                mean_s: settle.mean_s.into(),
                deviation_s: settle.deviation_s,
            }),
            kappa: identified
                .kappa
                .as_ref()
                .map(|kappa| KappaFigure::new(kappa, identified.blends.len())),
            unequal_share: identified.unequal_share.map(Figure::from),
            tcp: TcpFigures::of(identified),
            torques: identified.torques.as_ref().map(TorqueResults::new),
            lines: identified.lines.iter().map(LineRow::from).collect(),
            blends: identified.blends.iter().map(BlendRow::from).collect(),
            losses: lost.chain(unexplained(identified)).chain(left_out).chain(unused).collect(),
            output: output.map(|file| file.display().to_string()),
        }
    }

    /// Returns true if nothing was identified.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let limits = [&self.velocity_deg_s, &self.acceleration_deg_s2, &self.jerk_deg_s3];
        limits.iter().all(|limits| limits.iter().all(Option::is_none))
            && self.settle.is_none()
            && self.blends.is_empty()
            && self.tcp.is_none()
            && self.torques.is_none()
    }

    /// First entries of the missing data.
    pub fn first_losses(&self) -> impl Iterator<Item = &str> {
        self.losses.iter().take(SHOWN).map(String::as_str)
    }

    /// Formats tables and sentences, with the values of the `model` for comparison.
    #[must_use]
    pub fn text(&self, model: &Robot) -> String {
        let mut rows = table(&[
            "joint",
            "velocity deg/s",
            "n",
            "acceleration deg/s^2",
            "n",
            "jerk deg/s^3",
            "n",
        ]);
        for joint in 0..7 {
            let mut row = vec![format!("A{}", joint + 1)];
            for figures in [&self.velocity_deg_s, &self.acceleration_deg_s2, &self.jerk_deg_s3] {
                row.push(figures[joint].map_or_else(|| "not found".to_owned(), |f| f.to_string()));
                row.push(figures[joint].map_or_else(String::new, |f| f.count.to_string()));
            }
            rows.add_row(row);
        }
        let mut text = format!("{rows}\n\n");
        if let Some(ramps) = &self.ramps {
            ramps.write(&mut text, model.ramp_law());
        }
        match &self.settle {
            Some(SettleFigure { mean_s, deviation_s }) => {
                let _ = writeln!(
                    text,
                    "Settles for {mean_s} s: {} stops, standard deviation {deviation_s:.6} s \
                     (model {} s)",
                    mean_s.count,
                    model.settle_time_s()
                );
            }
            None => text.push_str("Time to settle: not found\n"),
        }
        match &self.kappa {
            Some(kappa) => kappa.write(&mut text, "kappa"),
            None => {
                let _ = writeln!(
                    text,
                    "kappa over gamma: not found; it needs blends of different angles ({} found)",
                    self.blends.len()
                );
            }
        }
        match &self.unequal_share {
            Some(share) => {
                let holds = share.is_zero_within(EQUAL_SHARE);
                let _ = writeln!(
                    text,
                    "Blends begin and end at equal distances (Algorithm 3): {}; the difference is \
                     {share} of that without this rule, {}",
                    if holds { "confirmed" } else { "not confirmed" },
                    blends(share.count)
                );
            }
            None => text.push_str(
                "Algorithm 3: not tested; it needs blends between motions of unequal lengths\n",
            ),
        }
        if let Some(tcp) = &self.tcp {
            tcp.write(&mut text);
        }
        if let Some(torques) = &self.torques {
            torques.write(&mut text);
        }
        for loss in self.losses.iter().take(SHOWN) {
            let _ = writeln!(text, "Note: {}", printable(loss));
        }
        if let Some(more @ 1..) = self.losses.len().checked_sub(SHOWN) {
            let _ = writeln!(text, "Note: {more} more in the JSON output");
        }
        if let Some(file) = &self.output {
            let _ = writeln!(text, "Profile of {} in {}", printable(&self.robot), printable(file));
        }
        text
    }
}

/// Number of losses shown individually.
const SHOWN: usize = 10;

/// Describes the missing data of a recording, all gaps in one line.
fn losses(log: &JointLog) -> Vec<String> {
    let mut gaps = 0;
    let mut gaps_s = 0.0;
    let mut texts = Vec::new();
    if log.is_plan {
        texts.push("this is a plan: the figures are those of its model, not of a robot".to_owned());
    }
    for loss in &log.losses {
        if let Loss::Gap { from_s, to_s, .. } = loss {
            gaps += 1;
            gaps_s += to_s - from_s;
        } else {
            texts.push(loss.to_string());
        }
    }
    if gaps > 0 {
        texts.push(format!("without samples in {gaps} gaps, {gaps_s:.3} s in all"));
    }
    texts
}
