//! Messages of both sides, independent of the FRI version.

use std::time::Duration;

use iiwa_kin::Joints;

/// Maximum datagram length, in bytes.
pub const MAX_DATAGRAM_BYTES: usize = 1500;

/// Declares an enum whose variants have names.
macro_rules! named {
    ($(#[$doc:meta])* $type:ident {
        $($(#[$variant_doc:meta])* $variant:ident = $name:literal,)+
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum $type {
            $($(#[$variant_doc])* $variant,)+
        }

        impl $type {
            /// Returns the name in JSON messages and reports, in snake case.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)+
                }
            }
        }
    };
}

named! {
    /// Session state.
    ///
    /// ```
    /// use iiwa_fri::SessionState;
    ///
    /// assert_eq!(SessionState::MonitoringReady.name(), "monitoring_ready");
    /// assert!(SessionState::MonitoringReady < SessionState::CommandingWait);
    /// assert!(SessionState::CommandingActive.commands());
    /// ```
    SessionState {
        /// No session.
        #[default]
        Idle = "idle",
        /// The controller sends; the connection quality is not yet sufficient.
        MonitoringWait = "monitoring_wait",
        /// The connection quality is sufficient for commanding.
        MonitoringReady = "monitoring_ready",
        /// The controller waits for set-points that match the robot's position.
        CommandingWait = "commanding_wait",
        /// The robot follows the set-points.
        CommandingActive = "commanding_active",
    }
}

impl SessionState {
    /// Returns true in the two commanding states, in which the controller evaluates the client's
    /// set-points.
    #[must_use]
    pub const fn commands(self) -> bool {
        matches!(self, Self::CommandingWait | Self::CommandingActive)
    }
}

named! {
    /// Connection quality rated by the controller, by the reliability of the client's answers.
    ///
    /// ```
    /// use iiwa_fri::Quality;
    ///
    /// // Commanding needs at least `Good`.
    /// assert!(Quality::Fair < Quality::Good && Quality::Good < Quality::Excellent);
    /// assert_eq!(Quality::default().name(), "poor");
    /// ```
    Quality {
        /// Many answers are missing.
        #[default]
        Poor = "poor",
        /// Some answers are missing.
        Fair = "fair",
        /// Sufficient for commanding.
        Good = "good",
        /// Hardly any answer is missing.
        Excellent = "excellent",
    }
}

named! {
    /// Stop category demanded by the safety controller (IEC 60204-1).
    Safety {
        /// No stop.
        #[default]
        Normal = "normal",
        /// Stop 0: the drives are switched off immediately.
        Stop0 = "stop_0",
        /// Stop 1: braking on the path, then the drives are switched off.
        Stop1 = "stop_1",
        /// Stop 2: braking on the path; the drives remain switched on.
        Stop2 = "stop_2",
    }
}

named! {
    /// Operating mode selected at the robot.
    OperationMode {
        /// T1: manual, reduced velocity.
        T1 = "t1",
        /// T2: manual, full velocity.
        T2 = "t2",
        /// AUT: automatic.
        #[default]
        Automatic = "automatic",
    }
}

named! {
    /// State of the drives.
    Drive {
        /// Switched off.
        #[default]
        Off = "off",
        /// Being switched on or off.
        Transitioning = "transitioning",
        /// Switched on.
        Active = "active",
    }
}

named! {
    /// Control mode of the joints.
    ControlMode {
        /// Position control.
        #[default]
        Position = "position",
        /// Cartesian impedance control.
        CartesianImpedance = "cartesian_impedance",
        /// Joint impedance control.
        JointImpedance = "joint_impedance",
        /// No control.
        None = "none",
    }
}

named! {
    /// Quantity that the client commands.
    CommandMode {
        /// None.
        #[default]
        None = "none",
        /// Joint positions.
        Position = "position",
        /// Cartesian forces and torques at the tool.
        Wrench = "wrench",
        /// Joint torques.
        Torque = "torque",
    }
}

named! {
    /// Motion on which the client's commands are superimposed.
    Overlay {
        /// None.
        #[default]
        None = "none",
        /// A joint-space motion.
        Joint = "joint",
        /// A Cartesian motion.
        Cartesian = "cartesian",
    }
}

/// A monitoring message, sent by the controller once per cycle. Fields absent from a message are
/// `None`.
///
/// ```
/// use iiwa_fri::{Format, Monitoring, SessionState};
///
/// let sent = Monitoring {
///     sequence: 7,
///     session: SessionState::MonitoringWait,
///     send_period_ms: 5,
///     measured_rad: Some([0.1; 7]),
///     ..Monitoring::default()
/// };
/// let mut datagram = Vec::new();
/// Format::V1.encode_monitoring(&sent, &mut datagram);
/// assert_eq!(Format::V1.decode_monitoring(&datagram)?, sent);
/// # Ok::<(), iiwa_fri::WireError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Monitoring {
    /// Sequence counter of the controller, which wraps around.
    pub sequence: u32,
    /// Sequence counter of the answer that the controller accepted last; 0 before the first.
    pub reflected: u32,
    /// Session state.
    pub session: SessionState,
    /// Connection quality.
    pub quality: Quality,
    /// Time between messages, in ms; 0 if not stated.
    pub send_period_ms: u32,
    /// Number of messages per expected answer, at least 1.
    pub receive_multiplier: u32,
    /// Stop category demanded by the safety controller.
    pub safety: Option<Safety>,
    /// Operating mode.
    pub operation_mode: Option<OperationMode>,
    /// State of the drives; if they differ, the state furthest from active.
    pub drive: Option<Drive>,
    /// Control mode of the joints.
    pub control_mode: Option<ControlMode>,
    /// Measured joint positions, in rad.
    pub measured_rad: Option<Joints>,
    /// Measured joint torques, in Nm.
    pub measured_torque_nm: Option<Joints>,
    /// Commanded joint positions, in rad.
    pub commanded_rad: Option<Joints>,
    /// Commanded joint torques, in Nm.
    pub commanded_torque_nm: Option<Joints>,
    /// External joint torques, in Nm: the measured torques minus the torques due to the weight and
    /// motion of the robot.
    pub external_torque_nm: Option<Joints>,
    /// Interpolated joint positions of the controller's own motion, in rad.
    pub ipo_rad: Option<Joints>,
    /// Quantity that the client commands.
    pub command_mode: Option<CommandMode>,
    /// Motion on which the client's commands are superimposed.
    pub overlay: Option<Overlay>,
    /// Tracking performance of the robot, from 0 to 1.
    pub tracking_performance: Option<f64>,
    /// Controller time stamp.
    pub time: Option<Duration>,
}

impl Default for Monitoring {
    /// The first message of an idle session: no joint data, one answer per message.
    fn default() -> Self {
        Self {
            sequence: 0,
            reflected: 0,
            session: SessionState::default(),
            quality: Quality::default(),
            send_period_ms: 0,
            receive_multiplier: 1,
            safety: None,
            operation_mode: None,
            drive: None,
            control_mode: None,
            measured_rad: None,
            measured_torque_nm: None,
            commanded_rad: None,
            commanded_torque_nm: None,
            external_torque_nm: None,
            ipo_rad: None,
            command_mode: None,
            overlay: None,
            tracking_performance: None,
            time: None,
        }
    }
}

/// A command message, the client's answer to a monitoring message.
///
/// ```
/// use iiwa_fri::{Command, Format};
///
/// let answer = Command { sequence: 0, reflected: 7, joints_rad: Some([0.1; 7]) };
/// let mut datagram = Vec::new();
/// Format::V1.encode_command(&answer, &mut datagram);
/// assert_eq!(Format::V1.decode_command(&datagram)?, answer);
/// # Ok::<(), iiwa_fri::WireError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Command {
    /// Sequence counter of the client, from 0, which wraps around.
    pub sequence: u32,
    /// Sequence counter of the answered monitoring message.
    pub reflected: u32,
    /// Joint set-points, in rad; `None` in an answer that consists of a header only.
    pub joints_rad: Option<Joints>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_have_names_and_an_order() {
        use SessionState::{
            CommandingActive, CommandingWait, Idle, MonitoringReady, MonitoringWait,
        };
        let states = [Idle, MonitoringWait, MonitoringReady, CommandingWait, CommandingActive];
        assert!(states.is_sorted());
        assert_eq!(states.map(SessionState::commands), [false, false, false, true, true]);
        assert_eq!(
            states.map(SessionState::name),
            ["idle", "monitoring_wait", "monitoring_ready", "commanding_wait", "commanding_active"]
        );
        let qualities = [Quality::Poor, Quality::Fair, Quality::Good, Quality::Excellent];
        assert!(qualities.is_sorted());
        assert_eq!(qualities.map(Quality::name), ["poor", "fair", "good", "excellent"]);
    }
}
