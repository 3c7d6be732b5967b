//! Number of connection slots within the limit of open files: connections must not exhaust the
//! descriptors that the process needs.

use crate::error::LinkError;

/// Maximum number of slots for handshakes, and for established connections.
const MAX_PLACES: u64 = 64;

/// Minimum number of slots, below which a socket does not start: new connections would be evicted
/// too soon.
const MIN_PLACES: u64 = 16;

/// Listening sockets in a process: two per drive and two per cabinet.
const LISTENERS: u64 = 4;

/// Descriptors for everything else: standard streams, event loops, sockets, files, and connections
/// that are being closed.
const RESERVED: u64 = 64;

/// Maximum number of connections of a socket that are being closed.
pub(super) const CLOSING: usize = 8;

/// Returns the number of slots for handshakes, and for established connections, within the
/// process's limit of open files.
///
/// # Errors
///
/// [`LinkError::OpenFiles`] if the limit is too low.
pub(super) fn places() -> Result<usize, LinkError> {
    places_within(limit())
}

/// Returns the number of slots within `limit`; `None` means unlimited.
fn places_within(limit: Option<u64>) -> Result<usize, LinkError> {
    let limit = limit.unwrap_or(u64::MAX);
    // Twice, because each socket has slots for handshakes and for established connections.
    let places = (limit.saturating_sub(RESERVED) / (2 * LISTENERS)).min(MAX_PLACES);
    if places < MIN_PLACES {
        let needed = RESERVED + 2 * LISTENERS * MIN_PLACES;
        return Err(LinkError::OpenFiles { limit, needed });
    }
    Ok(usize::try_from(places).unwrap_or(usize::MAX))
}

#[cfg(unix)]
fn limit() -> Option<u64> {
    rustix::process::getrlimit(rustix::process::Resource::Nofile).current
}

#[cfg(not(unix))]
fn limit() -> Option<u64> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_places_of_all_sockets_are_within_the_limit() {
        assert_eq!(places_within(None).unwrap(), 64);
        assert_eq!(places_within(Some(1024)).unwrap(), 64);
        for limit in 192..1024 {
            let places = places_within(Some(limit)).unwrap() as u64;
            assert!(places >= 16 && 2 * places * LISTENERS + RESERVED <= limit, "{limit}");
        }
        assert!(CLOSING as u64 * LISTENERS < RESERVED);
    }

    #[test]
    fn too_few_open_files_are_an_error_that_names_the_number() {
        let error = places_within(Some(191)).unwrap_err().to_string();
        assert!(error.contains("191") && error.contains("192"), "{error}");
    }
}
