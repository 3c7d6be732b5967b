//! Torques of the stream, for the samples that they belong to.

use std::collections::HashMap;

use iiwa_kin::Joints;

/// Measured torques by the exact stamps that they were published with.
///
/// The drive publishes torques and positions with the stamp that it keeps with the samples of a run: one number, so that
/// nothing has to be near.
#[derive(Debug, Default)]
pub struct Torques(HashMap<u64, Joints>);

impl Torques {
    /// Keeps torques in Nm, by their stamp in s.
    pub fn keep(&mut self, t_s: f64, measured_nm: Joints) {
        self.0.insert(t_s.to_bits(), measured_nm);
    }

    /// Those of each stamp, where there are any.
    #[must_use]
    pub fn at(&self, t_s: &[f64]) -> Vec<Option<Joints>> {
        t_s.iter().map(|t_s| self.0.get(&t_s.to_bits()).copied()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn torques_are_those_of_their_stamp() {
        let stamps = [0.1, 0.1 + 0.2, 0.3, 0.4];
        let mut torques = Torques::default();
        torques.keep(0.4, [4.0; 7]);
        torques.keep(0.1 + 0.2, [3.0; 7]);
        assert_eq!(torques.at(&stamps), [None, Some([3.0; 7]), None, Some([4.0; 7])]);
    }
}
