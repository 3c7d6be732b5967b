//! How a broker is reached safely: TLS, and a name with a password.

use std::fmt;
#[cfg(any(feature = "tls", test))]
use std::net::IpAddr;

#[cfg(feature = "tls")]
use crate::tls::TlsFiles;

/// What it takes to be let in by a broker.
#[cfg(feature = "tls")]
#[derive(Clone, Debug, Default)]
pub struct BrokerAccess {
    /// TLS, if the broker has it.
    pub tls: Option<TlsFiles>,
    /// The user, if the broker asks for one.
    pub credentials: Option<Credentials>,
}

/// A user of a broker.
#[derive(Clone)]
pub struct Credentials {
    /// The name.
    pub user: String,
    /// The password.
    pub password: String,
}

/// Without the password.
impl fmt::Debug for Credentials {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Credentials").field("user", &self.user).finish_non_exhaustive()
    }
}

#[cfg(any(feature = "tls", test))]
/// Whether an address, `HOST:PORT`, is this machine for sure, so that what is sent there stays on it.
pub(crate) fn is_this_machine(address: &str) -> bool {
    let host = address.rsplit_once(':').map_or(address, |(host, _)| host);
    let host = host.trim_start_matches('[').trim_end_matches(']');
    host == "localhost" || host.parse::<IpAddr>().is_ok_and(|ip| ip.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::is_this_machine;

    #[test]
    fn only_loopback_addresses_are_this_machine() {
        for here in ["localhost:9092", "127.0.0.1:1", "127.9.9.9", "[::1]:9092"] {
            assert!(is_this_machine(here), "{here}");
        }
        for elsewhere in ["192.0.2.1:9092", "broker:9092", "localhost.example.org:1", ""] {
            assert!(!is_this_machine(elsewhere), "{elsewhere}");
        }
    }
}
