//! Subscriptions of a subscriber.

use bytes::Bytes;

/// Maximum number of subscriptions. The drive has four topics.
const MAX_TOPICS: usize = 32;

/// Maximum length of a stored subscription, in bytes: a longer one does not match any topic.
const MAX_TOPIC_BYTES: usize = 64;

/// Topic prefixes.
#[derive(Debug, Default)]
pub(super) struct Subscriptions(Vec<Bytes>);

impl Subscriptions {
    /// Subscribes to topics with a prefix. Returns `false` if there are too many subscriptions.
    pub(super) fn add(&mut self, topic: &[u8]) -> bool {
        if topic.len() > MAX_TOPIC_BYTES || self.0.iter().any(|known| known == topic) {
            return true;
        }
        // A copy: a slice would keep the whole received buffer alive.
        self.0.push(Bytes::copy_from_slice(topic));
        self.0.len() <= MAX_TOPICS
    }

    /// Cancels a subscription.
    pub(super) fn remove(&mut self, topic: &[u8]) {
        self.0.retain(|known| known != topic);
    }

    /// Returns true if a topic is subscribed to.
    pub(super) fn matches(&self, topic: &[u8]) -> bool {
        self.0.iter().any(|prefix| topic.starts_with(prefix))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_are_matched_by_prefix() {
        let mut topics = Subscriptions::default();
        assert!(!topics.matches(b"joints"));
        assert!(topics.add(b"jo") && topics.add(b"state") && topics.add(&[b'j'; 1000]));
        assert!(topics.matches(b"joints") && topics.matches(b"state") && !topics.matches(b"stat"));
        topics.remove(b"jo");
        assert!(!topics.matches(b"joints"));
        assert!(topics.add(b"") && topics.matches(b"joints"));
    }

    #[test]
    fn the_number_of_subscriptions_is_bounded() {
        let mut topics = Subscriptions::default();
        assert!((0..MAX_TOPICS).all(|i| topics.add(i.to_string().as_bytes())));
        assert!(topics.add(b"0"));
        assert!(!topics.add(b"one too many"));
    }
}
