//! Identified properties of TCP paths.

use std::fmt::Write as _;

use iiwa_eval::identify::{CourseObservation, CoursePart, Identified, TcpBlendObservation};
use serde::Serialize;

use super::figure::{EQUAL_SHARE, Figure, KappaFigure, blends};

/// Blends between straight TCP paths, and deviations of TCP paths and their blends from the assumed
/// laws.
#[derive(Clone, Debug, Serialize)]
pub(super) struct TcpFigures {
    kappa: Option<KappaFigure>,
    /// Distances before and behind the targets, relative to `cart_mm`.
    reach: Option<[Figure; 2]>,
    /// 0 if blends begin and end at equal distances, 1 if both sides are independent.
    unequal_share: Option<Figure>,
    blends: Vec<TcpBlendRow>,
    courses: Vec<CourseRow>,
}

#[derive(Clone, Debug, Serialize)]
struct TcpBlendRow {
    /// Recording and motion whose target is blended, from 1.
    recording: usize,
    motion: usize,
    gamma_deg: f64,
    kappa: f64,
    /// Standard deviation of kappa.
    deviation: f64,
    /// Expected distance from the target to both ends of the blend, and the measured distances.
    reach_mm: f64,
    found_reach_mm: Option<[f64; 2]>,
    residual_mm: f64,
}

impl From<&TcpBlendObservation> for TcpBlendRow {
    fn from(blend: &TcpBlendObservation) -> Self {
        Self {
            recording: blend.recording + 1,
            motion: blend.motion.number(),
            gamma_deg: blend.gamma_deg,
            kappa: blend.kappa.0,
            deviation: blend.kappa.1,
            reach_mm: 1e3 * blend.reach_m,
            found_reach_mm: blend.found_reach_m.map(|reach| reach.map(|reach| 1e3 * reach)),
            residual_mm: 1e3 * blend.residual_m,
        }
    }
}

/// TCP path, or a blend at one of its ends.
#[derive(Clone, Debug, Serialize)]
struct CourseRow {
    /// Recording and motion, from 1; for a blend, the motion whose target is blended.
    recording: usize,
    motion: usize,
    /// `path`, `tcp_blend` or `joint_blend`.
    part: &'static str,
    /// Change of orientation and of E1.
    turn_deg: f64,
    e1_deg: f64,
    /// Largest deviations from the assumed laws.
    off_mm: f64,
    turn_off_deg: f64,
    e1_off_deg: f64,
    samples: usize,
}

fn key(part: CoursePart) -> &'static str {
    match part {
        CoursePart::Path => "path",
        CoursePart::TcpBlend => "tcp_blend",
        CoursePart::JointBlend => "joint_blend",
    }
}

impl From<&CourseObservation> for CourseRow {
    fn from(course: &CourseObservation) -> Self {
        Self {
            recording: course.recording + 1,
            motion: course.motion.number(),
            part: key(course.part),
            turn_deg: course.turn_rad.to_degrees(),
            e1_deg: course.e1_rad.to_degrees(),
            off_mm: 1e3 * course.off_m,
            turn_off_deg: course.turn_off_rad.to_degrees(),
            e1_off_deg: course.e1_off_rad.to_degrees(),
            samples: course.samples,
        }
    }
}

impl TcpFigures {
    /// Returns the figures; `None` if the recordings have no TCP paths.
    pub(super) fn of(identified: &Identified) -> Option<Self> {
        let is_empty = identified.tcp_blends.is_empty() && identified.courses.is_empty();
        (!is_empty).then(|| Self {
            kappa: identified
                .tcp_kappa
                .as_ref()
                .map(|kappa| KappaFigure::new(kappa, identified.tcp_blends.len())),
            reach: identified.tcp_reach.map(|reach| reach.map(Figure::from)),
            unequal_share: identified.tcp_unequal_share.map(Figure::from),
            blends: identified.tcp_blends.iter().map(TcpBlendRow::from).collect(),
            courses: identified.courses.iter().map(CourseRow::from).collect(),
        })
    }

    /// Writes lines about TCP paths.
    pub(super) fn write(&self, text: &mut String) {
        match &self.kappa {
            Some(kappa) => kappa.write(text, "kappa of TCP blends"),
            None => {
                let _ = writeln!(
                    text,
                    "kappa of TCP blends: not found; it needs blends between LINs at different \
                     angles ({} found)",
                    self.blends.len()
                );
            }
        }
        if let Some([before, after]) = &self.reach {
            let _ = writeln!(
                text,
                "They begin {before} times `cart_mm` before the target and end {after} times \
                 behind it, {}",
                blends(before.count)
            );
        }
        if let Some(share) = &self.unequal_share {
            let holds = share.is_zero_within(EQUAL_SHARE);
            let _ = writeln!(
                text,
                "They begin and end at equal ways: {}; the difference is {share} of that of sides \
                 that go by themselves, {}",
                if holds { "confirmed" } else { "not confirmed" },
                blends(share.count)
            );
        }
        for part in CoursePart::ALL {
            let name = key(part);
            let rows = || self.courses.iter().filter(|row| row.part == name);
            if rows().next().is_none() {
                continue;
            }
            let largest =
                |figure: &dyn Fn(&CourseRow) -> f64| rows().map(figure).fold(0.0, f64::max);
            let _ = writeln!(
                text,
                "{} {part}, at most away from what is assumed: TCP {:.3} mm, orientation {:.3} \
                 deg, E1 {:.3} deg",
                rows().count(),
                largest(&|row| row.off_mm),
                largest(&|row| row.turn_off_deg),
                largest(&|row| row.e1_off_deg)
            );
        }
    }
}
