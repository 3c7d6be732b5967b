//! `iiwasim twin`.

use std::net::{Ipv4Addr, SocketAddr, TcpListener};

use iiwa_foxglove::Viewers;
use iiwa_kin::{Robot, RosNames};
use iiwa_twin::{Setup, Twin, TwinError, TwinOptions};

use crate::{
    args,
    arm_files::ArmFiles,
    connection,
    failure::{Failure, print_note},
    input, output,
    twin_failure::WORDING,
};

/// Starts a server for Foxglove and Lichtblick.
fn viewers_at(robot: &Robot, names: &RosNames, address: SocketAddr) -> Result<Viewers, Failure> {
    Viewers::listen(robot, names, address).map_err(|error| match error.cause.downcast_ref() {
        Some(cause) => connection::not_listening(&error, cause, "--foxglove=IP:PORT"),
        None => TwinError::from(error).into(),
    })
}

/// Reads the files that the options name.
fn twin_options(options: &args::Twin) -> Result<TwinOptions, Failure> {
    let robot = input::find_robot(&options.robot)?;
    let scene = options.scene.as_deref().map(input::scene).transpose()?;
    let files = ArmFiles::new(&options.arm)?;
    let meshes = files.map(|files| files.meshes(&robot)).transpose()?;
    Ok(TwinOptions {
        robot,
        robot_name: options.robot.clone(),
        names: options.ros.names(),
        scene,
        meshes,
        min_clearance_mm: options.min_clearance,
        io: options.io.clone(),
        remote: connection::remote(&options.drive.keys)?,
        drive: options.drive.drive.to_string(),
        stream: options.stream.to_string(),
        positions: options.positions.clone(),
        folder: options.output.clone(),
        wording: WORDING,
    })
}

/// Follows the robot and serves its page until an interrupt.
pub(crate) fn run(options: &args::Twin) -> Result<(), Failure> {
    let with = twin_options(options)?;
    let (robot, names) = (with.robot.clone(), with.names.clone());
    let setup = Setup::new(with)?;
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, options.port)).map_err(|error| {
        let message =
            format!("cannot listen at port {}; --port 0 selects a free port", options.port);
        Failure::run(message, &error)
    })?;
    let address =
        listener.local_addr().map_err(|error| Failure::run("cannot serve the page", &error))?;
    let viewers =
        options.foxglove.map(|address| viewers_at(&robot, &names, address)).transpose()?;
    output::catch_interrupts();
    let twin = Twin::new(setup)?;
    output::print(&format!("http://{address}/?token={}\n", twin.token()))?;
    print_note("The twin is at this address, for this machine only. Ctrl-C ends it.\n");
    if let Some(viewers) = &viewers {
        print_note(&format!("Foxglove and Lichtblick open ws://{}\n", viewers.address()));
    }
    Ok(twin.run(listener, viewers)?)
}
