//! What KUKA's API does: the evaluation that calls it, and the station that it is about.

use std::ops::{Deref, DerefMut};

use iiwa_java::Machine;

use crate::application::station::Station;

/// An evaluation and its station, for the time of a call. What the API does is in the files that are named after it.
pub(crate) struct Robotics<'m> {
    pub(crate) machine: &'m mut Machine,
    pub(crate) station: &'m mut Station,
}

impl Deref for Robotics<'_> {
    type Target = Machine;

    fn deref(&self) -> &Machine {
        self.machine
    }
}

impl DerefMut for Robotics<'_> {
    fn deref_mut(&mut self) -> &mut Machine {
        self.machine
    }
}
