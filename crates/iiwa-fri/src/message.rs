//! What the two sides say to each other, whatever the version of the FRI.

use std::time::Duration;

use iiwa_kin::Joints;

/// Declares states that have a name.
macro_rules! named {
    ($(#[$doc:meta])* $type:ident { $($(#[$variant_doc:meta])* $variant:ident = $name:literal,)+ }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum $type {
            $($(#[$variant_doc])* $variant,)+
        }

        impl $type {
            /// The name in messages and figures, in small letters.
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
    /// How far a session has come.
    SessionState {
        /// There is no session.
        #[default]
        Idle = "idle",
        /// The controller sends; the connection is not good enough yet.
        MonitoringWait = "monitoring_wait",
        /// The connection is good enough to command.
        MonitoringReady = "monitoring_ready",
        /// The controller waits for set-points that agree with where the robot is.
        CommandingWait = "commanding_wait",
        /// The robot follows the set-points.
        CommandingActive = "commanding_active",
    }
}

impl SessionState {
    /// Whether the client's set-points matter: the two commanding states.
    #[must_use]
    pub const fn commands(self) -> bool {
        matches!(self, Self::CommandingWait | Self::CommandingActive)
    }
}

named! {
    /// How reliably the client's answers arrive.
    Quality {
        /// Not to be relied upon.
        #[default]
        Poor = "poor",
        /// Some are missing.
        Fair = "fair",
        /// Enough to command.
        Good = "good",
        /// Next to none is missing.
        Excellent = "excellent",
    }
}

named! {
    /// What the safety controller demands.
    Safety {
        /// Nothing.
        #[default]
        Normal = "normal",
        /// Stop 0: the drives are switched off at once.
        Stop0 = "stop_0",
        /// Stop 1: braking on the path, then the drives are switched off.
        Stop1 = "stop_1",
        /// Stop 2: braking on the path; the drives stay on.
        Stop2 = "stop_2",
    }
}

named! {
    /// The operating mode chosen at the robot.
    OperationMode {
        /// T1: by hand, at reduced velocity.
        T1 = "t1",
        /// T2: by hand, at full velocity.
        T2 = "t2",
        /// AUT: automatic.
        #[default]
        Automatic = "automatic",
    }
}

named! {
    /// What the drives do.
    Drive {
        /// No torque.
        #[default]
        Off = "off",
        /// On their way from one to the other.
        Transitioning = "transitioning",
        /// Under torque.
        Active = "active",
    }
}

named! {
    /// How the joints are controlled.
    ControlMode {
        /// Stiff, by position.
        #[default]
        Position = "position",
        /// Like springs in Cartesian space.
        CartesianImpedance = "cartesian_impedance",
        /// Like springs at the joints.
        JointImpedance = "joint_impedance",
        /// Not at all.
        None = "none",
    }
}

named! {
    /// What the client commands.
    CommandMode {
        /// Nothing.
        #[default]
        None = "none",
        /// Joint positions.
        Position = "position",
        /// Forces and torques at the tool.
        Wrench = "wrench",
        /// Torques at the joints.
        Torque = "torque",
    }
}

named! {
    /// What the client's commands are laid over.
    Overlay {
        /// No motion takes them.
        #[default]
        None = "none",
        /// A motion of the joints.
        Joint = "joint",
        /// A Cartesian motion.
        Cartesian = "cartesian",
    }
}

/// What the controller sends, once a cycle. What a message leaves out is `None`.
#[derive(Clone, Debug, PartialEq)]
pub struct Monitoring {
    /// The controller's counter, which wraps around.
    pub sequence: u32,
    /// The counter of the client's answer that the controller took last; 0 before the first.
    pub reflected: u32,
    /// How far the session has come.
    pub session: SessionState,
    /// How well the answers arrive.
    pub quality: Quality,
    /// Time from one message to the next, in ms; 0 when the controller does not say.
    pub send_period_ms: u32,
    /// An answer is due every so many messages, at least 1.
    pub receive_multiplier: u32,
    /// What the safety controller demands.
    pub safety: Option<Safety>,
    /// The operating mode.
    pub operation_mode: Option<OperationMode>,
    /// What the drives do; where they differ, the one that is furthest from being active.
    pub drive: Option<Drive>,
    /// How the joints are controlled.
    pub control_mode: Option<ControlMode>,
    /// Measured joint positions, in rad.
    pub measured_rad: Option<Joints>,
    /// Measured joint torques, in Nm.
    pub measured_torque_nm: Option<Joints>,
    /// Commanded joint positions, in rad.
    pub commanded_rad: Option<Joints>,
    /// Commanded joint torques, in Nm.
    pub commanded_torque_nm: Option<Joints>,
    /// External joint torques, in Nm: the measured ones without the robot's own weight and motion.
    pub external_torque_nm: Option<Joints>,
    /// Joint positions of the controller's own interpolation, in rad, which commands start from.
    pub ipo_rad: Option<Joints>,
    /// What the client commands.
    pub command_mode: Option<CommandMode>,
    /// What the client's commands are laid over.
    pub overlay: Option<Overlay>,
    /// How well the robot follows the commands, from 0 to 1.
    pub tracking_performance: Option<f64>,
    /// The controller's time stamp.
    pub time: Option<Duration>,
}

impl Default for Monitoring {
    /// A first message of an idle session that carries nothing else, and asks for every answer.
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

/// What the client answers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Command {
    /// The client's own counter, from 0 on, which wraps around.
    pub sequence: u32,
    /// The counter of the controller's message that this answers.
    pub reflected: u32,
    /// Set-points of the joints, in rad; `None` in an answer that is a header alone.
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
