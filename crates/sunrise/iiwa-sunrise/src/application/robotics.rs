//! KUKA's API: the evaluation that calls it, and the station that it acts on.

use std::ops::{Deref, DerefMut};

use iiwa_java::Machine;

use crate::application::station::Station;

/// Evaluation and station during an API call. The API is implemented in the `*_api` modules and
/// others named after their subject.
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
