//! Connections to a drive, and failures on them.

use iiwa_link::{
    Client, ClientError, LinkError, Remote, Server,
    message::Code,
    security::{ClientSecurity, SecurityError, ServerSecurity},
};
use iiwa_view::with_causes;

use crate::{
    args::{ClientKeys, DriveAddress, ServerKeys},
    failure::Failure,
};

/// A client of the drive that the options name.
pub(crate) fn client(drive: &DriveAddress) -> Result<Client, Failure> {
    Client::new(&remote(&drive.keys)?, &drive.drive.to_string()).map_err(|error| refused(&error))
}

/// What it takes to connect to a drive.
pub(crate) fn remote(keys: &ClientKeys) -> Result<Remote, Failure> {
    match (&keys.key, &keys.server_key) {
        (Some(key), Some(server)) => ClientSecurity::read(key, server)
            .map(Remote::with_keys)
            .map_err(|error| refused(&error.into())),
        _ => Ok(Remote::open()),
    }
}

/// What it takes to be connected to.
pub(crate) fn server(keys: &ServerKeys) -> Result<Server, Failure> {
    let server = match (&keys.key, &keys.allow) {
        (Some(key), Some(allow)) => ServerSecurity::read(key, allow).map(Server::with_keys),
        _ => Ok(Server::open()),
    };
    server.map_err(|error| refused(&error.into()))
}

/// A connection that cannot be set up. Whether it is the options' fault decides on the exit code.
pub(crate) fn refused(error: &LinkError) -> Failure {
    match error {
        LinkError::Config { .. } => Failure::input(error.to_string()),
        LinkError::Security(cause @ SecurityError::Random { .. }) => {
            Failure::run("cannot connect", cause)
        }
        LinkError::Security(cause) => Failure::input(with_causes(cause)),
        error => Failure::run("cannot connect", error),
    }
}

/// A request that was not carried out.
pub(crate) fn failed(what: &str, error: &ClientError) -> Failure {
    match error {
        ClientError::Refused { refusal, .. }
            if matches!(refusal.code, Code::BadRequest | Code::Limit) =>
        {
            Failure::input(format!("{what}: {refusal}"))
        }
        ClientError::Link(error) => refused(error),
        error => Failure::run(what, error),
    }
}
