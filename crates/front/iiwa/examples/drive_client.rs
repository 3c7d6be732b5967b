//! Starts a simulated cabinet and a drive, requests a motion from the drive, and compares the
//! measured time with the planned time.

use std::error::Error;
use std::io::{Write, stdout};
use std::net::{SocketAddr, TcpListener, UdpSocket};
use std::time::{Duration, Instant};

use iiwa::cabinet::{Cabinet, CabinetConfig};
use iiwa::drive::{Drive, DriveConfig};
use iiwa::link::message::{DriveState, Presence};
use iiwa::link::{Client, Remote, Server};
use iiwa::prelude::*;

/// Returns free ports of the loopback interface; all stay bound until all are found, so that they
/// differ.
fn free<const COUNT: usize>() -> std::io::Result<[SocketAddr; COUNT]> {
    let mut held = Vec::new();
    let mut addresses = [SocketAddr::from(([127, 0, 0, 1], 0)); COUNT];
    for address in &mut addresses {
        let tcp = TcpListener::bind(*address)?;
        *address = UdpSocket::bind(tcp.local_addr()?)?.local_addr()?;
        held.push(tcp);
    }
    Ok(addresses)
}

fn main() -> Result<(), Box<dyn Error>> {
    let [fri, tcp @ ..] = free::<5>()?;
    let [requests, stream, instructions, state] = tcp.map(|address| format!("tcp://{address}"));

    // The drive starts first: it must listen before the cabinet sends.
    let mut drive_config = DriveConfig::default();
    drive_config.instructions.clone_from(&requests);
    drive_config.stream = stream;
    drive_config.fri = fri;
    drive_config.cabinet_instructions.clone_from(&instructions);
    drive_config.cabinet_state.clone_from(&state);
    let _drive = Drive::start(drive_config, &Server::open(), &Remote::open())?;
    let mut cabinet_config = CabinetConfig::default();
    cabinet_config.fri_client = fri;
    cabinet_config.instructions = instructions;
    cabinet_config.state = state;
    let _cabinet = Cabinet::start(cabinet_config, &Server::open())?;

    // FRI needs some hundred messages to rate the connection quality.
    let mut client = Client::new(&Remote::open(), &requests)?;
    let begin = Instant::now();
    let start = loop {
        let status = client.state()?;
        let good = ["good", "excellent"].contains(&status.fri.quality.as_str());
        let ready = status.robot_program == Presence::Connected && status.state == DriveState::Idle;
        match status.joints_rad {
            Some(joints_rad) if good && ready => break joints_rad,
            _ if begin.elapsed() > Duration::from_secs(20) => return Err("no connection".into()),
            _ => std::thread::sleep(Duration::from_millis(20)),
        }
    };

    // Joint 1 by 30 deg and back, at half speed.
    let mut target = start;
    target[0] += 30_f64.to_radians();
    let motions =
        vec![Motion::Ptp(Ptp::to(target).velocity(0.5)), Motion::Ptp(Ptp::to(start).velocity(0.5))];
    let program = Program {
        robot: None,
        start: Start::Joints(start),
        motions: motions.clone(),
        workcell: Workcell::default(),
        sources: Sources::default(),
    };
    let path = JointPath::new(&program, &Robot::default())?;
    let planned_s = Trajectory::plan(&path, Timing::default())?.cycle_time_s();

    let run = client.run_motions(motions, Some(Duration::from_secs(20)))?;
    let measured_s = run.cycle_time_s.ok_or("the run has no cycle time")?;
    writeln!(
        stdout(),
        "planned {planned_s:.3} s, measured {measured_s:.3} s, {} samples",
        run.samples.t_s.len(),
    )?;
    Ok(())
}
