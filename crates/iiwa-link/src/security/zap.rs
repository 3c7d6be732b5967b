//! ZAP 1.0 (RFC 27 of `ZeroMQ`): libzmq asks about each client that has shown its key.

use super::{AllowList, PublicKey};

/// Where libzmq asks.
pub(super) const ADDRESS: &str = "inproc://zeromq.zap.01";

/// The domain of guarded sockets.
pub(super) const DOMAIN: &str = "iiwasim";

/// A reply, and what is to be told about it.
pub(super) struct Answer {
    /// Its frames.
    pub(super) frames: [Vec<u8>; 6],
    /// What became of the client.
    pub(super) verdict: Verdict,
}

/// What became of a client.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// It is let in.
    Admitted { name: String, address: String },
    /// It is not.
    Refused { key: Option<PublicKey>, address: String },
    /// This was no request.
    Malformed,
}

/// The reply to a request: version, request's id, domain, address, identity, mechanism, and for
/// CURVE the client's public key.
pub(super) fn answer(request: &[Vec<u8>], allowed: &AllowList) -> Answer {
    let id = request.get(1).filter(|id| id.len() <= 255).cloned().unwrap_or_default();
    let reply = |status: &str, text: &str, user: &str, verdict| {
        let [version, status, text, user, metadata] =
            ["1.0", status, text, user, ""].map(|frame| frame.as_bytes().to_vec());
        Answer { frames: [version, id, status, text, user, metadata], verdict }
    };
    let [version, _, domain, address, _, mechanism, credentials @ ..] = request else {
        return reply("500", "malformed request", "", Verdict::Malformed);
    };
    let curve = mechanism == b"CURVE";
    let key = match credentials {
        [key] if curve => <[u8; 32]>::try_from(key.as_slice()).ok().map(PublicKey::from),
        _ => None,
    };
    if version != b"1.0" || (curve && key.is_none()) {
        return reply("500", "malformed request", "", Verdict::Malformed);
    }
    let address = String::from_utf8_lossy(address).escape_debug().to_string();
    let name = key.and_then(|key| allowed.name(&key)).filter(|_| domain == DOMAIN.as_bytes());
    match name {
        Some(name) => {
            let name = name.to_owned();
            reply("200", "OK", &name.clone(), Verdict::Admitted { name, address })
        }
        None => reply("400", "not allowed", "", Verdict::Refused { key, address }),
    }
}
