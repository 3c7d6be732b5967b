//! PTP motions from rest to rest as recordings show them under Sunrise.

mod line;
mod ramp;
mod root;

pub(crate) use line::{RampedLine, instants};
pub(crate) use ramp::Ramp;
pub use ramp::{RampPhase, RampStart};
