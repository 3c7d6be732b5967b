//! Goals of an action server, and their states, as in `rcl_action`.
//!
//! `ros2-client` has its own table, but its result futures take requests from each other: with two
//! clients, one of them waits in vain.

use std::time::{Duration, Instant};

use ros2_client::{
    RmwRequestId,
    action::{CancelGoalResponse, GetResultResponse, GoalId, GoalInfo, GoalStatusEnum},
    action_msgs::{CancelGoalResponseEnum, GoalStatus, GoalStatusArray},
    builtin_interfaces,
};

use super::messages::FollowResult;

/// Time for which the result of a goal is kept, as in `rcl_action`.
const KEPT: Duration = Duration::from_mins(15);

/// Maximum number of stored goals; the oldest are removed first.
const MOST: usize = 64;

/// Maximum number of clients that wait for the same result.
const MAX_WAITING: usize = 16;

/// Outcome of a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// The robot is at the goal.
    Reached,
    /// The robot is not at the goal.
    Failed,
}

/// An accepted goal.
#[derive(Debug)]
struct AcceptedGoal {
    info: GoalInfo,
    status: GoalStatusEnum,
    result: Option<(FollowResult, Instant)>,
    waiting: Vec<RmwRequestId>,
}

/// Goals of a server.
#[derive(Debug, Default)]
pub(super) struct Goals(Vec<AcceptedGoal>);

impl Goals {
    /// Returns the active goal, and `true` if it is being cancelled.
    pub(super) fn active(&self) -> Option<(GoalId, bool)> {
        let active = self.0.iter().find(|entry| entry.result.is_none())?;
        Some((active.info.goal_id, active.status == GoalStatusEnum::Canceling))
    }

    /// Returns true if a goal with this id is known.
    pub(super) fn knows(&self, id: GoalId) -> bool {
        self.0.iter().any(|entry| entry.info.goal_id == id)
    }

    /// Begins a goal.
    pub(super) fn begin(&mut self, goal_id: GoalId, stamp: builtin_interfaces::Time) {
        self.0.retain(|entry| {
            entry.result.as_ref().is_none_or(|(_, instant)| instant.elapsed() < KEPT)
        });
        if self.0.len() >= MOST {
            self.0.remove(0);
        }
        self.0.push(AcceptedGoal {
            info: GoalInfo { goal_id, stamp },
            status: GoalStatusEnum::Executing,
            result: None,
            waiting: Vec::new(),
        });
    }

    /// Ends the active goal. Returns the requests to answer, and the response.
    pub(super) fn end(
        &mut self,
        end: End,
        result: FollowResult,
    ) -> Option<(Vec<RmwRequestId>, GetResultResponse<FollowResult>)> {
        let entry = self.0.iter_mut().find(|entry| entry.result.is_none())?;
        entry.status = match (end, entry.status) {
            (End::Reached, _) => GoalStatusEnum::Succeeded,
            (End::Failed, GoalStatusEnum::Canceling) => GoalStatusEnum::Canceled,
            (End::Failed, _) => GoalStatusEnum::Aborted,
        };
        // A requested stop is not a failure of the goal.
        let result = if entry.status == GoalStatusEnum::Canceled {
            FollowResult::new(FollowResult::SUCCESSFUL, result.error_string)
        } else {
            result
        };
        entry.result = Some((result.clone(), Instant::now()));
        let waiting = std::mem::take(&mut entry.waiting);
        Some((waiting, GetResultResponse { status: entry.status, result }))
    }

    /// Marks the goals that a request asks to cancel: one, all, or all up to a time.
    pub(super) fn cancel(&mut self, request: &GoalInfo) -> CancelGoalResponse {
        let all_until = |info: &GoalInfo| {
            let any_time = request.stamp == builtin_interfaces::Time::ZERO;
            if any_time { request.goal_id == GoalId::ZERO } else { info.stamp <= request.stamp }
        };
        let mut goals_canceling = Vec::new();
        for entry in &mut self.0 {
            let is_meant = entry.info.goal_id == request.goal_id || all_until(&entry.info);
            if is_meant && entry.result.is_none() {
                entry.status = GoalStatusEnum::Canceling;
                goals_canceling.push(entry.info.clone());
            }
        }
        let return_code = if !goals_canceling.is_empty() {
            CancelGoalResponseEnum::None
        } else if request.goal_id == GoalId::ZERO {
            CancelGoalResponseEnum::Rejected
        } else if self.knows(request.goal_id) {
            CancelGoalResponseEnum::GoalTerminated
        } else {
            CancelGoalResponseEnum::UnknownGoal
        };
        CancelGoalResponse { return_code, goals_canceling }
    }

    /// Returns the result of a goal, if it has ended or is unknown; otherwise stores the request
    /// until the goal ends.
    pub(super) fn result(
        &mut self,
        id: GoalId,
        request: RmwRequestId,
    ) -> Option<GetResultResponse<FollowResult>> {
        let Some(entry) = self.0.iter_mut().find(|entry| entry.info.goal_id == id) else {
            let result = FollowResult::default();
            return Some(GetResultResponse { status: GoalStatusEnum::Unknown, result });
        };
        if let Some((result, _)) = &entry.result {
            return Some(GetResultResponse { status: entry.status, result: result.clone() });
        }
        if entry.waiting.len() < MAX_WAITING && !entry.waiting.contains(&request) {
            entry.waiting.push(request);
        }
        None
    }

    /// Returns the published goal states.
    pub(super) fn statuses(&self) -> GoalStatusArray {
        let status = |entry: &AcceptedGoal| GoalStatus {
            goal_info: entry.info.clone(),
            status: entry.status,
        };
        GoalStatusArray { status_list: self.0.iter().map(status).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(id: GoalId) -> GoalInfo {
        GoalInfo { goal_id: id, stamp: builtin_interfaces::Time::ZERO }
    }

    fn request(sequence_number: i64) -> RmwRequestId {
        RmwRequestId { sequence_number, ..RmwRequestId::default() }
    }

    fn begun() -> (Goals, GoalId) {
        let (mut goals, id) = (Goals::default(), GoalId::new_random());
        goals.begin(id, builtin_interfaces::Time::now());
        (goals, id)
    }

    #[test]
    fn results_come_at_the_end_and_later() {
        let (mut goals, id) = begun();
        assert_eq!(goals.active(), Some((id, false)));
        assert!(goals.result(id, request(1)).is_none());
        assert!(goals.result(id, request(2)).is_none());
        let (waiting, response) = goals.end(End::Reached, FollowResult::default()).unwrap();
        assert_eq!(waiting, [request(1), request(2)]);
        assert_eq!(response.status, GoalStatusEnum::Succeeded);
        assert_eq!(goals.result(id, request(3)).unwrap().status, GoalStatusEnum::Succeeded);
        assert_eq!(goals.active(), None);
        let unknown = goals.result(GoalId::new_random(), request(4)).unwrap();
        assert_eq!(unknown.status, GoalStatusEnum::Unknown);
    }

    #[test]
    fn a_cancelled_goal_is_cancelled_once() {
        for requested in [GoalId::ZERO, begun().1] {
            let (mut goals, id) = begun();
            let requested = if requested == GoalId::ZERO { requested } else { id };
            let response = goals.cancel(&one(requested));
            assert_eq!(response.return_code, CancelGoalResponseEnum::None);
            assert_eq!(response.goals_canceling.len(), 1);
            assert_eq!(goals.active(), Some((id, true)));
            let stopped = FollowResult::new(FollowResult::PATH_TOLERANCE_VIOLATED, "stopped");
            let (_, response) = goals.end(End::Failed, stopped).unwrap();
            assert_eq!(response.status, GoalStatusEnum::Canceled);
            assert_eq!(response.result.error_code, FollowResult::SUCCESSFUL);
            let again = goals.cancel(&one(id)).return_code;
            assert_eq!(again, CancelGoalResponseEnum::GoalTerminated);
        }
        let unknown = begun().0.cancel(&one(GoalId::new_random())).return_code;
        assert_eq!(unknown, CancelGoalResponseEnum::UnknownGoal);
        assert_eq!(
            Goals::default().cancel(&one(GoalId::ZERO)).return_code,
            CancelGoalResponseEnum::Rejected
        );
    }

    #[test]
    fn old_goals_are_forgotten() {
        let mut goals = Goals::default();
        for _ in 0..3 * MOST {
            goals.begin(GoalId::new_random(), builtin_interfaces::Time::now());
            goals.end(End::Failed, FollowResult::default());
        }
        assert_eq!(goals.statuses().status_list.len(), MOST);
    }
}
