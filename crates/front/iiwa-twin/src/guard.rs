//! Access control: only requests of this machine, with the token, and not from a foreign page.
//!
//! Any program on this machine can connect to its ports, and any page in a browser can make the
//! browser do so. The token excludes both. The check of `Host` excludes pages whose domain name was
//! redirected to this machine after loading (DNS rebinding); that of `Origin` excludes pages that
//! have obtained the token. A request that repeats one of the three is rejected: a proxy or a
//! browser may have checked a value other than the first.

use std::{net::SocketAddr, sync::Arc};

use axum::{
    Extension,
    extract::{Request, State},
    http::{
        HeaderMap, HeaderValue, Method, StatusCode, Uri,
        header::{
            CACHE_CONTROL, CONNECTION, HOST, ORIGIN, REFERRER_POLICY, UPGRADE,
            X_CONTENT_TYPE_OPTIONS,
        },
        uri::Authority,
    },
    middleware::Next,
    response::{IntoResponse, Response},
};

use crate::{
    TwinError,
    connections::{Full, PageConnection},
};

/// Path of the WebSocket.
pub(crate) const LIVE: &str = "/live";

/// Secret that the address of the page must contain.
#[derive(Clone, Debug)]
pub(crate) struct PageToken(Arc<str>);

impl PageToken {
    /// Creates a token of 128 random bits from the system.
    pub(crate) fn new() -> Result<Self, TwinError> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes).map_err(TwinError::Random)?;
        Ok(Self(format!("{:032x}", u128::from_be_bytes(bytes)).into()))
    }

    pub(crate) fn text(&self) -> &str {
        &self.0
    }

    /// Returns true if the text is the token, in a time that does not depend on the number of
    /// matching characters.
    fn equals(&self, text: &str) -> bool {
        let differ = |sum: u8, (a, b): (u8, u8)| sum | (a ^ b);
        self.0.len() == text.len() && self.0.bytes().zip(text.bytes()).fold(0, differ) == 0
    }
}

/// Passes on a request, or rejects it.
pub(crate) async fn guard(
    State(Admission { token, address }): State<Admission>,
    Extension(connection): Extension<PageConnection>,
    request: Request,
    next: Next,
) -> Response {
    let checked =
        check(&token, connection.peer(), (request.method(), request.uri()), request.headers());
    let mut response = match checked {
        Ok(()) => match connection.verify(request.uri().path() == LIVE) {
            Ok(()) => next.run(request).await,
            Err(Full { max }) => {
                let why = format!(
                    "there are {max} connections, which is the most: close other pages of the \
                     twin\n"
                );
                (StatusCode::SERVICE_UNAVAILABLE, why).into_response()
            }
        },
        Err(why) => {
            let hint = match why {
                Forbidden::Token => format!(": use the whole address {address}"),
                _ => String::new(),
            };
            (StatusCode::FORBIDDEN, format!("{why}{hint}\n")).into_response()
        }
    };
    // The content is confidential, and the address contains the token.
    let headers = response.headers_mut();
    headers.insert(CACHE_CONTROL, HeaderValue::from_static("no-store"));
    headers.insert(REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    headers.insert(X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    if !headers.contains_key(UPGRADE) {
        // A new connection on one machine is cheap, and an idle connection would count.
        headers.insert(CONNECTION, HeaderValue::from_static("close"));
    }
    response
}

/// Conditions for admitting a request.
#[derive(Clone, Debug)]
pub(crate) struct Admission {
    pub(crate) token: PageToken,
    /// Hint where the user finds the complete address with the token.
    pub(crate) address: &'static str,
}

/// Reason for rejecting a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
enum Forbidden {
    #[error("requests from other machines are not allowed")]
    Machine,
    #[error("the request has more than one {0}")]
    Repeated(&'static str),
    #[error("the host has to be 127.0.0.1 or localhost")]
    Host,
    #[error("the token is missing or wrong")]
    Token,
    #[error("requests of a page of another origin are not allowed")]
    Origin,
    #[error("only the page itself may send this request")]
    NotAPage,
}

fn check(
    token: &PageToken,
    peer: SocketAddr,
    (method, uri): (&Method, &Uri),
    headers: &HeaderMap,
) -> Result<(), Forbidden> {
    if !peer.ip().is_loopback() {
        return Err(Forbidden::Machine);
    }
    let host = only("Host", headers.get_all(HOST).iter())?;
    let host: Option<Authority> = host.and_then(|host| host.to_str().ok()?.parse().ok());
    let Some(host) = host.filter(|host| is_this_machine(host.host())) else {
        return Err(Forbidden::Host);
    };
    if uri.authority().is_some_and(|named| *named != host) {
        return Err(Forbidden::Repeated("Host"));
    }
    let parameters = uri.query().unwrap_or_default().split('&');
    let tokens = parameters.filter_map(|part| {
        let (name, value) = part.split_once('=').unwrap_or((part, ""));
        (name == "token").then_some(value)
    });
    if !only("token", tokens)?.is_some_and(|text| token.equals(text)) {
        return Err(Forbidden::Token);
    }
    let is_own = |origin: &HeaderValue| {
        let origin = origin.to_str().ok().and_then(|origin| origin.parse::<Uri>().ok());
        origin.is_some_and(|origin| origin.authority() == Some(&host))
    };
    match only("Origin", headers.get_all(ORIGIN).iter())? {
        Some(origin) if !is_own(origin) => Err(Forbidden::Origin),
        None if uri.path() == LIVE || method != Method::GET => Err(Forbidden::NotAPage),
        _ => Ok(()),
    }
}

/// Returns the value, if any; rejects repeated values.
fn only<T>(
    name: &'static str,
    mut values: impl Iterator<Item = T>,
) -> Result<Option<T>, Forbidden> {
    let first = values.next();
    if values.next().is_some() { Err(Forbidden::Repeated(name)) } else { Ok(first) }
}

fn is_this_machine(name: &str) -> bool {
    matches!(name, "127.0.0.1" | "localhost" | "[::1]")
}

#[cfg(test)]
mod tests {
    use axum::http::HeaderName;

    use super::*;

    fn asked(
        method: &Method,
        uri: &str,
        peer: &str,
        headers: &[(HeaderName, &str)],
    ) -> Result<(), Forbidden> {
        let token = PageToken("0123".into());
        let mut all = HeaderMap::new();
        for (name, value) in headers {
            all.append(name, value.parse().unwrap());
        }
        let (peer, uri) = (peer.parse().unwrap(), uri.parse().unwrap());
        check(&token, peer, (method, &uri), &all)
    }

    fn checked(uri: &str, peer: &str, headers: &[(HeaderName, &str)]) -> Result<(), Forbidden> {
        asked(&Method::GET, uri, peer, headers)
    }

    #[test]
    fn only_the_page_itself_gets_in() {
        const ME: &str = "127.0.0.1:40000";
        let host = (HOST, "127.0.0.1:5562");
        let own_origin = (ORIGIN, "http://127.0.0.1:5562");
        assert_eq!(checked("/?token=0123", ME, std::slice::from_ref(&host)), Ok(()));
        assert_eq!(
            checked("/live?a=b&token=0123", ME, &[host.clone(), own_origin.clone()]),
            Ok(())
        );
        assert_eq!(checked("/?token=0123", "[::1]:9", &[(HOST, "localhost:1")]), Ok(()));
        let refused = |uri: &str, peer: &str, headers: &[(HeaderName, &str)]| {
            checked(uri, peer, headers).unwrap_err();
        };
        for uri in ["/", "/?token=", "/?token=0124", "/?token=01234", "/?Token=0123", "/live"] {
            refused(uri, ME, &[host.clone(), own_origin.clone()]);
        }
        refused("/?token=0123", "192.168.1.7:40000", std::slice::from_ref(&host));
        for name in ["evil.example", "127.0.0.1.evil.example", "192.168.1.7:5562", "", "a b"] {
            refused("/?token=0123", ME, &[(HOST, name)]);
        }
        refused("/?token=0123", ME, &[]);
        for origin in ["http://evil.example", "null", "http://127.0.0.1:1", "http://localhost:5562"]
        {
            refused("/live?token=0123", ME, &[host.clone(), (ORIGIN, origin)]);
            refused("/?token=0123", ME, &[host.clone(), (ORIGIN, origin)]);
        }
        // WebSockets and uploads of a page have an origin.
        refused("/live?token=0123", ME, std::slice::from_ref(&host));
        let post =
            |headers: &[(HeaderName, &str)]| asked(&Method::POST, "/p?token=0123", ME, headers);
        assert_eq!(post(&[host.clone(), own_origin]), Ok(()));
        post(&[host.clone(), (ORIGIN, "http://evil.example")]).unwrap_err();
        post(&[host]).unwrap_err();
    }

    #[test]
    fn repeated_hosts_origins_and_tokens_are_rejected() {
        const ME: &str = "127.0.0.1:40000";
        let (own_host, foreign) = ("127.0.0.1:5562", "evil.example");
        let (page, other) = ("http://127.0.0.1:5562", "http://evil.example");
        let host = |name| (HOST, name);
        let origin = |name| (ORIGIN, name);
        let repeated = |header| Err(Forbidden::Repeated(header));
        for second in [own_host, foreign] {
            for hosts in [[host(own_host), host(second)], [host(second), host(own_host)]] {
                assert_eq!(checked("/?token=0123", ME, &hosts), repeated("Host"), "{hosts:?}");
            }
        }
        // The target of a request may be an absolute URL.
        let target = "http://127.0.0.1:5562/?token=0123";
        assert_eq!(checked(target, ME, &[host(own_host)]), Ok(()));
        assert_eq!(
            checked("http://evil.example/?token=0123", ME, &[host(own_host)]),
            repeated("Host")
        );
        for second in [page, other] {
            for origins in [[origin(page), origin(second)], [origin(second), origin(page)]] {
                let headers = [&[host(own_host)], &origins[..]].concat();
                let result = checked("/live?token=0123", ME, &headers);
                assert_eq!(result, repeated("Origin"), "{headers:?}");
            }
        }
        for query in [
            "token=0123&token=0123",
            "token=0123&a=b&token=0",
            "token=&token=0123",
            "token&token=0123",
        ] {
            let result = checked(&format!("/?{query}"), ME, &[host(own_host)]);
            assert_eq!(result, repeated("token"), "{query}");
        }
        assert_eq!(Forbidden::Repeated("Host").to_string(), "the request has more than one Host");
    }

    #[test]
    fn tokens_differ() {
        let [a, b] = [PageToken::new().unwrap(), PageToken::new().unwrap()];
        assert_ne!(a.text(), b.text());
        assert_eq!(a.text().len(), 32);
        assert!(a.equals(a.text()) && !a.equals(b.text()));
    }
}
