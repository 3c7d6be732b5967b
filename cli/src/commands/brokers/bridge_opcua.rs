//! OPC UA of `iiwasim bridge`.

use std::sync::Arc;

use iiwa_bridge::{BridgedRobot, Sink, default_spool};
use iiwa_opcua::{BridgedArm, OpcUa, OpcUaError, OpcUaOptions};
use iiwa_report::with_causes;

use crate::{args, broker_access::credentials, connection, failure::Failure, input::find_robot};

/// Starts the server of these robots, if requested; `model` is the model of all.
pub(crate) fn start(
    options: &args::OpcUa,
    model: &str,
    robots: &[BridgedRobot],
    allow_commands: bool,
) -> Result<Option<Arc<dyn Sink>>, Failure> {
    let Some(listen) = options.listen else { return Ok(None) };
    let model = find_robot(model)?;
    let arm = |robot: &BridgedRobot| {
        (robot.name().to_owned(), BridgedArm { model: model.clone(), load: None })
    };
    let beside_the_spool = || default_spool().with_file_name("opcua");
    let user = options.user.as_ref().zip(options.password_file.as_ref());
    let user = user.map(|(user, file)| credentials(user, file)).transpose()?;
    let bridge_options = OpcUaOptions {
        listen,
        host: options.host.clone(),
        certificates: options.certificates.clone().unwrap_or_else(beside_the_spool),
        trusted: options.trusted.clone(),
        users: user.into_iter().collect(),
        anonymous: options.anonymous,
        unsecured: options.unsecured,
        arms: robots.iter().map(arm).collect(),
    };
    let server =
        OpcUa::start(&bridge_options, robots, allow_commands).map_err(|error| failure(&error))?;
    Ok(Some(Arc::new(server)))
}

fn failure(error: &OpcUaError) -> Failure {
    match error {
        OpcUaError::Listen { source, .. } => connection::not_listening(error, source, "--opcua"),
        OpcUaError::Certificate { .. }
        | OpcUaError::Settings { .. }
        | OpcUaError::SameName { .. } => Failure::input(with_causes(error)),
        error => Failure::Run { message: with_causes(error), cause: None },
    }
}
