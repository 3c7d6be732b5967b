//! A network that loses, duplicates, delays and reorders datagrams.

use fastrand::Rng;

/// One direction of the network.
#[derive(Default)]
pub(super) struct Network {
    pub(super) loss: f64,
    pub(super) doubled: f64,
    pub(super) delayed: f64,
    /// All datagrams before this cycle are lost.
    pub(super) dead_until: u64,
    pub(super) under_way: Vec<(u64, Vec<u8>)>,
}

impl Network {
    pub(super) fn send(&mut self, datagram: &[u8], cycle: u64, random: &mut Rng) {
        if cycle < self.dead_until || random.f64() < self.loss {
            return;
        }
        for _ in 0..if random.f64() < self.doubled { 2 } else { 1 } {
            let late = if random.f64() < self.delayed { random.u64(1..4) } else { 0 };
            self.under_way.push((cycle + late, datagram.to_vec()));
        }
    }

    /// Returns the datagrams that have arrived by `cycle`, sometimes in reverse order.
    pub(super) fn receive(&mut self, cycle: u64, random: &mut Rng) -> Vec<Vec<u8>> {
        let mut arrived: Vec<_> = self.under_way.extract_if(.., |(due, _)| *due <= cycle).collect();
        if self.delayed > 0.0 && random.bool() {
            arrived.reverse();
        }
        arrived.into_iter().map(|(_, datagram)| datagram).collect()
    }
}
