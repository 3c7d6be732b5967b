//! Admission of connections: which one is evicted for a new one when the quota is exhausted.
//!
//! Connections with an incomplete handshake and established ones have separate quotas, so that clients
//! without keys cannot displace those with keys. The victim is one of the address with the most
//! connections: a machine that opens many of them loses its own.

use std::{cmp::Reverse, collections::BTreeMap, net::IpAddr, time::Instant};

/// The identifier of a connection.
pub type PeerId = u64;

/// Quota of connections with an incomplete handshake.
pub(super) const HANDSHAKE_QUOTA: usize = 64;

/// Quota of established connections.
pub(super) const PEER_QUOTA: usize = 64;

/// The status of a connection.
#[derive(Clone, Copy, Debug)]
pub(super) struct ConnectionStatus {
    pub(super) address: IpAddr,
    pub(super) stage: Stage,
    /// When it entered this stage.
    pub(super) since: Instant,
}

/// The stage of a connection. Earlier ones are evicted first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Stage {
    /// Nothing was received yet.
    Silent,
    /// The handshake is in progress.
    Handshake,
    /// The peer does not read its messages.
    Stalled,
    /// No request is pending.
    Idle,
    /// A request is pending, or the peer is a subscriber.
    Served,
}

impl Stage {
    fn is_handshake(self) -> bool {
        self < Self::Stalled
    }
}

/// The decision on a new connection. Connections being served are never evicted.
pub(super) enum Admission {
    /// The quota is not exhausted.
    Free,
    /// This connection has to be evicted.
    Evict(PeerId),
    /// The connection cannot be admitted.
    Full,
}

/// Decides on one more handshake, or on one more established connection.
pub(super) fn admit<'a>(
    connections: impl Iterator<Item = (&'a PeerId, &'a ConnectionStatus)>,
    is_handshake: bool,
) -> Admission {
    let connections: Vec<_> =
        connections.filter(|(_, it)| it.stage.is_handshake() == is_handshake).collect();
    if connections.len() < if is_handshake { HANDSHAKE_QUOTA } else { PEER_QUOTA } {
        return Admission::Free;
    }
    let mut per_address = BTreeMap::<IpAddr, usize>::new();
    for (_, it) in &connections {
        *per_address.entry(it.address).or_default() += 1;
    }
    let victim = connections
        .into_iter()
        .filter(|(_, it)| it.stage != Stage::Served)
        .min_by_key(|(_, it)| (Reverse(per_address[&it.address]), it.stage, it.since));
    victim.map_or(Admission::Full, |(id, _)| Admission::Evict(*id))
}

#[cfg(test)]
mod tests {
    use std::{collections::HashMap, time::Duration};

    use super::*;

    struct Scene {
        from: Instant,
        connections: HashMap<PeerId, ConnectionStatus>,
    }

    impl Scene {
        /// Connections of one stage and address, each a second after the one before.
        fn of(stage: Stage, count: usize) -> Self {
            let mut scene = Self { from: Instant::now(), connections: HashMap::new() };
            (0..count).for_each(|id| scene.put(id as u64, stage, 1, id as u64));
            scene
        }

        fn put(&mut self, id: PeerId, stage: Stage, address: u8, second: u64) {
            let since = self.from + Duration::from_secs(second);
            let address = IpAddr::from([10, 0, 0, address]);
            self.connections.insert(id, ConnectionStatus { address, stage, since });
        }

        fn evicted(&self, is_handshake: bool) -> Option<PeerId> {
            match admit(self.connections.iter(), is_handshake) {
                Admission::Evict(id) => Some(id),
                Admission::Free | Admission::Full => None,
            }
        }
    }

    #[test]
    fn silent_connections_are_evicted_first() {
        let mut scene = Scene::of(Stage::Handshake, HANDSHAKE_QUOTA - 1);
        assert!(matches!(admit(scene.connections.iter(), true), Admission::Free));
        scene.put(1000, Stage::Silent, 1, 1000);
        assert_eq!(scene.evicted(true), Some(1000));
        scene.put(1000, Stage::Handshake, 1, 1000);
        assert_eq!(scene.evicted(true), Some(0));
        // Established connections have a quota of their own.
        assert!(matches!(admit(scene.connections.iter(), false), Admission::Free));
    }

    #[test]
    fn the_address_with_most_connections_loses_one() {
        let mut scene = Scene::of(Stage::Handshake, HANDSHAKE_QUOTA);
        scene.put(0, Stage::Silent, 2, 0);
        assert_eq!(scene.evicted(true), Some(1));
    }

    #[test]
    fn served_connections_are_not_evicted() {
        let mut scene = Scene::of(Stage::Served, PEER_QUOTA);
        assert!(matches!(admit(scene.connections.iter(), false), Admission::Full));
        scene.put(30, Stage::Idle, 1, 30);
        scene.put(40, Stage::Idle, 1, 20);
        assert_eq!(scene.evicted(false), Some(40));
        scene.put(50, Stage::Stalled, 1, 1000);
        assert_eq!(scene.evicted(false), Some(50));
        // A single idle connection of another address.
        let mut scene = Scene::of(Stage::Served, PEER_QUOTA - 1);
        scene.put(1000, Stage::Idle, 2, 1000);
        assert_eq!(scene.evicted(false), Some(1000));
    }
}
