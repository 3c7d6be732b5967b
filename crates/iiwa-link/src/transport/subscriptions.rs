//! What a subscriber wants to hear.

use bytes::Bytes;

/// Most topics of a subscriber. The drive has two.
const MOST: usize = 32;

/// Longest topic that is kept, in bytes: a longer one is the beginning of none.
const LONGEST: usize = 64;

/// Beginnings of topics.
#[derive(Debug, Default)]
pub(super) struct Subscriptions(Vec<Bytes>);

impl Subscriptions {
    /// Wants topics that begin so. `false` if these are too many.
    pub(super) fn add(&mut self, topic: &[u8]) -> bool {
        if topic.len() > LONGEST || self.0.iter().any(|known| known == topic) {
            return true;
        }
        // Not a slice of what it came in, which would be kept with it.
        self.0.push(Bytes::copy_from_slice(topic));
        self.0.len() <= MOST
    }

    /// Wants them no longer.
    pub(super) fn remove(&mut self, topic: &[u8]) {
        self.0.retain(|known| known != topic);
    }

    /// Whether this topic is wanted.
    pub(super) fn want(&self, topic: &[u8]) -> bool {
        self.0.iter().any(|beginning| topic.starts_with(beginning))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_are_wanted_by_their_beginnings() {
        let mut topics = Subscriptions::default();
        assert!(!topics.want(b"joints"));
        assert!(topics.add(b"jo") && topics.add(b"state") && topics.add(&[b'j'; 1000]));
        assert!(topics.want(b"joints") && topics.want(b"state") && !topics.want(b"stat"));
        topics.remove(b"jo");
        assert!(!topics.want(b"joints"));
        assert!(topics.add(b"") && topics.want(b"joints"));
    }

    #[test]
    fn there_is_an_end_to_them() {
        let mut topics = Subscriptions::default();
        assert!((0..MOST).all(|i| topics.add(i.to_string().as_bytes())));
        assert!(topics.add(b"0"));
        assert!(!topics.add(b"one too many"));
    }
}
