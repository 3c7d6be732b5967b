//! PTP motions from rest to rest, as recorded under Sunrise.

mod end_ramp;
mod line;
mod ramp;
mod ramp_limits;

pub(crate) use end_ramp::EndRamp;
pub(crate) use line::{RampedLine, instants};
pub(crate) use ramp::Ramp;
pub use ramp::{RampPhase, RampStart};
pub(crate) use ramp_limits::ramp_limits;
