//! `iiwasim cabinet`.

use std::time::Duration;

use iiwa_cabinet::{Cabinet, CabinetConfig, Faults, Repeated};

use crate::{
    args, connection,
    failure::{Failure, print_note},
    input::find_robot,
    output, service_log,
};

/// Duration of a repeated fault.
const FAULT: Duration = Duration::from_secs(1);

/// Simulates a cabinet until an interrupt.
pub(crate) fn run(options: &args::Cabinet) -> Result<(), Failure> {
    let robot = find_robot(&options.robot)?;
    let server = connection::server(&options.keys)?;
    let faults = &options.faults;
    let mut config = CabinetConfig::default();
    config.robot = robot;
    config.start_rad = options.start_deg.unwrap_or_default().map(f64::to_radians);
    config.period_ms = options.period;
    config.receive_multiplier = options.receive_multiplier;
    config.speed = options.speed;
    config.lag_s = options.lag * 1e-3;
    config.vibration_rad = options.vibration;
    config.noise_rad = options.noise;
    config.torque_noise_nm = options.torque_noise;
    (config.load, config.mount) = (options.load, options.mount);
    config.fri_client = options.fri;
    config.instructions = options.instructions.to_string();
    config.state = options.state.to_string();
    config.without_times = options.without_times;
    config.signals.clone_from(&options.signals);
    config.faults = Faults::default()
        .with_packet_loss(faults.packet_loss / 100.0)
        .with_delay_cycles(faults.delay);
    config.faults.emergency_stop_at = faults.emergency_stop.map(|percent| percent / 100.0);
    output::catch_interrupts();
    service_log::start();
    let cabinet = Cabinet::start(config, &server)
        .map_err(|error| connection::not_started(&error, "--instructions or --state"))?;
    print_note(&format!(
        "Simulated cabinet: instructions at {}, state at {}, FRI every {} ms to UDP {}. Ctrl-C \
         ends it.\n",
        cabinet.instructions(),
        cabinet.state(),
        options.period,
        options.fri
    ));
    let mut silence = Repeated::new(faults.silence_every);
    let mut dropped = Repeated::new(faults.drop_session_every);
    output::wait_for_interrupt(|| {
        if silence.is_due() {
            tracing::info!("fault: FRI is silent for {FAULT:?}");
            cabinet.silence(FAULT);
        }
        if dropped.is_due() {
            tracing::info!("fault: the FRI session is dropped for {FAULT:?}");
            cabinet.drop_session(FAULT.as_secs_f64());
        }
    });
    print_note(&format!("{}\n", cabinet.report()));
    Ok(())
}
