//! Connection slots: selection of the connection to evict for a new one. Pure logic, without
//! sockets.
//!
//! A socket has a bounded number of slots for handshakes, and the same number for established
//! connections: clients without keys cannot displace clients with keys, and a new connection never
//! displaces one that has completed its handshake. Within each of the two groups, a new connection
//! always gets a slot:
//!
//! 1. **Holder.** A holder is a key or, during the handshake and without keys, an address. If the
//!    holder of the new connection has exhausted its quota, it loses a connection; the remaining
//!    slots are reserved for other holders. If all slots are occupied, the holder with the most
//!    connections loses one, the new connection included in the count.
//! 2. **Stage.** The connections of that holder are ordered by their [`ConnectionStage`]. The
//!    lowest stage with more than its share, a quarter of the connections, loses one. So progress
//!    protects a connection; and connections parked at a high stage cannot reduce the slots of new
//!    connections below the share.
//! 3. **Activity.** Within a stage, the least recently active connection is evicted: a new
//!    connection passes each stage unless a share of newer ones overtakes it. Within
//!    [`ConnectionStage::Busy`], connections with the most pending requests are evicted first,
//!    starting with the most recently active, because they lose least.

use std::{
    cmp::{Ordering, Reverse},
    collections::BTreeMap,
    net::{IpAddr, Ipv6Addr},
    time::Instant,
};

/// Identifier of a connection.
pub type PeerId = u64;

/// Reciprocal of two shares: the slots reserved for other holders, and the share of a stage.
const SHARES: usize = 4;

/// The owner of connections.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Holder {
    /// A machine: an IPv4 address, or the first address of a /64 network of IPv6.
    Address(IpAddr),
    /// The name of a permitted key.
    Key(String),
}

impl Holder {
    /// Returns the holder of connections from an address.
    pub(super) fn at(address: IpAddr) -> Self {
        // IPv4 addresses that are mapped to IPv6 are the same machine.
        Self::Address(match address.to_canonical() {
            IpAddr::V6(v6) if !v6.is_loopback() => {
                Ipv6Addr::from_bits(v6.to_bits() & (u128::MAX << 64)).into()
            }
            address => address,
        })
    }
}

/// Stage of a connection. Lower stages are evicted first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum ConnectionStage {
    /// Nothing has been received yet.
    Silent,
    /// A part of the greeting was received.
    Greeting,
    /// The greeting was received.
    Greeted,
    /// The first command of the handshake was received and is valid.
    Introduced,
    /// The handshake is complete, and the peer does not read its messages.
    Stalled,
    /// The handshake is complete, and neither a message nor a subscription was received.
    Fresh,
    /// No request is pending, or the peer is a subscriber.
    Idle,
    /// A request is pending.
    Busy,
    /// An urgent request is pending.
    Urgent,
}

impl ConnectionStage {
    /// Returns true if the handshake is incomplete.
    pub(super) fn is_handshake(self) -> bool {
        self < Self::Stalled
    }
}

/// Progress of a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Activity {
    pub(super) stage: ConnectionStage,
    /// Number of pending requests.
    pub(super) pending: usize,
    /// Time of the last handshake progress, request or reply.
    pub(super) since: Instant,
}

impl Activity {
    /// Records progress to a stage, now.
    pub(super) fn now(stage: ConnectionStage) -> Self {
        Self { stage, pending: 0, since: Instant::now() }
    }

    /// Compares two connections by the order of eviction within a stage.
    fn eviction_order(&self, other: &Self) -> Ordering {
        let oldest = self.since.cmp(&other.since);
        let by_pending = Reverse(self.pending).cmp(&Reverse(other.pending));
        by_pending.then(if self.stage == ConnectionStage::Busy { oldest.reverse() } else { oldest })
    }
}

/// A connection that occupies a slot.
#[derive(Clone, Debug)]
pub(super) struct Occupant {
    pub(super) holder: Holder,
    pub(super) activity: Activity,
}

/// Slots of a socket, for handshakes or for established connections.
#[derive(Clone, Copy, Debug)]
pub(super) struct ConnectionSlots {
    total: usize,
    per_holder: usize,
}

impl ConnectionSlots {
    /// Creates a number of slots, three quarters of which are available to one holder.
    pub(super) fn new(total: usize) -> Self {
        Self { total, per_holder: total - total / SHARES }
    }

    /// Returns the connection to evict for a new one; `None` if a slot is free for it.
    pub(super) fn victim<'a>(
        &self,
        occupants: impl Iterator<Item = (PeerId, &'a Occupant)>,
        newcomer: &Holder,
    ) -> Option<PeerId> {
        let mut occupants: Vec<_> = occupants.collect();
        let mut counts = BTreeMap::from([(newcomer, 1)]);
        for (_, occupant) in &occupants {
            *counts.entry(&occupant.holder).or_default() += 1;
        }
        if counts[newcomer] > self.per_holder {
            occupants.retain(|(_, it)| it.holder == *newcomer);
        } else if occupants.len() >= self.total {
            let max_held = counts.values().max().copied().unwrap_or_default();
            occupants.retain(|(_, it)| counts[&it.holder] == max_held);
        } else {
            return None;
        }
        let stage = over_share(&occupants)?;
        occupants.retain(|(_, it)| it.activity.stage == stage);
        let first = occupants.into_iter().min_by(|(id, it), (other_id, other)| {
            // Ids break ties of equal instants: the older connection has the lower one.
            it.activity.eviction_order(&other.activity).then(id.cmp(other_id))
        });
        first.map(|(id, _)| id)
    }
}

/// Returns the lowest stage with more than its share of connections.
fn over_share(occupants: &[(PeerId, &Occupant)]) -> Option<ConnectionStage> {
    let mut counts = BTreeMap::<ConnectionStage, usize>::new();
    for (_, it) in occupants {
        *counts.entry(it.activity.stage).or_default() += 1;
    }
    // Peers that do not read have no share.
    let share =
        |stage| if stage == ConnectionStage::Stalled { 0 } else { occupants.len() / SHARES };
    let over = counts.iter().find(|(stage, count)| **count > share(**stage));
    // If all stages have exactly their share, the lowest one loses.
    over.or(counts.first_key_value()).map(|(stage, _)| *stage)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use proptest::{prelude::*, sample::Index};

    use super::*;

    /// Connections by their identifiers.
    struct Scene {
        from: Instant,
        places: ConnectionSlots,
        occupants: BTreeMap<PeerId, Occupant>,
    }

    fn holder(number: u8) -> Holder {
        Holder::at([10, 0, 0, number].into())
    }

    impl Scene {
        fn new(total: usize) -> Self {
            let from = Instant::now();
            Self { from, places: ConnectionSlots::new(total), occupants: BTreeMap::new() }
        }

        /// Creates connections of one stage and holder, one second apart.
        fn of(stage: ConnectionStage, count: u64, total: usize) -> Self {
            let mut scene = Self::new(total);
            (0..count).for_each(|id| scene.put(id, stage, 1, 0, id));
            scene
        }

        fn put(
            &mut self,
            id: PeerId,
            stage: ConnectionStage,
            holder_number: u8,
            pending: usize,
            second: u64,
        ) {
            let since = self.from + Duration::from_secs(second);
            let activity = Activity { stage, pending, since };
            self.occupants.insert(id, Occupant { holder: holder(holder_number), activity });
        }

        fn victim(&self, newcomer: u8) -> Option<PeerId> {
            let occupants = self.occupants.iter().map(|(id, it)| (*id, it));
            self.places.victim(occupants, &holder(newcomer))
        }

        fn held(&self, holder_number: u8) -> usize {
            self.occupants.values().filter(|it| it.holder == holder(holder_number)).count()
        }

        /// Admits a new connection. Returns the victim.
        fn admit(
            &mut self,
            id: PeerId,
            stage: ConnectionStage,
            holder_number: u8,
            second: u64,
        ) -> Option<PeerId> {
            let victim = self.victim(holder_number);
            if let Some(victim) = victim {
                self.occupants.remove(&victim);
            }
            self.put(id, stage, holder_number, 0, second);
            victim
        }
    }

    #[test]
    fn the_smallest_progress_is_evicted_first() {
        let mut scene = Scene::of(ConnectionStage::Introduced, 40, 64);
        for (i, stage) in
            [ConnectionStage::Silent, ConnectionStage::Greeting, ConnectionStage::Greeted]
                .into_iter()
                .enumerate()
        {
            (0..13).for_each(|j| scene.put(100 * (i as u64 + 1) + j, stage, 1, 0, 900 + j));
        }
        // 79 handshakes: each stage has more than its share of 19, or none.
        scene.places = ConnectionSlots::new(80);
        assert_eq!(scene.victim(1), Some(0));
        (13..30).for_each(|j| scene.put(100 + j, ConnectionStage::Silent, 1, 0, 900 + j));
        assert_eq!(scene.victim(1), Some(100));
    }

    #[test]
    fn a_part_of_the_places_is_in_reserve() {
        let mut scene = Scene::of(ConnectionStage::Busy, 47, 64);
        assert_eq!(scene.victim(1), None);
        scene.put(47, ConnectionStage::Idle, 1, 0, 0);
        assert!(scene.victim(1).is_some());
        assert_eq!(scene.victim(2), None);
    }

    #[test]
    fn the_holder_with_most_connections_loses_one() {
        let mut scene = Scene::of(ConnectionStage::Urgent, 40, 64);
        (100..124).for_each(|id| scene.put(id, ConnectionStage::Silent, 2, 0, id));
        assert!(scene.victim(3).is_some_and(|id| id < 100));
        // The new connection counts.
        let mut scene = Scene::of(ConnectionStage::Idle, 32, 64);
        (100..132).for_each(|id| scene.put(id, ConnectionStage::Idle, 2, 0, id));
        assert!(scene.victim(1).is_some_and(|id| id < 100));
        assert!(scene.victim(2).is_some_and(|id| id >= 100));
        // Keys have separate quotas, independent of their addresses.
        for it in scene.occupants.values_mut() {
            it.holder = Holder::Key("bob".to_owned());
        }
        let occupants = || scene.occupants.iter().map(|(id, it)| (*id, it));
        let alice = Holder::Key("alice".to_owned());
        assert!(scene.places.victim(occupants(), &alice).is_some());
    }

    #[test]
    fn a_client_with_few_requests_keeps_its_place_among_pipelines() {
        let mut scene = Scene::new(64);
        (0..48).for_each(|id| scene.put(id, ConnectionStage::Busy, 1, 8, id));
        scene.put(20, ConnectionStage::Busy, 1, 1, 0);
        scene.put(30, ConnectionStage::Idle, 1, 0, 0);
        scene.put(40, ConnectionStage::Urgent, 1, 1, 0);
        for (id, second) in (100..200).zip(1000..) {
            let victim = scene.admit(id, ConnectionStage::Busy, 1, second);
            assert!(victim.is_some_and(|id| ![20, 30, 40].contains(&id)), "{victim:?}");
            scene.put(id, ConnectionStage::Busy, 1, 8, second);
        }
    }

    #[test]
    fn peers_that_do_not_read_are_evicted_first() {
        let mut scene = Scene::of(ConnectionStage::Fresh, 47, 64);
        scene.put(47, ConnectionStage::Stalled, 1, 0, 1000);
        assert_eq!(scene.victim(1), Some(47));
    }

    #[test]
    fn networks_of_ipv6_and_mapped_addresses_are_one_holder() {
        let at = |text: &str| Holder::at(text.parse().unwrap());
        assert_eq!(at("2001:db8::1"), at("2001:db8::ffff:1"));
        assert_ne!(at("2001:db8::1"), at("2001:db8:0:1::1"));
        assert_eq!(at("::ffff:10.0.0.1"), holder(1));
        assert_ne!(at("127.0.0.1"), at("127.0.0.2"));
        assert_eq!(at("::1"), Holder::Address("::1".parse().unwrap()));
    }

    /// Stages of a connection in order, from its beginning to a pending stop.
    const HANDSHAKE: [ConnectionStage; 4] = [
        ConnectionStage::Silent,
        ConnectionStage::Greeting,
        ConnectionStage::Greeted,
        ConnectionStage::Introduced,
    ];
    const ESTABLISHED: [ConnectionStage; 5] = [
        ConnectionStage::Stalled,
        ConnectionStage::Fresh,
        ConnectionStage::Idle,
        ConnectionStage::Busy,
        ConnectionStage::Urgent,
    ];

    const NEWCOMER: PeerId = 1000;

    fn any_stage() -> impl Strategy<Value = usize> {
        0..20_usize
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(500))]

        /// Quotas hold, and a holder with fewer than the most connections never loses one.
        #[test]
        fn quotas_hold(
            total in 4..80_usize,
            arrivals in prop::collection::vec((1..6_u8, any_stage(), 0..9_usize), 1..300),
        ) {
            let mut scene = Scene::new(total);
            for (i, (holder_number, stage, pending)) in arrivals.into_iter().enumerate() {
                let max_held = (1..6)
                    .map(|it| scene.held(it) + usize::from(it == holder_number))
                    .max()
                    .unwrap();
                let after_admission = scene.held(holder_number) + 1;
                let victim =
                    scene.victim(holder_number).map(|id| scene.occupants[&id].holder.clone());
                if let Some(victim) = victim {
                    let loses = (1..6).find(|it| holder(*it) == victim).unwrap();
                    let held = scene.held(loses) + usize::from(loses == holder_number);
                    prop_assert!(
                        held == max_held
                            || (loses == holder_number
                                && after_admission > scene.places.per_holder)
                    );
                }
                scene.admit(i as u64, ConnectionStage::Fresh, holder_number, i as u64);
                scene.put(i as u64, ESTABLISHED[stage % 5], holder_number, pending, i as u64);
                prop_assert!(scene.occupants.len() <= total);
                prop_assert!(
                    (1..6)
                        .all(|holder_number| scene.held(holder_number) <= scene.places.per_holder)
                );
            }
        }

        /// Regardless of other connections of its address, a new connection keeps its slot at a
        /// stage until as many connections as the share enter this stage after it.
        #[test]
        fn a_newcomer_passes_each_stage(
            is_established in any::<bool>(),
            stage in any_stage(),
            parked in prop::collection::vec((any_stage(), 0..9_usize), 48),
            moves in prop::collection::vec((any::<Index>(), any_stage(), 0..9_usize), 300),
        ) {
            let stages: &[ConnectionStage] = if is_established { &ESTABLISHED } else { &HANDSHAKE };
            let first = stages[usize::from(is_established)];
            // Stages of a stop: neither `Stalled` nor `Busy`.
            let newcomer_stage = if is_established { [1, 2, 4][stage % 3] } else { stage % 4 };
            let mut scene = Scene::new(64);
            let put = |scene: &mut Scene, id, stage: usize, pending: usize, second| {
                let stage = stages[stage % stages.len()];
                let pending = if stage >= ConnectionStage::Busy { pending.max(1) } else { 0 };
                scene.put(id, stage, 1, pending, second);
                usize::from(stage == stages[newcomer_stage])
            };
            for (id, (stage, pending)) in parked.into_iter().enumerate() {
                put(&mut scene, id as u64, stage, pending, id as u64);
            }
            scene.admit(NEWCOMER, first, 1, 1000);
            put(&mut scene, NEWCOMER, newcomer_stage, 1, 1000);
            let mut entered = 0;
            for (i, (index, stage, pending)) in moves.into_iter().enumerate() {
                let second = 1001 + i as u64;
                if i % 3 == 0 {
                    scene.admit(NEWCOMER + second, first, 1, second);
                    entered += usize::from(first == stages[newcomer_stage]);
                }
                if entered > scene.occupants.len() / SHARES {
                    break;
                }
                prop_assert!(scene.occupants.contains_key(&NEWCOMER), "{entered} after move {i}");
                let ids: Vec<_> =
                    scene.occupants.keys().copied().filter(|id| *id != NEWCOMER).collect();
                entered += put(&mut scene, *index.get(&ids), stage, pending, second);
            }
        }
    }
}
