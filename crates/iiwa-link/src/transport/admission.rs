//! Who makes room for a newcomer when all places are taken.
//!
//! Strangers, whose handshake is not complete, and peers have places of their own, so that strangers take
//! none from those who are known. The address that holds most of the places gives one up: whoever opens
//! many connections from one machine, loses those.

use std::{cmp::Reverse, collections::BTreeMap, net::IpAddr, time::Instant};

/// A connection's number.
pub type PeerId = u64;

/// Most connections whose handshake is not complete.
pub(super) const STRANGERS: usize = 64;

/// Most connections whose handshake is.
pub(super) const PEERS: usize = 64;

/// What is known of a connection.
#[derive(Clone, Copy, Debug)]
pub(super) struct Standing {
    pub(super) address: IpAddr,
    pub(super) stage: Stage,
    /// Since when it is at this stage.
    pub(super) since: Instant,
}

/// How far a connection has come. The least goes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Stage {
    /// It has sent nothing so far.
    Silent,
    /// It shakes hands.
    Greeting,
    /// It does not read what is sent to it.
    Clogged,
    /// It has been answered, or has not asked yet.
    Idle,
    /// It waits for an answer, or follows what is published.
    Served,
}

impl Stage {
    fn is_stranger(self) -> bool {
        self < Self::Clogged
    }
}

/// Who goes, if one has to, for a connection that comes to this stage. Who is served never does: then
/// there is no place.
pub(super) enum Room {
    Enough,
    For(PeerId),
    None,
}

/// Whether there is room for one more stranger, or for one more peer.
pub(super) fn room<'a>(
    taken: impl Iterator<Item = (&'a PeerId, &'a Standing)>,
    stranger: bool,
) -> Room {
    let taken: Vec<_> = taken.filter(|(_, it)| it.stage.is_stranger() == stranger).collect();
    if taken.len() < if stranger { STRANGERS } else { PEERS } {
        return Room::Enough;
    }
    let mut of_address = BTreeMap::<IpAddr, usize>::new();
    for (_, it) in &taken {
        *of_address.entry(it.address).or_default() += 1;
    }
    let first = taken
        .into_iter()
        .filter(|(_, it)| it.stage != Stage::Served)
        .min_by_key(|(_, it)| (Reverse(of_address[&it.address]), it.stage, it.since));
    first.map_or(Room::None, |(id, _)| Room::For(*id))
}

#[cfg(test)]
mod tests {
    use std::{collections::HashMap, time::Duration};

    use super::*;

    struct Scene {
        from: Instant,
        taken: HashMap<PeerId, Standing>,
    }

    impl Scene {
        /// All of one stage and address, each a second after the one before.
        fn of(stage: Stage, count: usize) -> Self {
            let mut scene = Self { from: Instant::now(), taken: HashMap::new() };
            (0..count).for_each(|id| scene.put(id as u64, stage, 1, id as u64));
            scene
        }

        fn put(&mut self, id: PeerId, stage: Stage, address: u8, second: u64) {
            let since = self.from + Duration::from_secs(second);
            let address = IpAddr::from([10, 0, 0, address]);
            self.taken.insert(id, Standing { address, stage, since });
        }

        fn goes(&self, stranger: bool) -> Option<PeerId> {
            match room(self.taken.iter(), stranger) {
                Room::For(id) => Some(id),
                Room::Enough | Room::None => None,
            }
        }
    }

    #[test]
    fn who_has_sent_nothing_goes_first() {
        let mut scene = Scene::of(Stage::Greeting, STRANGERS - 1);
        assert!(matches!(room(scene.taken.iter(), true), Room::Enough));
        scene.put(1000, Stage::Silent, 1, 1000);
        assert_eq!(scene.goes(true), Some(1000));
        scene.put(1000, Stage::Greeting, 1, 1000);
        assert_eq!(scene.goes(true), Some(0));
        // Peers have places of their own.
        assert!(matches!(room(scene.taken.iter(), false), Room::Enough));
    }

    #[test]
    fn the_address_with_most_connections_loses_one() {
        let mut scene = Scene::of(Stage::Greeting, STRANGERS);
        scene.put(0, Stage::Silent, 2, 0);
        assert_eq!(scene.goes(true), Some(1));
    }

    #[test]
    fn who_is_served_keeps_its_place() {
        let mut scene = Scene::of(Stage::Served, PEERS);
        assert!(matches!(room(scene.taken.iter(), false), Room::None));
        scene.put(30, Stage::Idle, 1, 30);
        scene.put(40, Stage::Idle, 1, 20);
        assert_eq!(scene.goes(false), Some(40));
        scene.put(50, Stage::Clogged, 1, 1000);
        assert_eq!(scene.goes(false), Some(50));
        // Of another address, if need be.
        let mut scene = Scene::of(Stage::Served, PEERS - 1);
        scene.put(1000, Stage::Idle, 2, 1000);
        assert_eq!(scene.goes(false), Some(1000));
    }
}
