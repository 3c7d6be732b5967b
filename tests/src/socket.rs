//! Multipart `ZeroMQ` sockets without keys, for tests: blocking, and used by one thread at a time.
//!
//! By default they are bare peers ([`zmtp`](crate::zmtp)), with the feature `libzmq` they use that
//! library. Both follow the same rules:
//!
//! - a connecting socket connects in the background, retries, and reconnects after a lost
//!   connection
//! - a bound socket accepts connections at any time
//! - a message to a lost connection is lost
//! - dropping a socket leaves neither threads nor unsent messages

#[cfg(not(feature = "libzmq"))]
mod bare;
#[cfg(feature = "libzmq")]
mod libzmq;

use std::time::Duration;

#[cfg(not(feature = "libzmq"))]
pub use bare::{BareSocket as Socket, receive_any};
#[cfg(feature = "libzmq")]
pub use libzmq::{LibzmqSocket as Socket, receive_any};

/// Time limit for obtaining a connection to send on, and for the peer's handshake.
const SEND_TIMEOUT: Duration = Duration::from_secs(10);

/// Type of a socket.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SocketType {
    /// REQ: an empty frame is added in front of each sent message, and removed from received ones.
    Req,
    /// DEALER: messages are sent and received as they are.
    Dealer,
    /// ROUTER: the first frame is the route to a peer, which is added to received messages.
    /// Messages to unknown peers are dropped.
    Router,
    /// SUB: holds one received message. Further ones remain in the system buffers, which are small.
    Sub,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ports::free_address;

    const LONG: Duration = Duration::from_secs(20);

    fn address() -> String {
        format!("tcp://{}", free_address())
    }

    fn texts(frames: &[Vec<u8>]) -> Vec<&str> {
        frames.iter().map(|frame| std::str::from_utf8(frame).unwrap()).collect()
    }

    #[test]
    fn requests_are_routed_and_answered() {
        let address = address();
        let clients = [(), ()].map(|()| Socket::connect(SocketType::Req, &address).unwrap());
        let server = Socket::bind(SocketType::Router, &address).unwrap();
        for client in &clients {
            client.send(&["question", "more"]).unwrap();
        }
        let questions = [(), ()].map(|()| server.receive(LONG).unwrap());
        assert_ne!(questions[0][0], questions[1][0]);
        for question in questions {
            assert_eq!(texts(&question[1..]), ["", "question", "more"]);
            server.send(&[&question[0], b"".as_slice(), b"answer"]).unwrap();
        }
        for client in &clients {
            assert_eq!(texts(&client.receive(LONG).unwrap()), ["answer"]);
            assert_eq!(client.receive(Duration::ZERO), None);
        }
        server.send(&["nobody", "", "answer"]).unwrap();
    }

    #[test]
    fn a_lost_connection_is_replaced() {
        let address = address();
        let server = Socket::bind(SocketType::Dealer, &address).unwrap();
        assert!(!server.try_send(&["nobody is there"]));
        let client = Socket::connect(SocketType::Dealer, &address).unwrap();
        server.send(&["first"]).unwrap();
        assert_eq!(texts(&client.receive(LONG).unwrap()), ["first"]);
        drop(server);
        let server = Socket::bind(SocketType::Dealer, &address).unwrap();
        server.send(&["second", ""]).unwrap();
        assert_eq!(texts(&client.receive(LONG).unwrap()), ["second", ""]);
        // The peer may also be replaced.
        drop(client);
        let client = Socket::connect(SocketType::Dealer, &address).unwrap();
        client.send(&[vec![7; 300_000]]).unwrap();
        assert_eq!(server.receive(LONG).unwrap(), [vec![7; 300_000]]);
    }

    #[test]
    fn of_two_sockets_the_one_with_a_message_is_received_from() {
        let [first, beside] = [address(), address()];
        let servers =
            [&first, &beside].map(|address| Socket::bind(SocketType::Dealer, address).unwrap());
        let clients =
            [&first, &beside].map(|address| Socket::connect(SocketType::Dealer, address).unwrap());
        assert_eq!(receive_any(&[&clients[0], &clients[1]], Duration::from_millis(20)), None);
        for place in [1, 0, 1] {
            servers[place].send(&["it"]).unwrap();
            let (from, frames) = receive_any(&[&clients[0], &clients[1]], LONG).unwrap();
            assert_eq!((from, texts(&frames)), (place, vec!["it"]));
        }
    }

    #[test]
    fn an_address_in_use_cannot_be_bound() {
        let address = address();
        let _bound = Socket::bind(SocketType::Router, &address).unwrap();
        assert!(Socket::bind(SocketType::Router, &address).is_err());
    }
}
