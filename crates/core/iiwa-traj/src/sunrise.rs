//! PTP motions from rest to rest, as recorded under Sunrise.

mod end_ramp;
mod line;
mod ramp;

pub(crate) use end_ramp::EndRamp;
pub(crate) use line::{RampedLine, instants};
pub(crate) use ramp::{Ramp, ramp_limits};
pub use ramp::{RampPhase, RampStart};
