//! Addresses and their reachability from other machines.

use std::{
    fmt, io,
    net::{Ipv4Addr, Ipv6Addr, SocketAddr, ToSocketAddrs},
    str::FromStr,
};

use super::error::SecurityError;

/// An address `tcp://HOST:PORT`, or `HOST:PORT`. The host is an IPv4 address, an IPv6 address in
/// brackets, a name, or `*` for all interfaces; the port is 1 to 65535 or, for a listening socket,
/// `*` for any free port.
///
/// Loopback addresses are 127.0.0.0/8, `[::1]` and `localhost`, which is always 127.0.0.1. Every
/// other name, including interface names, counts as reachable from other machines.
///
/// ```
/// use iiwa_link::security::Endpoint;
///
/// let endpoint: Endpoint = "localhost:5560".parse()?;
/// assert_eq!(endpoint.to_string(), "tcp://127.0.0.1:5560");
/// assert!(endpoint.is_loopback() && endpoint.check_bind(false).is_ok());
/// let endpoint: Endpoint = "*:5560".parse()?;
/// assert!(endpoint.check_bind(false).is_err() && endpoint.check_bind(true).is_ok());
/// # Ok::<(), iiwa_link::security::SecurityError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Endpoint {
    host: EndpointHost,
    port: Option<u16>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum EndpointHost {
    V4(Ipv4Addr),
    V6(Ipv6Addr),
    Any,
    Name(String),
}

impl Endpoint {
    /// Returns true if the address is reachable from this machine only.
    #[must_use]
    pub fn is_loopback(&self) -> bool {
        match &self.host {
            EndpointHost::V4(address) => address.is_loopback(),
            EndpointHost::V6(address) => address.is_loopback(),
            EndpointHost::Any | EndpointHost::Name(_) => false,
        }
    }

    /// Returns the IP address and port; names are resolved. The port `*` becomes 0.
    ///
    /// # Errors
    /// The name cannot be resolved.
    pub fn resolve(&self) -> io::Result<SocketAddr> {
        let port = self.port.unwrap_or(0);
        match &self.host {
            EndpointHost::V4(address) => Ok((*address, port).into()),
            EndpointHost::V6(address) => Ok((*address, port).into()),
            EndpointHost::Any => Ok((Ipv4Addr::UNSPECIFIED, port).into()),
            EndpointHost::Name(name) => {
                let unknown =
                    || io::Error::new(io::ErrorKind::NotFound, "the name cannot be resolved");
                (name.as_str(), port).to_socket_addrs()?.next().ok_or_else(unknown)
            }
        }
    }

    /// Fails if binding requires keys and they are missing: all addresses except loopback require
    /// keys.
    ///
    /// # Errors
    /// [`SecurityError::BindNeedsKeys`].
    pub fn check_bind(&self, has_keys: bool) -> Result<(), SecurityError> {
        if has_keys || self.is_loopback() {
            return Ok(());
        }
        Err(SecurityError::BindNeedsKeys { endpoint: self.to_string() })
    }

    /// Fails if connecting is impossible (`*`), or requires keys and they are missing.
    ///
    /// # Errors
    /// [`SecurityError::Address`] or [`SecurityError::ConnectNeedsKeys`].
    pub fn check_connect(&self, has_keys: bool) -> Result<(), SecurityError> {
        if self.host == EndpointHost::Any || self.port.is_none() {
            let message = "to connect, a host and a port are required";
            return Err(SecurityError::Address { text: self.to_string(), message });
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
            EndpointHost::V4(address) => write!(f, "tcp://{address}:")?,
            EndpointHost::V6(address) => write!(f, "tcp://[{address}]:")?,
            EndpointHost::Any => f.write_str("tcp://*:")?,
            EndpointHost::Name(name) => write!(f, "tcp://{name}:")?,
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
        let to_error = |message| SecurityError::Address { text: text.to_owned(), message };
        let address = match text.split_once("://") {
            Some(("tcp", address)) => address,
            Some(_) => return Err(to_error("only tcp://HOST:PORT is supported")),
            None => text,
        };
        // The last colon: IPv6 addresses contain colons.
        let Some((host, port)) = address.rsplit_once(':') else {
            return Err(to_error("HOST:PORT is required"));
        };
        let port = match port {
            "*" => None,
            // `parse` accepts a leading `+`.
            port if !port.starts_with('+') => match port.parse() {
                Ok(0) | Err(_) => return Err(to_error("a port is from 1 to 65535, or *")),
                Ok(port) => Some(port),
            },
            _ => return Err(to_error("a port is from 1 to 65535, or *")),
        };
        let bracketed = host.strip_prefix('[').and_then(|host| host.strip_suffix(']'));
        let host = if let Some(inside) = bracketed {
            EndpointHost::V6(
                inside
                    .parse()
                    .map_err(|_| to_error("the brackets do not contain an IPv6 address"))?,
            )
        } else if host == "*" {
            EndpointHost::Any
        } else if host.eq_ignore_ascii_case("localhost") {
            EndpointHost::V4(Ipv4Addr::LOCALHOST)
        } else if let Ok(v4) = host.parse() {
            EndpointHost::V4(v4)
        } else if host.contains(':') {
            return Err(to_error("write an IPv6 address in brackets, such as tcp://[::1]:5560"));
        } else {
            let named = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
            if host.is_empty() || !host.chars().all(named) {
                return Err(to_error("HOST is an IP address, a name or *"));
            }
            EndpointHost::Name(host.to_owned())
        };
        Ok(Self { host, port })
    }
}
