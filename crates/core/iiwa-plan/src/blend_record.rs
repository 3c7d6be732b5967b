//! Blends in the figures of a plan.

use iiwa_path::ShortenedBlend;
use iiwa_traj::{BlendFigures, LateBlend};
use serde::{Deserialize, Serialize};

/// A blend between two motions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BlendRecord {
    /// Motion whose target is blended, from 1.
    pub after_motion: usize,
    /// Angle between the two motions, in deg: between the TCP directions in a blend between two
    /// paths of one TCP on which the wrist joints are not interpolated, otherwise in joint space.
    pub gamma_deg: f64,
    /// Joint positions at the start of the blend, in rad.
    pub start_rad: [f64; 7],
    /// Joint positions at the end of the blend, in rad.
    pub end_rad: [f64; 7],
    /// Joint positions at the middle of the blend, in rad.
    pub mid_rad: [f64; 7],
    /// Flange position at the middle of the blend, in m; despite the name, also with a tool.
    pub mid_tcp_m: [f64; 3],
    /// Start time, in s.
    pub start_s: f64,
    /// End time, in s.
    pub end_s: f64,
    /// Difference from the radius in the program, if the blend is smaller.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shortened: Option<ShortenedBlendRecord>,
}

/// Radius of a blend that would exceed half of a motion or, next to a spline, half of the spline's
/// first or last segment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShortenedBlendRecord {
    /// Motion of which the blend takes half, from 1.
    pub half_of_motion: usize,
    /// Radius in the program, in mm.
    pub asked_mm: f64,
    /// Distance of the TCP from the target at the end of the blend, in mm.
    pub used_mm: f64,
}

/// A blend into a motion that is not known in time: the robot stops at the start of the blend.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LateBlendRecord {
    /// Motion whose target is blended, from 1.
    pub after_motion: usize,
    /// Time at which the next motion is known, after the preceding waits, in s.
    pub known_s: f64,
    /// Latest time at which the next motion would have to be known to avoid the stop, in s.
    pub needed_s: f64,
}

impl From<&LateBlend> for LateBlendRecord {
    fn from(late: &LateBlend) -> Self {
        let LateBlend { after_motion, known_s, needed_s } = *late;
        Self { after_motion: after_motion.number(), known_s, needed_s }
    }
}

impl From<&BlendFigures> for BlendRecord {
    fn from(figures: &BlendFigures) -> Self {
        Self {
            after_motion: figures.motion.number(),
            gamma_deg: figures.gamma_deg,
            start_rad: figures.start_rad,
            end_rad: figures.end_rad,
            mid_rad: figures.mid_rad,
            mid_tcp_m: figures.mid_tcp_m,
            start_s: figures.start_s,
            end_s: figures.end_s,
            shortened: figures.shortened.as_ref().map(ShortenedBlendRecord::from),
        }
    }
}

impl From<&ShortenedBlend> for ShortenedBlendRecord {
    fn from(shortened: &ShortenedBlend) -> Self {
        let ShortenedBlend { half_of, asked_mm, used_mm } = *shortened;
        Self { half_of_motion: half_of.number(), asked_mm, used_mm }
    }
}
