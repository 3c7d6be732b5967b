//! Inputs and outputs of the simulated cabinet.

use std::collections::BTreeMap;

use iiwa_link::message::{Direction, IoValue, Refusal, Signal, shortened};

/// Inputs and outputs, by name.
#[derive(Clone, Debug)]
pub(crate) struct Ports(BTreeMap<&'static str, Port>);

#[derive(Clone, Copy, Debug)]
struct Port {
    direction: Direction,
    value: IoValue,
}

impl Default for Ports {
    /// The signals of a media flange "Touch", and one signal of each numeric type.
    fn default() -> Self {
        use Direction::{Input, Output};
        use IoValue::{Analog, Boolean, Digital};
        let ports = [
            ("MediaFlange.UserButton", Input, Boolean(false)),
            ("MediaFlange.LEDBlue", Output, Boolean(false)),
            ("MediaFlange.InputX3Pin3", Input, Boolean(false)),
            ("MediaFlange.InputX3Pin4", Input, Boolean(false)),
            ("MediaFlange.OutputX3Pin1", Output, Boolean(false)),
            ("MediaFlange.OutputX3Pin2", Output, Boolean(false)),
            ("MediaFlange.SwitchOffX3Voltage", Output, Boolean(false)),
            ("Simulation.DigitalInput", Input, Digital(0)),
            ("Simulation.DigitalOutput", Output, Digital(0)),
            ("Simulation.AnalogInput", Input, Analog(0.0)),
            ("Simulation.AnalogOutput", Output, Analog(0.0)),
        ];
        let ports = ports.map(|(name, direction, value)| (name, Port { direction, value }));
        Self(BTreeMap::from(ports))
    }
}

impl Ports {
    /// Returns all inputs and outputs, by name.
    pub(crate) fn all(&self) -> Vec<Signal> {
        let signal = |(name, port): (&&'static str, &Port)| Signal {
            name: (*name).to_owned(),
            direction: port.direction,
            value: port.value,
        };
        self.0.iter().map(signal).collect()
    }

    pub(crate) fn get(&self, name: &str) -> Result<IoValue, Refusal> {
        self.0.get(name).map(|port| port.value).ok_or_else(|| self.unknown(name))
    }

    /// Sets an output and returns its new value.
    pub(crate) fn set(&mut self, name: &str, value: IoValue) -> Result<IoValue, Refusal> {
        let Some(port) = self.0.get(name) else { return Err(self.unknown(name)) };
        if port.direction == Direction::Input {
            return Err(Refusal::bad(format!("{name} is an input; it cannot be set")));
        }
        self.assign(name, value)
    }

    /// Sets an input or output and returns its new value.
    pub(crate) fn assign(&mut self, name: &str, value: IoValue) -> Result<IoValue, Refusal> {
        use IoValue::{Analog, Boolean, Digital};
        let Some(port) = self.0.get_mut(name) else { return Err(self.unknown(name)) };
        port.value = match (port.value, value) {
            (Boolean(_), Boolean(_)) | (Digital(_), Digital(_)) | (Analog(_), Analog(_)) => value,
            #[expect(clippy::cast_precision_loss, reason = "an analog value is a float")]
            (Analog(_), Digital(value)) => Analog(value as f64),
            (Boolean(_), _) => {
                return Err(Refusal::bad(format!("{name} takes true or false, not {value}")));
            }
            (Digital(_), _) => {
                return Err(Refusal::bad(format!("{name} takes a whole number, not {value}")));
            }
            (Analog(_), _) => {
                return Err(Refusal::bad(format!("{name} takes a number, not {value}")));
            }
        };
        Ok(port.value)
    }

    fn unknown(&self, name: &str) -> Refusal {
        let names = self.0.keys().copied().collect::<Vec<_>>().join(", ");
        Refusal::bad(format!(
            "unknown input or output `{}`; known names are {names}",
            shortened(name)
        ))
    }
}
