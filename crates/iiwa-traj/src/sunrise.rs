//! How Sunrise was seen to plan a PTP from rest to rest: no other motion's time is known in closed form.

mod line;
mod ramp;
mod root;

pub(crate) use line::{RampedLine, instants};
