//! Robot state, limited to the variables of OPC 40010-1.

use std::time::{Duration, Instant, SystemTime};

use iiwa_kin::{Joints, Load};
use iiwa_link::message::{DriveState, FriStatus, OperationMode, Presence};
use opcua::types::{DataValue, DateTime, StatusCode, Variant};

use iiwa_bridge::message::{Content, CycleSample, Message, RobotConditions, RunPhase};

use crate::derivatives::{JointRates, PositionWindow};

/// Maximum age of positions that count as current. The slowest streams have one sample per 100 ms.
const FRESH: Duration = Duration::from_secs(1);

/// Robot state.
#[derive(Clone, Debug)]
pub(crate) struct RobotState {
    /// Time of the last message, by this computer's clock.
    pub(crate) at: DateTime,
    /// `true` if the drive answers; otherwise the following values are old.
    pub(crate) connected: bool,
    pub(crate) motion: Option<JointReadings>,
    pub(crate) window: PositionWindow,
    pub(crate) drive: Option<DriveState>,
    /// `true` if the robot program is connected.
    pub(crate) ready: bool,
    /// `true` if the safety controller demands a stop.
    pub(crate) safety_stop: Option<bool>,
    pub(crate) mode: Option<OperationMode>,
    /// Override, from 0 to 1.
    pub(crate) override_rel: Option<f64>,
    /// Name of the running or last program; empty for a program without name.
    pub(crate) program: Option<String>,
    /// Name and version of the robot program.
    pub(crate) robot_program: Option<String>,
    /// Version of the controller's system software.
    pub(crate) system_software: Option<String>,
    /// Joint temperatures, in degrees Celsius.
    pub(crate) temperatures: Option<Joints>,
    pub(crate) load: Option<Load>,
}

/// Joint positions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointReadings {
    joints_rad: Joints,
    at: DateTime,
    /// Time of reception, by the monotonic clock.
    came: Instant,
}

impl Default for RobotState {
    fn default() -> Self {
        Self {
            at: DateTime::now(),
            connected: false,
            motion: None,
            window: PositionWindow::default(),
            drive: None,
            ready: false,
            safety_stop: None,
            mode: None,
            override_rel: None,
            program: None,
            robot_program: None,
            system_software: None,
            temperatures: None,
            load: None,
        }
    }
}

impl RobotState {
    /// Creates the state of a robot without messages, with this load.
    pub(crate) fn unheard_of(load: Option<Load>) -> Self {
        Self { load, ..Self::default() }
    }

    /// Updates the state from a message.
    pub(crate) fn take(&mut self, message: &Message) {
        let time = DateTime::from(chrono::DateTime::from(SystemTime::from(message.at)));
        self.at = time;
        match &message.content {
            Content::Joints(sample) => {
                let CycleSample { t_s, joints_rad, .. } = *sample;
                // A busy disk of another broker may have delayed the message.
                let age = SystemTime::from(message.at).elapsed().unwrap_or_default();
                let came = Instant::now().checked_sub(age).unwrap_or_else(Instant::now);
                self.motion = Some(JointReadings { joints_rad, at: time, came });
                self.window.push(t_s, joints_rad);
            }
            Content::State { state, .. } => self.drive = Some(*state),
            Content::Run(run) if run.event == RunPhase::Begin => {
                self.program = Some(run.label.program.clone().unwrap_or_default());
            }
            Content::Sensors(sensors) => self.temperatures = sensors.joint_temperature_c,
            Content::Conditions(conditions) => self.take_conditions(conditions),
            // Run ends, inputs and outputs, the bridge itself.
            _ => {}
        }
    }

    fn take_conditions(&mut self, now: &RobotConditions) {
        self.connected = now.drive == Presence::Connected;
        self.ready = now.robot_program == Presence::Connected;
        // Values that are not reported any more are kept: their status marks them as old.
        if let Some(state) = now.state {
            self.drive = Some(state);
        }
        let conditions = now.conditions.as_ref();
        if let Some(stop) = safety_stop(now.fri.as_ref(), conditions.and_then(|it| it.safety_stop))
        {
            self.safety_stop = Some(stop);
        }
        if let Some(conditions) = conditions {
            self.mode.clone_from(&conditions.operation_mode);
            self.override_rel = conditions.override_rel;
        }
        if let Some(hello) = &now.hello {
            self.robot_program = Some(hello.program.clone());
            self.system_software.clone_from(&hello.sunrise);
        }
    }

    /// Returns a value of this state. `None` means unknown.
    pub(crate) fn value(&self, value: Option<impl Into<Variant>>) -> DataValue {
        let status = match (self.connected, &value) {
            (true, Some(_)) => StatusCode::Good,
            (true, None) => StatusCode::BadWaitingForInitialData,
            (false, Some(_)) => StatusCode::UncertainNoCommunicationLastUsableValue,
            (false, None) => StatusCode::BadNoCommunication,
        };
        self.value_with(value, status)
    }

    /// Returns a value with a specific status.
    pub(crate) fn value_with(
        &self,
        value: Option<impl Into<Variant>>,
        status: StatusCode,
    ) -> DataValue {
        let value = value.map_or(Variant::Empty, Into::into);
        DataValue::new_at_status(value, self.at, status)
    }

    /// Returns a value of the motion, which the stream provides: current as long as samples arrive,
    /// regardless of the drive's connection state.
    pub(crate) fn moving_value(&self, value: Option<f64>) -> DataValue {
        let fresh = self.motion.is_some_and(|motion| motion.came.elapsed() < FRESH);
        let status = match (fresh, &value) {
            (true, Some(_)) => StatusCode::Good,
            (true, None) => StatusCode::BadWaitingForInitialData,
            (false, Some(_)) => StatusCode::UncertainNoCommunicationLastUsableValue,
            (false, None) => StatusCode::BadNoCommunication,
        };
        let time = self.motion.map_or(self.at, |motion| motion.at);
        DataValue::new_at_status(value.map_or(Variant::Empty, Variant::from), time, status)
    }

    /// Returns the positions, in rad.
    pub(crate) fn positions(&self) -> Option<Joints> {
        self.motion.map(|motion| motion.joints_rad)
    }

    /// Returns speeds and accelerations, if there are enough positions.
    pub(crate) fn derivatives(&self) -> Option<JointRates> {
        self.window.derivatives()
    }
}

/// Returns true if the safety controller demands a stop, as reported by FRI or the robot program.
fn safety_stop(fri: Option<&FriStatus>, by_program: Option<bool>) -> Option<bool> {
    let heard = fri.filter(|fri| !fri.session.is_empty() && fri.session != FriStatus::SILENT);
    match (heard.map(|fri| fri.safety_stop), by_program) {
        (None, None) => None,
        (by_fri, by_program) => Some(by_fri == Some(true) || by_program == Some(true)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(content: &str) -> Message {
        let head =
            r#""version": 1, "robot": "r", "session": 1, "seq": 0, "at": "2026-11-25T22:00:00Z""#;
        Message::from_json(format!("{{{head}, {content}}}").as_bytes()).unwrap()
    }

    #[test]
    fn messages_add_up() {
        let mut state = RobotState::unheard_of(None);
        assert_eq!(
            state.value(state.mode.as_ref().map(|_| 1)).status(),
            StatusCode::BadNoCommunication
        );
        state.take(&message(
            r#""kind": "conditions", "drive": "connected", "state": "idle",
               "robot_program": "connected",
               "hello": {"protocol": 2, "program": "Program 1", "sunrise": "1.16"},
               "conditions": {"operation_mode": "aut", "override": 0.5, "safety_stop": false}"#,
        ));
        assert!(state.connected && state.ready);
        assert_eq!((state.mode.clone(), state.override_rel), (Some(OperationMode::Aut), Some(0.5)));
        assert_eq!(state.safety_stop, Some(false));
        assert_eq!(state.value(Some(1)).status(), StatusCode::Good);
        assert_eq!(state.moving_value(None).status(), StatusCode::BadNoCommunication);
        state.take(&message(
            r#""kind": "run", "t_s": 1, "run": 1, "event": "begin", "what": "motions",
               "program": "pick""#,
        ));
        state.take(&message(r#""kind": "joints", "t_s": 1, "joints_rad": [1, 2, 3, 4, 5, 6, 7]"#));
        assert_eq!(state.program.as_deref(), Some("pick"));
        assert_eq!(state.moving_value(state.positions().map(|it| it[6])).value, Some(7.0.into()));

        // Known values are kept when the drive is disconnected, and marked as old.
        state.take(&message(r#""kind": "conditions", "drive": "silent""#));
        assert_eq!(state.mode, Some(OperationMode::Aut));
        assert_eq!(
            state.value(Some(1)).status(),
            StatusCode::UncertainNoCommunicationLastUsableValue
        );
    }

    #[test]
    fn a_safety_stop_may_be_reported_by_either_source() {
        let fri = |session: &str, safety_stop| {
            let mut fri = FriStatus::new(session, "good");
            fri.safety_stop = safety_stop;
            fri
        };
        let silent = fri(FriStatus::SILENT, false);
        assert_eq!(safety_stop(None, None), None);
        assert_eq!(safety_stop(Some(&silent), None), None);
        assert_eq!(safety_stop(Some(&silent), Some(true)), Some(true));
        assert_eq!(safety_stop(Some(&fri("monitoring_ready", true)), Some(false)), Some(true));
        assert_eq!(safety_stop(Some(&fri("monitoring_ready", false)), None), Some(false));
    }
}
