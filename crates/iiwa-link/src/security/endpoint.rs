//! Addresses, and which of them other machines reach.

use std::{
    fmt, io,
    net::{Ipv4Addr, Ipv6Addr, SocketAddr, ToSocketAddrs},
    str::FromStr,
};

use super::SecurityError;

/// An address `tcp://HOST:PORT`, or `HOST:PORT`. The host is an IPv4 address, an IPv6 address in
/// brackets, a name, or `*`, which is every interface; the port is 1 to 65535 or, for a socket that
/// binds, `*`, which is any free one.
///
/// Loopback are 127.0.0.0/8, `[::1]` and `localhost`, which is taken for 127.0.0.1 whatever the
/// system's tables say. Every other name, interfaces too, may be reached from other machines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Endpoint {
    host: Host,
    port: Option<u16>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Host {
    V4(Ipv4Addr),
    V6(Ipv6Addr),
    Any,
    Name(String),
}

impl Endpoint {
    /// Whether only this machine reaches it.
    #[must_use]
    pub fn is_loopback(&self) -> bool {
        match &self.host {
            Host::V4(address) => address.is_loopback(),
            Host::V6(address) => address.is_loopback(),
            Host::Any | Host::Name(_) => false,
        }
    }

    /// The address for the system; a name is looked up. A port that may be any is 0.
    ///
    /// # Errors
    /// The name is not known.
    pub fn resolve(&self) -> io::Result<SocketAddr> {
        let port = self.port.unwrap_or(0);
        match &self.host {
            Host::V4(address) => Ok((*address, port).into()),
            Host::V6(address) => Ok((*address, port).into()),
            Host::Any => Ok((Ipv4Addr::UNSPECIFIED, port).into()),
            Host::Name(name) => {
                let unknown = || io::Error::new(io::ErrorKind::NotFound, "the name is not known");
                (name.as_str(), port).to_socket_addrs()?.next().ok_or_else(unknown)
            }
        }
    }

    /// Fails if a socket must not bind there: without keys it may on loopback only.
    ///
    /// # Errors
    /// [`SecurityError::BindNeedsKeys`].
    pub fn check_bind(&self, has_keys: bool) -> Result<(), SecurityError> {
        if has_keys || self.is_loopback() {
            return Ok(());
        }
        Err(SecurityError::BindNeedsKeys { endpoint: self.to_string() })
    }

    /// Fails if a socket must not or cannot connect there: without keys it may on loopback only, and
    /// never to `*`.
    ///
    /// # Errors
    /// [`SecurityError::Address`] of one that is for binding only, [`SecurityError::ConnectNeedsKeys`].
    pub fn check_connect(&self, has_keys: bool) -> Result<(), SecurityError> {
        if self.host == Host::Any || self.port.is_none() {
            let what = "to connect, one host and one port are needed";
            return Err(SecurityError::Address { text: self.to_string(), what });
        }
        if has_keys || self.is_loopback() {
            return Ok(());
        }
        Err(SecurityError::ConnectNeedsKeys { endpoint: self.to_string() })
    }
}

impl fmt::Display for Endpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.host {
            Host::V4(address) => write!(f, "tcp://{address}:")?,
            Host::V6(address) => write!(f, "tcp://[{address}]:")?,
            Host::Any => f.write_str("tcp://*:")?,
            Host::Name(name) => write!(f, "tcp://{name}:")?,
        }
        match self.port {
            Some(port) => write!(f, "{port}"),
            None => f.write_str("*"),
        }
    }
}

impl FromStr for Endpoint {
    type Err = SecurityError;

    fn from_str(text: &str) -> Result<Self, SecurityError> {
        let refuse = |what| SecurityError::Address { text: text.to_owned(), what };
        let address = match text.split_once("://") {
            Some(("tcp", address)) => address,
            Some(_) => return Err(refuse("only tcp://HOST:PORT is used")),
            None => text,
        };
        let Some((host, port)) = address.rsplit_once(':') else {
            return Err(refuse("HOST:PORT is needed"));
        };
        let port = match port {
            "*" => None,
            port if !port.starts_with('+') => match port.parse() {
                Ok(0) | Err(_) => return Err(refuse("a port is from 1 to 65535, or *")),
                Ok(port) => Some(port),
            },
            _ => return Err(refuse("a port is from 1 to 65535, or *")),
        };
        let bracketed = host.strip_prefix('[').and_then(|host| host.strip_suffix(']'));
        let host = if let Some(inside) = bracketed {
            Host::V6(inside.parse().map_err(|_| refuse("no IPv6 address between the brackets"))?)
        } else if host == "*" {
            Host::Any
        } else if host.eq_ignore_ascii_case("localhost") {
            Host::V4(Ipv4Addr::LOCALHOST)
        } else if let Ok(v4) = host.parse() {
            Host::V4(v4)
        } else if host.contains(':') {
            return Err(refuse("an IPv6 address goes in brackets, as tcp://[::1]:5560"));
        } else {
            let named = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
            if host.is_empty() || !host.chars().all(named) {
                return Err(refuse("HOST is an IP address, a name or *"));
            }
            Host::Name(host.to_owned())
        };
        Ok(Self { host, port })
    }
}
