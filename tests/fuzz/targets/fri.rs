//! FRI datagrams, for both sides: alone, and as the frames of a session, with their lengths in
//! front.

#![no_main]

use iiwa_fri::{Controller, Format, FriClient, Reading};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut out = Vec::new();
    if let Ok(message) = Format::V1.decode_monitoring(bytes) {
        Format::V1.encode_monitoring(&message, &mut out);
        assert_eq!(Format::V1.decode_monitoring(&out).expect("it was written"), message);
    }
    if let Ok(message) = Format::V1.decode_command(bytes) {
        Format::V1.encode_command(&message, &mut out);
        assert_eq!(Format::V1.decode_command(&out).expect("it was written"), message);
    }
    let mut client = FriClient::new(Format::V1);
    let mut controller = Controller::default();
    controller.request_commanding();
    for datagram in std::iter::once(bytes).chain(frames(bytes)) {
        let received = client.receive(datagram);
        if client.answer(None, &mut out) {
            assert!(received.is_ok());
            Format::V1.decode_command(&out).expect("an answer");
        }
        if controller.tick(&Reading::default(), &mut out) {
            Format::V1.decode_monitoring(&out).expect("a message");
        }
        let _ = controller.receive(datagram);
    }
});

/// The datagrams in `bytes`, each behind its length: two bytes, the lower first.
fn frames(mut bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    std::iter::from_fn(move || {
        let (length, rest) = bytes.split_first_chunk()?;
        let (frame, rest) = rest.split_at_checked(u16::from_le_bytes(*length).into())?;
        bytes = rest;
        Some(frame)
    })
}
