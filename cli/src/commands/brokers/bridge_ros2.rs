//! ROS 2 of `iiwasim bridge`.

use std::sync::Arc;

use iiwa_bridge::{BridgedRobot, Sink};
use iiwa_report::with_causes;
use iiwa_ros2::{RetimeGoals, Ros2, Ros2Error, Ros2Options, Ros2Robot, namespace_of};

use crate::{args, connection, failure::Failure, input::find_robot};

/// Starts the nodes of these robots; `model` is the model of all.
pub(crate) fn start(
    options: &args::Ros2,
    model: &str,
    robots: &[BridgedRobot],
    allow_commands: bool,
) -> Result<Arc<dyn Sink>, Failure> {
    let model = find_robot(model)?;
    let mut bridge_options =
        Ros2Options { domain: options.domain, allow_commands, ..Ros2Options::default() };
    if !options.networks.is_empty() {
        bridge_options.networks.clone_from(&options.networks);
    }
    bridge_options.retime = match options.retime {
        args::RetimeGoals::Needed => RetimeGoals::Needed,
        args::RetimeGoals::Always => RetimeGoals::Always,
        args::RetimeGoals::Never => RetimeGoals::Never,
    };
    for bridged in robots {
        let (mut namespace, mut names) = (options.namespace.clone(), options.naming.names());
        if robots.len() > 1 {
            let name = namespace_of(bridged.name());
            namespace = format!("{namespace}/{name}");
            let prefix = name.parse().map_err(|error| {
                Failure::input(format!("the name of robot `{}`: {error}", bridged.name()))
            })?;
            names = options.naming.names_with(prefix);
        }
        let (bridged, robot) = (bridged.clone(), model.clone());
        bridge_options.robots.push(Ros2Robot { bridged, robot, names, namespace });
    }
    Ok(Arc::new(Ros2::start(&bridge_options).map_err(|error| failure(&error))?))
}

fn failure(error: &Ros2Error) -> Failure {
    match error {
        Ros2Error::Link(error) => connection::link_failure(error),
        Ros2Error::Namespace { .. }
        | Ros2Error::SameNamespace { .. }
        | Ros2Error::SameFrames { .. }
        | Ros2Error::Domain { .. } => Failure::input(with_causes(error)),
        error => Failure::Run { message: with_causes(error), cause: None },
    }
}
