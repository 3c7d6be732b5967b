//! Broker security: TLS, user name and password.

use std::fmt;
#[cfg(any(feature = "tls", test))]
use std::net::IpAddr;

#[cfg(feature = "tls")]
use crate::tls::TlsFiles;

/// Access settings of a broker.
#[cfg(feature = "tls")]
#[derive(Clone, Debug, Default)]
pub struct BrokerAccess {
    /// TLS, if used by the broker.
    pub tls: Option<TlsFiles>,
    /// The user, if required by the broker.
    pub credentials: Option<Credentials>,
}

/// A broker user.
#[derive(Clone)]
pub struct Credentials {
    /// User name.
    pub user: String,
    /// Password.
    pub password: String,
}

/// Omits the password.
impl fmt::Debug for Credentials {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Credentials").field("user", &self.user).finish_non_exhaustive()
    }
}

#[cfg(any(feature = "tls", test))]
/// Returns true if an address, `HOST:PORT`, certainly refers to this machine, so that transmitted
/// data does not leave it.
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
        for host in ["localhost:9092", "127.0.0.1:1", "127.9.9.9", "[::1]:9092"] {
            assert!(is_this_machine(host), "{host}");
        }
        for elsewhere in ["192.0.2.1:9092", "broker:9092", "localhost.example.org:1", ""] {
            assert!(!is_this_machine(elsewhere), "{elsewhere}");
        }
    }
}
