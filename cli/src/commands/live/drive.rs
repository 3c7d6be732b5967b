//! `iiwasim drive`.

use std::net::{IpAddr, ToSocketAddrs};

use iiwa_drive::{AnswerLatency, Drive, DriveConfig, LinkCheck};
use iiwa_json::printable;
use iiwa_link::{Remote, security::ClientSecurity};

use crate::{
    args, connection,
    failure::{Failure, print_note},
    input::find_robot,
    output, service_log,
};

/// Runs a drive until an interrupt.
pub(crate) fn run(options: &args::Drive) -> Result<(), Failure> {
    let robot = find_robot(&options.robot)?;
    let clients = connection::server(&options.keys)?;
    let cabinet = match (&options.keys.key, &options.cabinet_key) {
        (Some(key), Some(cabinet)) => ClientSecurity::read(key, cabinet)
            .map(Remote::with_keys)
            .map_err(|error| connection::link_failure(&error.into()))?,
        _ => Remote::open(),
    };
    let host = &options.cabinet;
    let mut config = DriveConfig::default();
    config.robot = robot;
    config.instructions = options.instructions.to_string();
    config.stream = options.stream.to_string();
    config.fri = options.fri;
    config.fri_controller = match options.fri_cabinet {
        None => address(host, options.fri.is_ipv4())?,
        Some(ip) if ip.is_ipv4() == options.fri.is_ipv4() => ip,
        Some(ip) => {
            let message = format!("--fri-cabinet {ip} is not an address of the kind of --fri");
            return Err(Failure::input(message));
        }
    };
    config.cabinet_instructions = endpoint(host, options.cabinet_instructions);
    config.cabinet_state = endpoint(host, options.cabinet_state);
    if options.check {
        return check(&config, &cabinet, options.json);
    }
    output::catch_interrupts();
    service_log::start();
    let drive = Drive::start(config, &clients, &cabinet)
        .map_err(|error| connection::not_started(&error, "--instructions, --stream or --fri"))?;
    print_note(&format!(
        "iiwaDrive: requests at {}, stream at {}, FRI at UDP {}, cabinet {host}. Ctrl-C ends it.\n",
        drive.instructions(),
        drive.stream(),
        drive.fri()
    ));
    if !drive.answer_latency().real_time {
        print_note(
            "No real-time priority: to command at 1 ms, give the user rtprio in \
             /etc/security/limits.conf, or the program cap_sys_nice (setcap).\n",
        );
    }
    output::wait_for_interrupt(|| ());
    let AnswerLatency { received, answered, behind, slowest, .. } = drive.answer_latency();
    print_note(&format!(
        "{received} messages, {answered} answers, the slowest after {} us; {behind} sent after the \
         next message had arrived\n",
        slowest.as_micros()
    ));
    Ok(())
}

/// Checks the connection to the cabinet.
fn check(config: &DriveConfig, cabinet: &Remote, json: bool) -> Result<(), Failure> {
    // A closed output is not an error: the result is the exit code.
    let check = LinkCheck::run(config, cabinet, |step| {
        let _ = (!json).then(|| output::print(&format!("{}\n", printable(&step.line("--")))));
    });
    if json {
        output::print_json(&check)?;
    }
    let message = "the connection to the cabinet is not ready".to_owned();
    if check.ok { Ok(()) } else { Err(Failure::Run { message, cause: None }) }
}

fn endpoint(host: &str, port: u16) -> String {
    if host.contains(':') {
        format!("tcp://[{host}]:{port}")
    } else {
        format!("tcp://{host}:{port}")
    }
}

/// Resolves a host name.
fn address(host: &str, v4: bool) -> Result<IpAddr, Failure> {
    let address = (host, 0)
        .to_socket_addrs()
        .map_err(|error| Failure::input(format!("--cabinet {host}: {error}")))?
        .map(|address| address.ip())
        .find(|address| address.is_ipv4() == v4);
    address.ok_or_else(|| {
        Failure::input(format!("--cabinet {host} has no address of the kind of --fri"))
    })
}
