//! Robot stops.

use iiwa_link::ClientError;

use iiwa_bridge::BridgedRobot;

/// A robot that can be stopped.
pub trait StopRobot: Send + Sync + 'static {
    /// Stops the robot on its path, and returns when it is at rest. The call may block for some
    /// seconds.
    ///
    /// # Errors
    ///
    /// The robot has not been stopped.
    fn stop(&self) -> Result<(), StopFailure>;
}

/// Reason why a robot has not been stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopFailure {
    /// The drive does not answer.
    Unreachable,
    /// The drive or the robot has refused the stop.
    Refused,
}

/// Stops the robot through its drive.
impl StopRobot for BridgedRobot {
    fn stop(&self) -> Result<(), StopFailure> {
        // A separate client, so that a stop does not wait for other requests.
        let stopped = self.client().map_err(ClientError::from).and_then(|mut it| it.stop());
        stopped.map_err(|error| {
            tracing::warn!("{}: the stop of a client of OPC UA failed: {error}", self.name());
            match error {
                ClientError::Refused { .. } => StopFailure::Refused,
                _ => StopFailure::Unreachable,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use iiwa_link::Remote;

    use super::*;

    // A client has its own runtime, which may not be entered from tasks of another one.
    #[test]
    fn a_missing_drive_is_reported_as_unreachable() {
        let [drive, stream] = ["tcp://127.0.0.1:9", "tcp://127.0.0.1:10"];
        let robot = BridgedRobot::new("cell-1", Remote::open(), drive, stream).unwrap();
        let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().unwrap();
        let stopped = runtime
            .block_on(async { tokio::task::spawn_blocking(move || robot.stop()).await.unwrap() });
        assert_eq!(stopped, Err(StopFailure::Unreachable));
    }
}
