//! Stream torques, matched to samples.

use std::collections::HashMap;

use iiwa_kin::Joints;

/// Measured torques by the exact stamps of their publication.
///
/// The drive publishes torques and positions with the stamp that it stores with the samples of a
/// run. Since the numbers are identical, a tolerance is not needed.
#[derive(Debug, Default)]
pub struct Torques(HashMap<u64, Joints>);

impl Torques {
    /// Stores torques in Nm, by their stamp in s.
    pub fn keep(&mut self, t_s: f64, measured_nm: Joints) {
        self.0.insert(t_s.to_bits(), measured_nm);
    }

    /// Adds other torques.
    pub fn extend(&mut self, others: Self) {
        self.0.extend(others.0);
    }

    /// Returns the torques at each stamp, if any.
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
