//! A network that loses, duplicates and delays datagrams, reproducible by its seed.

/// One direction of the network.
pub(crate) struct Network {
    random: Random,
    /// Share of lost datagrams.
    pub loss: f64,
    /// Share of duplicated datagrams.
    pub doubled: f64,
    /// Share of delayed datagrams, and the maximum delay in cycles.
    pub delayed: (f64, u32),
    cycle: u32,
    under_way: Vec<(u32, Vec<u8>)>,
}

impl Network {
    /// Creates a perfect network.
    pub(crate) fn new(seed: u64) -> Self {
        let random = Random(seed);
        Self { random, loss: 0.0, doubled: 0.0, delayed: (0.0, 1), cycle: 0, under_way: Vec::new() }
    }

    pub(crate) fn send(&mut self, datagram: &[u8]) {
        if self.random.share() < self.loss {
            return;
        }
        let copies = if self.random.share() < self.doubled { 2 } else { 1 };
        for _ in 0..copies {
            let (share, longest) = self.delayed;
            let delay =
                if self.random.share() < share { 1 + self.random.below(longest) } else { 0 };
            self.under_way.push((self.cycle + delay, datagram.to_vec()));
        }
    }

    /// Returns the datagrams that have arrived.
    pub(crate) fn receive(&mut self) -> Vec<Vec<u8>> {
        let cycle = self.cycle;
        self.under_way.extract_if(.., |(due, _)| *due <= cycle).map(|(_, bytes)| bytes).collect()
    }

    pub(crate) fn next_cycle(&mut self) {
        self.cycle += 1;
    }
}

/// Splitmix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number from 0 to below 1.
    fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, end: u32) -> u32 {
        u32::try_from(self.next() % u64::from(end)).unwrap()
    }
}
