//! Time parameterisation of joint paths: the service `iiwasim_msgs/srv/TimeJointPath`, and topics
//! of standard types for the same purpose.
//!
//! Trajectories are sent over a topic, because `RustDDS` 0.15 sends malformed service replies if
//! they are longer than a datagram.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel},
    },
    time::Duration,
};

use iiwa_kin::{Joints, Robot};
use iiwa_link::threads::ThreadGroup;
use iiwa_program::{LimitKind, Motion, MotionLimits, Ptp, Workcell};
use ros2_client::{
    Node, NodeLoggingHandle, Publisher, RmwRequestId, Server, ServiceMapping, Subscription,
    ros2::LogLevel, rosout,
};

use super::{
    error::Ros2Error,
    messages::{JointTrajectory, JointTrajectoryPoint, TimeRequest, TimeResponse},
    names::NodeNames,
    path_joints::JointOrder,
    qos,
    received::received,
};
use crate::retime::{Retimed, retime};

/// Maximum number of paths that wait for time parameterisation.
const BACKLOG: usize = 4;

/// Points per second of the result.
const RATE_HZ: f64 = 100.0;

/// Maximum duration of the result, in s.
const LONGEST_S: f64 = 900.0;

/// Maximum length of the message in a reply, in bytes.
const MAX_BYTES: usize = 900;

/// Time-out of waiting for a path, after which the shutdown flag is checked.
const POLL: Duration = Duration::from_millis(50);

type PathServer = Server<TimeRequest, TimeResponse>;

/// Service and topics of one robot, and the thread that computes the times.
pub(super) struct TimingService {
    server: Arc<PathServer>,
    paths: Subscription<JointTrajectory>,
    jobs: SyncSender<PathToTime>,
    log: NodeLoggingHandle,
    _threads: ThreadGroup,
}

/// A path to be timed, and the client to answer, if it used the service.
struct PathToTime {
    client: Option<RmwRequestId>,
    request: TimeRequest,
}

impl TimingService {
    /// Creates the service and the topics.
    pub(super) fn new(
        node: &mut Node,
        names: &NodeNames,
        robot: Robot,
        joints: [String; 7],
    ) -> Result<Self, Ros2Error> {
        let server: PathServer = node.create_server(
            ServiceMapping::Enhanced,
            &names.topic("time_joint_path")?,
            &NodeNames::service_type(),
            qos::service(),
            qos::service(),
        )?;
        let topic = node.create_topic(
            &names.topic("joint_path")?,
            NodeNames::path_type(),
            &qos::service(),
        )?;
        let paths = node.create_subscription(&topic, None)?;
        let topic = node.create_topic(
            &names.topic("timed_joint_path")?,
            NodeNames::path_type(),
            &qos::latched(),
        )?;
        let timed = node.create_publisher(&topic, None)?;
        let server = Arc::new(server);
        let (jobs, jobs_in) = sync_channel(BACKLOG);
        let mut threads = ThreadGroup::default();
        let timer =
            Timer { server: Arc::clone(&server), timed, robot, joints, log: node.logging_handle() };
        threads.spawn("ros2 times", move |shutdown| timer.run(&jobs_in, shutdown))?;
        Ok(Self { server, paths, jobs, log: node.logging_handle(), _threads: threads })
    }

    /// Handles pending requests and paths.
    pub(super) fn turn(&self) {
        while let Some((client, request)) = received(self.server.receive_request()) {
            if !self.start(PathToTime { client: Some(client), request }) {
                respond(&self.server, client, refused("too many paths wait to be timed"));
            }
        }
        while let Some((path, _)) = received(self.paths.take()) {
            if !self.start(PathToTime { client: None, request: TimeRequest::of_path(path) }) {
                rosout!(self.log, LogLevel::Warn, "too many paths wait to be timed");
            }
        }
    }

    fn start(&self, job: PathToTime) -> bool {
        match self.jobs.try_send(job) {
            Ok(()) => true,
            Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => false,
        }
    }
}

/// The time parameterisation, in a separate thread, because long paths take seconds.
struct Timer {
    server: Arc<PathServer>,
    timed: Publisher<JointTrajectory>,
    robot: Robot,
    joints: [String; 7],
    log: NodeLoggingHandle,
}

impl Timer {
    fn run(&self, jobs: &Receiver<PathToTime>, shutdown: &AtomicBool) {
        while !shutdown.load(Ordering::Relaxed) {
            let PathToTime { client, request } = match jobs.recv_timeout(POLL) {
                Ok(job) => job,
                Err(RecvTimeoutError::Timeout) => continue,
                Err(RecvTimeoutError::Disconnected) => return,
            };
            let response = match time(&self.robot, &self.joints, &request) {
                Ok((response, trajectory)) => {
                    drop(self.timed.publish(trajectory));
                    response
                }
                Err(fault) => {
                    rosout!(self.log, LogLevel::Warn, "a path gets no times: {fault}");
                    refused(fault)
                }
            };
            if let Some(client) = client {
                respond(&self.server, client, response);
            }
        }
    }
}

fn respond(server: &PathServer, client: RmwRequestId, response: TimeResponse) {
    if let Err(error) = server.send_response(client, response) {
        tracing::warn!("an answer was not sent: {error}");
    }
}

fn refused(reason: impl Into<String>) -> TimeResponse {
    let mut message: String = reason.into();
    // The reply must fit into a datagram.
    message.truncate(message.floor_char_boundary(MAX_BYTES));
    TimeResponse { message, ..TimeResponse::default() }
}

/// Times a path.
///
/// # Errors
///
/// The fault in the path, as text for people.
fn time(
    robot: &Robot,
    joints: &[String; 7],
    request: &TimeRequest,
) -> Result<(TimeResponse, JointTrajectory), String> {
    let order = JointOrder::new(joints, &request.path.joint_names)?;
    let mut points: Vec<Joints> = Vec::with_capacity(request.path.points.len());
    for (i, point) in request.path.points.iter().enumerate() {
        let in_point = |fault| format!("point {}: positions: {fault}", i + 1);
        let q = order.pick(&point.positions).map_err(in_point)?;
        points.push(q.ok_or_else(|| format!("point {} has no positions", i + 1))?);
    }
    let limits = limits(robot, request)?;
    let retimed =
        retime(robot, limits, &points, request.tolerance).map_err(|error| error.to_string())?;
    let seconds = retimed.trajectory.cycle_time_s();
    if seconds > LONGEST_S {
        return Err(format!("the path takes {seconds:.0} s, at most {LONGEST_S} s are answered"));
    }
    let response = TimeResponse {
        success: true,
        message: String::new(),
        duration: seconds,
        deviation: retimed.deviation_rad,
        stops: u32::try_from(retimed.stops).unwrap_or(u32::MAX),
    };
    Ok((response, message(joints, request, &retimed)))
}

/// Returns the robot's limits, scaled by the shares of a request as in `MoveIt`: 0 means full
/// limits.
fn limits(robot: &Robot, request: &TimeRequest) -> Result<MotionLimits, String> {
    let mut shares = Ptp::to([0.0; 7]);
    for (kind, name, share) in [
        (LimitKind::Velocity, "velocity_scaling", request.velocity_scaling),
        (LimitKind::Acceleration, "acceleration_scaling", request.acceleration_scaling),
    ] {
        if share != 0.0 {
            if !(0.001..=1.0).contains(&share) {
                return Err(format!("{name} is {share}; it has to be from 0.001 to 1, or 0 for 1"));
            }
            *shares.share_mut(kind) = [share; 7];
        }
    }
    Ok(MotionLimits::of_motion(robot, &Motion::Ptp(shares), &Workcell::default()))
}

fn message(joints: &[String; 7], request: &TimeRequest, retimed: &Retimed) -> JointTrajectory {
    let point = |state: iiwa_traj::State| JointTrajectoryPoint {
        positions: state.q.to_vec(),
        velocities: state.dq.to_vec(),
        accelerations: state.ddq.to_vec(),
        effort: Vec::new(),
        time_from_start: super::messages::Duration::from_seconds(state.t_s),
    };
    JointTrajectory {
        header: request.path.header.clone(),
        joint_names: joints.to_vec(),
        points: retimed.trajectory.samples(RATE_HZ).map(point).collect(),
    }
}

#[cfg(test)]
mod tests {
    use iiwa_kin::RosNames;

    use super::*;

    fn request() -> TimeRequest {
        TimeRequest::of_path(JointTrajectory {
            joint_names: RosNames::default().joints().to_vec(),
            points: [[0.0; 7], [0.5; 7], [0.5, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0]]
                .map(|q| JointTrajectoryPoint::of_positions(&q))
                .to_vec(),
            ..JointTrajectory::default()
        })
    }

    fn timed(request: &TimeRequest) -> Result<(TimeResponse, JointTrajectory), String> {
        time(&Robot::default(), &RosNames::default().joints(), request)
    }

    #[test]
    fn a_path_is_timed_from_rest_to_rest() {
        let (response, trajectory) = timed(&request()).unwrap();
        assert!(response.success && response.deviation <= 0.01);
        // Five joints reverse by half a radian.
        assert_eq!(response.stops, 1);
        let [first, .., last] = &trajectory.points[..] else { panic!("two points") };
        assert_eq!(first.positions, [0.0; 7]);
        assert_eq!(last.positions, request().path.points[2].positions);
        assert!(last.velocities.iter().all(|v| v.abs() < 1e-9));
        assert!((last.time_from_start.seconds() - response.duration).abs() < 1e-6);
    }

    #[test]
    fn shares_make_it_slower() {
        let full = timed(&request()).unwrap().0.duration;
        let slow = timed(&TimeRequest { velocity_scaling: 0.1, ..request() }).unwrap();
        assert!(slow.0.duration > 3.0 * full);
        for share in [-0.5, 1.5, f64::NAN] {
            let fault = timed(&TimeRequest { velocity_scaling: share, ..request() }).unwrap_err();
            assert!(fault.contains("velocity_scaling"), "{fault}");
        }
    }

    #[test]
    fn faults_are_named() {
        let mut other = request();
        other.path.joint_names[2] = "elbow".to_owned();
        assert!(timed(&other).unwrap_err().contains("elbow"));
        let mut other = request();
        other.path.points[1].positions[4] = 9.0;
        assert!(timed(&other).unwrap_err().contains("point 2"));
        let mut other = request();
        other.path.points.clear();
        assert!(timed(&other).unwrap_err().contains("no points"));
    }
}
