//! Server of the `FollowJointTrajectory` action.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use byteorder::LittleEndian;
use iiwa_link::TimedJoints;
use ros2_client::{
    ActionServer, Node, NodeLoggingHandle, RmwRequestId, ServiceMapping,
    action::{
        CancelGoalRequest, GoalId, GoalInfo, GoalStatusEnum, SendGoalRequest, SendGoalResponse,
    },
    builtin_interfaces,
    ros2::LogLevel,
    rosout,
};
use serde::Deserialize;
use tokio::sync::mpsc::UnboundedReceiver;

use super::{
    error::Ros2Error,
    execution::{Execution, Job, JobProgress},
    goal::Goal,
    goals::{End, Goals},
    latest::Latest,
    messages::{FollowFeedback, FollowGoal, FollowResult, Header, JointTrajectoryPoint, Time},
    names::NodeNames,
    qos,
    received::received,
    retiming::Retiming,
};

/// Interval of feedback messages, equal to that of `joint_trajectory_controller`.
const FEEDBACK_EVERY: Duration = Duration::from_millis(50);

type FollowServer = ActionServer<FollowGoal, FollowResult, FollowFeedback>;

/// Action server of one robot.
pub(super) struct FollowAction {
    server: FollowServer,
    goals: Goals,
    execution: Execution,
    progress: UnboundedReceiver<JobProgress>,
    latest: Arc<Latest>,
    joints: [String; 7],
    log: NodeLoggingHandle,
    /// The running motion, once sent to the drive.
    motion: Option<Arc<TimedJoints>>,
    feedback_at: Instant,
}

impl FollowAction {
    /// Creates the action server.
    pub(super) fn new(
        node: &mut Node,
        names: &NodeNames,
        joints: [String; 7],
        latest: Arc<Latest>,
        (execution, progress): (Execution, UnboundedReceiver<JobProgress>),
    ) -> Result<Self, Ros2Error> {
        let server = node.create_action_server(
            ServiceMapping::Enhanced,
            &names.action()?,
            &NodeNames::action_type(),
            qos::action(),
        )?;
        Ok(Self {
            server,
            goals: Goals::default(),
            execution,
            progress,
            latest,
            joints,
            log: node.logging_handle(),
            motion: None,
            feedback_at: Instant::now(),
        })
    }

    /// Handles pending requests and progress. `retiming` applies to goals that arrive in this turn.
    pub(super) fn turn(&mut self, retiming: Retiming) {
        // A malformed request is not answered, because its goal is unknown.
        while let Some((request, goal)) = received(self.server.receive_goal()) {
            self.answer_goal(request, &goal, retiming);
        }
        while let Some((request, content)) = received(self.server.receive_cancel_request()) {
            self.answer_cancel(request, &content);
        }
        while let Some((request, content)) = received(self.server.receive_result_request()) {
            if let Some(response) = self.goals.result(content.goal_id, request) {
                log_failure(self.server.send_result(request, response));
            }
        }
        while let Ok(progress) = self.progress.try_recv() {
            match progress {
                JobProgress::Begun(motion) => self.motion = Some(motion),
                JobProgress::Ended { end, result } => self.end(end, result),
            }
        }
        if self.feedback_at.elapsed() >= FEEDBACK_EVERY {
            self.feedback_at = Instant::now();
            self.send_feedback();
        }
    }

    fn answer_goal(
        &mut self,
        request: RmwRequestId,
        content: &SendGoalRequest<FollowGoal>,
        retiming: Retiming,
    ) {
        let stamp = builtin_interfaces::Time::now();
        let accepted = match self.begin(content.goal_id, &content.goal, stamp, retiming) {
            Ok(()) => true,
            Err(fault) => {
                // The response has no field for the reason.
                rosout!(self.log, LogLevel::Warn, "a goal was rejected: {fault}");
                false
            }
        };
        log_failure(self.server.send_goal_response(request, SendGoalResponse { accepted, stamp }));
        if accepted {
            self.send_statuses();
        }
    }

    fn begin(
        &mut self,
        id: GoalId,
        message: &FollowGoal,
        stamp: builtin_interfaces::Time,
        retiming: Retiming,
    ) -> Result<(), String> {
        if self.goals.knows(id) {
            return Err("its id is that of another goal".to_owned());
        }
        if self.goals.active().is_some() {
            return Err("another goal is running; cancel it, and wait for its result".to_owned());
        }
        let goal = Goal::read(message, &self.joints, Time::now().seconds())?;
        let from = self.latest.get().0.map(|sample| sample.q);
        if !self.execution.start_job(Job { goal, retiming, from }) {
            return Err("the goal before has not ended".to_owned());
        }
        self.goals.begin(id, stamp);
        Ok(())
    }

    fn answer_cancel(&mut self, request: RmwRequestId, content: &CancelGoalRequest) {
        let Some(content) = goal_info(content) else { return };
        let response = self.goals.cancel(&content);
        if !response.goals_canceling.is_empty() {
            self.execution.stop();
            self.send_statuses();
        }
        log_failure(self.server.send_cancel_response(request, response));
    }

    fn end(&mut self, end: End, result: FollowResult) {
        self.motion = None;
        let Some((waiting, response)) = self.goals.end(end, result) else { return };
        if response.status == GoalStatusEnum::Aborted {
            rosout!(self.log, LogLevel::Warn, "a goal failed: {}", response.result.error_string);
        }
        for request in waiting {
            log_failure(self.server.send_result(request, response.clone()));
        }
        self.send_statuses();
    }

    fn send_statuses(&self) {
        drop(self.server.send_goal_statuses(self.goals.statuses()));
    }

    /// Sends feedback with the desired and the actual position.
    fn send_feedback(&self) {
        let Some((id, _)) = self.goals.active() else { return };
        let (Some(motion), (Some(sample), Some(since_s))) = (&self.motion, self.latest.get())
        else {
            return;
        };
        let t_s = (sample.t_s - since_s).max(0.0);
        let q = motion.at(t_s);
        let time_from_start = super::messages::Duration::from_seconds(t_s);
        let point =
            |q| JointTrajectoryPoint { time_from_start, ..JointTrajectoryPoint::of_positions(q) };
        let feedback = FollowFeedback {
            header: Header { stamp: Time::now(), frame_id: String::new() },
            joint_names: self.joints.to_vec(),
            desired: point(&q),
            actual: JointTrajectoryPoint { velocities: sample.dq.to_vec(), ..point(&sample.q) },
            error: point(&std::array::from_fn(|j| q[j] - sample.q[j])),
            ..FollowFeedback::default()
        };
        drop(self.server.send_feedback(id, feedback));
    }
}

/// Returns the goals that a request asks to cancel. The field is private in `ros2-client`, so it is
/// decoded from the serialised request.
fn goal_info(request: &CancelGoalRequest) -> Option<GoalInfo> {
    #[derive(Deserialize)]
    struct CancelledGoal {
        goal_info: GoalInfo,
    }
    let bytes = cdr_encoding::to_vec::<_, LittleEndian>(request).ok()?;
    let (request, _) = cdr_encoding::from_bytes::<CancelledGoal, LittleEndian>(&bytes).ok()?;
    Some(request.goal_info)
}

/// Logs responses that could not be sent.
fn log_failure<E: std::fmt::Debug>(written: Result<(), E>) {
    if let Err(error) = written {
        tracing::warn!("an answer was not sent: {error:?}");
    }
}
