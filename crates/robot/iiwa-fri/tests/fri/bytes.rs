//! Round trips, and bytes that are not messages.

use iiwa_fri::{
    Controller, Format, FriClient, MAX_DATAGRAM_BYTES, Reading, SessionState, WireError,
};
use proptest::prelude::*;

use crate::messages::{any_command, any_monitoring};

const FORMAT: Format = Format::V1;

/// Returns a message with some bytes changed or cut off.
fn damaged() -> impl Strategy<Value = Vec<u8>> {
    let message = prop_oneof![
        any_monitoring().prop_map(|message| {
            let mut bytes = Vec::new();
            FORMAT.encode_monitoring(&message, &mut bytes);
            bytes
        }),
        any_command().prop_map(|message| {
            let mut bytes = Vec::new();
            FORMAT.encode_command(&message, &mut bytes);
            bytes
        }),
    ];
    let changes = prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4);
    (message, changes, any::<prop::sample::Index>()).prop_map(|(mut bytes, changes, end)| {
        for (place, byte) in changes {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        bytes.truncate(end.index(2 * bytes.len()));
        bytes
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn monitoring_messages_round_trip(message in any_monitoring()) {
        let mut bytes = vec![7; 7];
        FORMAT.encode_monitoring(&message, &mut bytes);
        prop_assert!(bytes.len() <= MAX_DATAGRAM_BYTES);
        prop_assert_eq!(FORMAT.decode_monitoring(&bytes).unwrap(), message);
        prop_assert!(FORMAT.decode_command(&bytes).is_err());
    }

    #[test]
    fn command_messages_round_trip(message in any_command()) {
        let mut bytes = vec![7; 7];
        FORMAT.encode_command(&message, &mut bytes);
        prop_assert!(bytes.len() <= MAX_DATAGRAM_BYTES);
        prop_assert_eq!(FORMAT.decode_command(&bytes).unwrap(), message);
        prop_assert!(FORMAT.decode_monitoring(&bytes).is_err());
    }

    /// Invalid datagrams are counted and not answered; messages are answered.
    #[test]
    fn any_bytes_are_survived(
        datagrams in prop::collection::vec(
            prop_oneof![prop::collection::vec(any::<u8>(), 0..1600), damaged()], 1..8,
        ),
    ) {
        let mut client = FriClient::new(FORMAT);
        let mut controller = Controller::default();
        let mut out = Vec::new();
        for (datagram, round) in datagrams.iter().zip(1..) {
            let fresh = client.receive(datagram).is_ok();
            let answered = client.answer(None, &mut out);
            prop_assert!(fresh || !answered);
            prop_assert_eq!(answered, FORMAT.decode_command(&out).is_ok());
            prop_assert_eq!(client.counters().received + client.counters().invalid, round);

            prop_assert!(controller.tick(&Reading::default(), &mut out));
            let result = controller.receive(datagram);
            prop_assert_eq!(result.is_ok(), FORMAT.decode_command(datagram).is_ok());
        }
        prop_assert_eq!(controller.state(), SessionState::MonitoringWait);
    }
}

#[test]
fn long_datagrams_are_refused_unread() {
    let bytes = [0; MAX_DATAGRAM_BYTES + 1];
    let expected = WireError::TooLong { found: 1501 };
    assert_eq!(FORMAT.decode_monitoring(&bytes), Err(expected.clone()));
    assert_eq!(FORMAT.decode_command(&bytes), Err(expected));
}
