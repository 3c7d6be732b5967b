//! Keys as text against the Z85 of `libzmq`.

use iiwa_link::security::PublicKey;
use proptest::prelude::*;

/// A test vector of the CURVE documentation (`zmq_curve`).
const PUBLIC: &str = "rq:rM>}U?@Lns47E1%kR.o@n%FcmmsL/@{H8]yf7";

#[test]
fn text_is_that_of_libzmq() {
    let key: PublicKey = PUBLIC.parse().unwrap();
    assert_eq!(key.bytes().to_vec(), zmq::z85_decode(PUBLIC).unwrap());
}

proptest! {
    #[test]
    fn any_text_is_that_of_libzmq(bytes: [u8; 32]) {
        let text = PublicKey::from(bytes).to_string();
        prop_assert_eq!(text, zmq::z85_encode(&bytes).unwrap());
    }
}
