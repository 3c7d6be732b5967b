//! Connections to a drive, and their failures.

use std::{error::Error, io};

use iiwa_json::printable;
use iiwa_link::{
    Client, ClientError, LinkError, Remote, Server,
    message::Code,
    security::{ClientSecurity, ConnectionRefusal, SecurityError, ServerSecurity},
};
use iiwa_report::with_causes;

use crate::{
    args::{ClientKeys, DriveAddress, ServerKeys},
    failure::Failure,
};

/// Connects a client to a drive.
pub(crate) fn client(drive: &DriveAddress) -> Result<Client, Failure> {
    Client::new(&remote(&drive.keys)?, &drive.drive.to_string())
        .map_err(|error| link_failure(&error))
}

/// Returns the keys for a connection to a drive.
pub(crate) fn remote(keys: &ClientKeys) -> Result<Remote, Failure> {
    match (&keys.key, &keys.server_key) {
        (Some(key), Some(server)) => ClientSecurity::read(key, server)
            .map(Remote::with_keys)
            .map_err(|error| link_failure(&error.into())),
        _ => Ok(Remote::open()),
    }
}

/// Returns the keys of a server, and its accepted clients.
pub(crate) fn server(keys: &ServerKeys) -> Result<Server, Failure> {
    let server = match (&keys.key, &keys.allow) {
        (Some(key), Some(allow)) => ServerSecurity::read(key, allow).map(Server::with_keys),
        _ => Ok(Server::open()),
    };
    server.map_err(|error| link_failure(&error.into()))
}

/// Converts the error of a failed connection: invalid input if the options are wrong.
pub(crate) fn link_failure(error: &LinkError) -> Failure {
    match error {
        LinkError::Config { .. }
        | LinkError::ControllerAddress { .. }
        | LinkError::FriNeedsKeys { .. } => Failure::input(format!("{error}{}", hint(error))),
        LinkError::Security(cause @ SecurityError::Random { .. }) => {
            Failure::run("cannot connect", cause)
        }
        LinkError::Security(cause) => {
            Failure::input(format!("{}{}", with_causes(cause), hint(error)))
        }
        error => {
            let explained = format!("{}{}", with_causes(error), hint(error));
            Failure::run("cannot connect", &io::Error::other(explained))
        }
    }
}

/// Converts the error of a server that did not start; `options` select its addresses.
pub(crate) fn not_started(error: &LinkError, options: &str) -> Failure {
    match error {
        LinkError::Bind { source, .. } | LinkError::Udp { source, .. } => {
            not_listening(error, source, options)
        }
        error => link_failure(error),
    }
}

/// Converts the error of an address that cannot be served; `options` select another address.
pub(crate) fn not_listening(error: &dyn Error, cause: &io::Error, options: &str) -> Failure {
    let hint = if cause.kind() == io::ErrorKind::AddrInUse {
        format!("; another program listens there: end it, or choose another port with {options}")
    } else {
        String::new()
    };
    Failure::Run { message: printable(&format!("{}{hint}", with_causes(error))), cause: None }
}

/// Converts the error of a failed request.
pub(crate) fn failed(message: &str, error: &ClientError) -> Failure {
    match error {
        ClientError::Refused { refusal, .. }
            if matches!(refusal.code, Code::BadRequest | Code::Limit) =>
        {
            Failure::input(format!("{message}: {refusal}"))
        }
        ClientError::Link(error) => link_failure(error),
        ClientError::Unreachable { .. } | ClientError::Unauthorized { .. } => {
            Failure::run(message, &io::Error::other(explained(error)))
        }
        error => Failure::run(message, error),
    }
}

/// Formats the error of a request, with a hint.
pub(crate) fn explained(error: &ClientError) -> String {
    match error {
        ClientError::Unreachable { .. } => format!("{error}; is `iiwasim drive` running there?"),
        ClientError::Unauthorized { reason, .. } => format!("{error}{}", one_side(reason)),
        error => error.to_string(),
    }
}

/// Returns the options that give keys to both sides, if only one side has keys.
fn one_side(reason: &str) -> &'static str {
    if reason == ConnectionRefusal::KeysOnOneSide.reason() {
        "; a client has --key and --server-key, a drive --key and --allow"
    } else {
        ""
    }
}

/// Returns commands and options that solve an error, to be appended to it.
fn hint(error: &LinkError) -> &'static str {
    match error {
        LinkError::Security(SecurityError::BindNeedsKeys { .. }) => {
            ". Make keys with `iiwasim keygen drive`, then give --key drive.key and --allow with \
             the clients' .pub files"
        }
        LinkError::Security(SecurityError::ConnectNeedsKeys { .. }) => {
            ". Make keys with `iiwasim keygen NAME`, then give --key NAME.key and --server-key (a \
             drive: --cabinet-key) with the other side's .pub file"
        }
        LinkError::Security(SecurityError::NoClientKeys { .. }) => {
            ". Put the clients' .pub files there, which `iiwasim keygen` makes"
        }
        LinkError::Unauthorized { reason, .. } => one_side(reason),
        LinkError::ControllerAddress { .. } => {
            "; give the controller's address with --cabinet or --fri-cabinet"
        }
        LinkError::FriNeedsKeys { .. } => "; give them with --key and --allow",
        _ => "",
    }
}
