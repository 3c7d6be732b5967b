//! Configuration of a simulated cabinet.

use std::net::SocketAddr;

use iiwa_kin::{Joints, Load, Mount, Robot};
use iiwa_link::{CABINET_INSTRUCTIONS_PORT, CABINET_STATE_PORT, FRI_PORT, message::IoValue};

use crate::position_sensors::{LAG_S, VIBRATION_RAD};

/// Configuration of a simulated cabinet. Set the fields that differ from the default:
///
/// ```
/// use iiwa_cabinet::{CabinetConfig, Faults};
///
/// let mut config = CabinetConfig::default();
/// config.period_ms = 10;
/// config.faults = Faults::default().with_packet_loss(0.01);
/// assert_eq!(config.receive_multiplier, 1);
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CabinetConfig {
    /// The robot.
    pub robot: Robot,
    /// Initial joint positions, in rad.
    pub start_rad: Joints,
    /// FRI send period, in ms: 1 to 100, and at most 10 for commanding.
    pub period_ms: u32,
    /// Number of FRI messages per expected answer.
    pub receive_multiplier: u32,
    /// Speed of the controller clock, as a multiple of real time.
    pub speed: f64,
    /// Lag of measured joint positions behind commanded ones, in s: 0 to 1.
    /// [`CabinetConfig::RECORDED_LAG_S`] is the lag of a real robot.
    pub lag_s: f64,
    /// Standard deviation of the vibration of measured positions while a joint moves, in rad.
    /// [`CabinetConfig::RECORDED_VIBRATION_RAD`] is the value of a real robot.
    pub vibration_rad: f64,
    /// Standard deviation of measured joint positions, also at rest, in rad.
    pub noise_rad: f64,
    /// Standard deviation of measured torques, in Nm.
    pub torque_noise_nm: f64,
    /// Actual payload, regardless of the programs. The controller computes the expected torques
    /// from the payload that a program states: the remainder is external. `None` uses the programs'
    /// payloads.
    pub load: Option<Load>,
    /// Actual mounting, regardless of the programs, known to the controller. `None` uses the
    /// programs' mountings.
    pub mount: Option<Mount>,
    /// UDP address of the FRI client.
    pub fri_client: SocketAddr,
    /// Address of the socket for instructions.
    pub instructions: String,
    /// Address of the socket for state changes.
    pub state: String,
    /// Omits the values that robot programs on real cabinets do not know: the times of outcomes,
    /// and joint temperatures.
    pub without_times: bool,
    /// Initial values of inputs and outputs, by name; those of other signals are false and 0.
    pub signals: Vec<(String, IoValue)>,
    /// Simulated faults.
    pub faults: Faults,
}

impl CabinetConfig {
    /// Lag of measured positions of a real LBR iiwa 7 R800, in s; docs/evidence.md states the
    /// source.
    pub const RECORDED_LAG_S: f64 = LAG_S;

    /// Standard deviation of the vibration of moving joints of that robot, in rad.
    pub const RECORDED_VIBRATION_RAD: f64 = VIBRATION_RAD;
}

impl Default for CabinetConfig {
    fn default() -> Self {
        Self {
            robot: Robot::default(),
            start_rad: [0.0; 7],
            period_ms: 5,
            receive_multiplier: 1,
            speed: 1.0,
            lag_s: 0.0,
            vibration_rad: 0.0,
            noise_rad: 0.0,
            torque_noise_nm: 0.0,
            load: None,
            mount: None,
            fri_client: SocketAddr::from(([127, 0, 0, 1], FRI_PORT)),
            instructions: format!("tcp://127.0.0.1:{CABINET_INSTRUCTIONS_PORT}"),
            state: format!("tcp://127.0.0.1:{CABINET_STATE_PORT}"),
            without_times: false,
            signals: Vec::new(),
            faults: Faults::default(),
        }
    }
}

/// Simulated faults, none by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Faults {
    /// Share of lost FRI datagrams in either direction, 0 to 1.
    pub packet_loss: f64,
    /// Delay of FRI messages, in cycles.
    pub delay_cycles: u32,
    /// Presses the emergency stop for two seconds after this share of the next motion, 0 to 1.
    pub emergency_stop_at: Option<f64>,
}

impl Faults {
    /// Sets the share of lost FRI datagrams, 0 to 1.
    #[must_use]
    pub fn with_packet_loss(self, packet_loss: f64) -> Self {
        Self { packet_loss, ..self }
    }

    /// Sets the delay of FRI messages, in cycles.
    #[must_use]
    pub fn with_delay_cycles(self, delay_cycles: u32) -> Self {
        Self { delay_cycles, ..self }
    }

    /// Presses the emergency stop after this share of the next motion, 0 to 1.
    #[must_use]
    pub fn with_emergency_stop_at(self, share: f64) -> Self {
        Self { emergency_stop_at: Some(share), ..self }
    }
}
