//! The figures of a plan, as they are printed and as they stand in the MCAP file.

use std::{collections::BTreeMap, time::Duration};

use iiwa_kin::Robot;
use iiwa_scene::{ArmInScene, PlannedClearance};
use iiwa_traj::{BlendFigures, Limit, MotionFigures, Section, Timing, Totals};
use serde::Serialize;

/// The `--json` object of `iiwasim plan`.
#[derive(Debug, Serialize)]
pub(crate) struct Figures {
    pub(crate) cycle_time_s: f64,
    pub(crate) motion_time_s: f64,
    pub(crate) settle_time_s: f64,
    pub(crate) wait_time_s: f64,
    pub(crate) timing: &'static str,
    pub(crate) robot: String,
    pub(crate) samples: u32,
    /// Limits of the robot that no source states and that the figures rest on.
    pub(crate) assumptions: Vec<String>,
    /// How near the arm comes to the scene, if there is one with obstacles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) clearance: Option<ClearanceRow>,
    pub(crate) motions: Vec<MotionRow>,
    pub(crate) blends: Vec<BlendRow>,
}

#[derive(Debug, Serialize)]
pub(crate) struct ClearanceRow {
    /// 0 if the arm touches the obstacle.
    pub(crate) distance_mm: f64,
    pub(crate) link: usize,
    /// Its name.
    pub(crate) obstacle: String,
    pub(crate) at_s: f64,
}

#[derive(Debug, Serialize)]
pub(crate) struct MotionRow {
    /// The place in the program, from 1.
    pub(crate) index: usize,
    pub(crate) r#type: &'static str,
    pub(crate) start_s: f64,
    pub(crate) end_s: f64,
    pub(crate) peak_velocity_rel: f64,
    pub(crate) limited_by: Option<LimitRow>,
    /// All limits that it is at, with their shares of the time.
    pub(crate) limits: Vec<LimitShareRow>,
}

#[derive(Debug, Serialize)]
pub(crate) struct LimitShareRow {
    #[serde(flatten)]
    pub(crate) limit: LimitRow,
    pub(crate) share: f64,
}

#[derive(Debug, Serialize)]
pub(crate) struct LimitRow {
    pub(crate) joint: usize,
    pub(crate) kind: &'static str,
}

#[derive(Debug, Serialize)]
pub(crate) struct BlendRow {
    pub(crate) after_motion: usize,
    pub(crate) gamma_deg: f64,
    pub(crate) start_rad: [f64; 7],
    pub(crate) end_rad: [f64; 7],
    pub(crate) mid_rad: [f64; 7],
    pub(crate) mid_tcp_m: [f64; 3],
    pub(crate) start_s: f64,
    pub(crate) end_s: f64,
}

impl Figures {
    /// Figures of nothing yet.
    pub(crate) fn new(timing: Timing, robot: &Robot, samples: u32) -> Self {
        let used = |what: &str| match timing {
            Timing::Jerk(_) => what == "acceleration" || what == "jerk",
            _ => what == "acceleration",
        };
        Self {
            cycle_time_s: 0.0,
            motion_time_s: 0.0,
            settle_time_s: 0.0,
            wait_time_s: 0.0,
            timing: timing.name(),
            robot: robot.name().to_owned(),
            samples,
            assumptions: robot
                .assumptions()
                .iter()
                .filter(|assumption| used(&assumption.what))
                .map(|assumption| format!("{}: {}", assumption.what, assumption.basis))
                .collect(),
            clearance: None,
            motions: Vec::new(),
            blends: Vec::new(),
        }
    }

    /// Adds a section.
    pub(crate) fn add(&mut self, section: &Section) {
        let mut totals = Totals {
            motion_time_s: self.motion_time_s,
            settle_time_s: self.settle_time_s,
            wait_time_s: self.wait_time_s,
        };
        totals.add(section);
        self.cycle_time_s = totals.cycle_time_s();
        self.motion_time_s = totals.motion_time_s;
        self.settle_time_s = totals.settle_time_s;
        self.wait_time_s = totals.wait_time_s;
        self.motions.extend(section.motions().iter().map(MotionRow::from));
        self.blends.extend(section.blends().iter().map(BlendRow::from));
    }

    /// Adds how near `arm` comes to its scene in a section.
    pub(crate) fn add_clearance(&mut self, arm: &ArmInScene, section: &Section) {
        let Some(PlannedClearance { clearance, at_s, .. }) = arm.clearance_of_section(section)
        else {
            return;
        };
        let distance_mm = 1e3 * clearance.distance_m;
        if self.clearance.as_ref().is_none_or(|nearest| distance_mm < nearest.distance_mm) {
            let obstacle = arm.scene().obstacles()[clearance.obstacle].name.clone();
            self.clearance =
                Some(ClearanceRow { distance_mm, link: clearance.link, obstacle, at_s });
        }
    }

    /// One entry for each key: texts as they are, everything else as JSON.
    pub(crate) fn metadata(&self) -> BTreeMap<String, String> {
        let Ok(serde_json::Value::Object(object)) = serde_json::to_value(self) else {
            return BTreeMap::new();
        };
        let text = |value| match value {
            serde_json::Value::String(text) => text,
            other => other.to_string(),
        };
        object.into_iter().map(|(key, value)| (key, text(value))).collect()
    }
}

impl From<Limit> for LimitRow {
    fn from(limit: Limit) -> Self {
        Self { joint: limit.joint, kind: limit.kind.name() }
    }
}

impl From<&MotionFigures> for MotionRow {
    fn from(figures: &MotionFigures) -> Self {
        Self {
            index: figures.motion + 1,
            r#type: figures.kind.name(),
            start_s: figures.start_s,
            end_s: figures.end_s,
            peak_velocity_rel: figures.peak_velocity_rel,
            limited_by: figures.limited_by.map(LimitRow::from),
            limits: figures
                .limits
                .iter()
                .map(|limit| LimitShareRow { limit: limit.limit.into(), share: limit.share })
                .collect(),
        }
    }
}

impl From<&BlendFigures> for BlendRow {
    fn from(figures: &BlendFigures) -> Self {
        Self {
            after_motion: figures.motion + 1,
            gamma_deg: figures.gamma_deg,
            start_rad: figures.start_rad,
            end_rad: figures.end_rad,
            mid_rad: figures.mid_rad,
            mid_tcp_m: figures.mid_tcp_m,
            start_s: figures.start_s,
            end_s: figures.end_s,
        }
    }
}

/// A long time for people, as `115days 17h 46m 40s`.
pub(crate) fn lasting(time_s: f64) -> String {
    let time = Duration::try_from_secs_f64(time_s.round()).unwrap_or(Duration::MAX);
    humantime::format_duration(time).to_string()
}
