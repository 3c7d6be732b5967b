//! Lost messages between the dispatcher and the robot program, and stops of runs that have not
//! begun.

use std::time::{Duration, Instant};

use iiwa_fri::{Quality, Safety, SessionState};
use iiwa_kin::Robot;
use iiwa_link::{
    TimedJoints,
    message::{Code, DriveState, Refusal, Request, RobotIdentity},
    robot_program::{Acknowledgement, Outcome, RunId, StateChange},
};
use iiwa_program::{Motion, Ptp};
use serde_json::{Value, json};

use super::{Dispatcher, DispatcherOutput, IncomingRequest};
use crate::drive::{
    checks::{CheckJob, CheckResult, carry_out},
    events::{FriEvent, Observation},
    setpoints::TrajectoryEnd,
};

const FIRST_RUN: RunId = 100;

/// A dispatcher with a simulated clock.
struct DispatcherScene {
    dispatcher: Dispatcher<&'static str>,
    /// Runs to be checked.
    jobs: Vec<CheckJob<&'static str>>,
    now: Instant,
}

/// Outputs except FRI commands and checks.
#[derive(Debug, PartialEq)]
enum TestOutput {
    Reply(&'static str, Value),
    Instruct(Value),
    Reconnect,
}

impl DispatcherScene {
    /// Creates a scene with an idle robot program and a connected FRI session.
    fn new() -> Self {
        let mut scene = Self {
            dispatcher: Dispatcher::new(FIRST_RUN, RobotIdentity::from(&Robot::default())),
            jobs: Vec::new(),
            now: Instant::now(),
        };
        scene.report(DriveState::Idle, None, None);
        scene
    }

    fn report(&mut self, state: DriveState, run: Option<RunId>, ended: Option<RunId>) {
        let outcome =
            ended.map(|run| Outcome { run, start_s: None, end_s: Some(1.0), error: None });
        self.observe();
        self.dispatcher.state_changed(
            StateChange { boot: 1, state, run, outcome, ..StateChange::default() },
            self.now,
        );
    }

    fn observe(&mut self) {
        self.observe_with(Safety::Normal);
    }

    fn observe_with(&mut self, safety: Safety) {
        let observation = Observation {
            t_s: 2.0,
            clock_ahead_s: 0.0,
            joints_rad: [0.0; 7],
            commanded_rad: Some([0.0; 7]),
            torques_nm: None,
            session: SessionState::MonitoringReady,
            quality: Quality::Excellent,
            safety,
            lost: 0,
            late: 0,
            at: self.now,
        };
        self.dispatcher.fri_event(FriEvent::Observed(observation), self.now);
    }

    fn send(&mut self, client: &'static str, request: &Value) {
        self.request(client, request.to_string());
    }

    fn request(&mut self, client: &'static str, body: String) {
        let incoming = IncomingRequest { body: body.into(), permit: None, began: self.now };
        self.dispatcher.request(client, incoming, self.now);
    }

    fn request_motion(&mut self) {
        let motions = vec![Motion::Ptp(Ptp::to([0.1; 7]))];
        self.request("runner", Request::motions(motions).to_json());
    }

    /// Checks the pending runs.
    fn check(&mut self) -> Vec<TestOutput> {
        let out = self.out();
        for job in std::mem::take(&mut self.jobs) {
            match carry_out(&Robot::default(), job) {
                CheckResult::Checked(checked) => self.dispatcher.checked(checked, self.now),
                CheckResult::Refused(..) => panic!("none of them is long"),
            }
        }
        out
    }

    fn begin_motion(&mut self) {
        self.request_motion();
        assert_eq!(self.check(), []);
    }

    fn begin_trajectory(&mut self) {
        let trajectory = TimedJoints { t_s: vec![0.0, 1.0], joints_rad: vec![[0.0; 7]; 2] };
        self.request("runner", Request::trajectory(trajectory).to_json());
        assert_eq!(self.check(), []);
    }

    fn acknowledge(&mut self, seq: u64) {
        let answer = Acknowledgement { seq: Some(seq), ..Acknowledgement::default() };
        self.dispatcher.acknowledged(answer, self.now);
    }

    fn reject(&mut self, seq: u64) {
        let error = Some(Refusal::new(Code::NotIdle, "busy"));
        let answer = Acknowledgement { seq: Some(seq), error, ..Acknowledgement::default() };
        self.dispatcher.acknowledged(answer, self.now);
    }

    /// Advances the clock.
    fn wait(&mut self, seconds: f64) {
        self.now += Duration::from_secs_f64(seconds);
        self.dispatcher.tick(self.now);
    }

    fn out(&mut self) -> Vec<TestOutput> {
        let json = |text: &str| serde_json::from_str(text).unwrap();
        let mut out = Vec::new();
        for output in self.dispatcher.take_outputs() {
            match output {
                DispatcherOutput::Reply(client, text) => {
                    out.push(TestOutput::Reply(client, json(&text)));
                }
                DispatcherOutput::RunReply(reply) => {
                    out.push(TestOutput::Reply(reply.client, json(&reply.to_json())));
                }
                DispatcherOutput::Instruct(text) => out.push(TestOutput::Instruct(json(&text))),
                DispatcherOutput::Reconnect => out.push(TestOutput::Reconnect),
                DispatcherOutput::Check(job) => self.jobs.push(job),
                DispatcherOutput::Fri(_) | DispatcherOutput::Publish(_) => {}
            }
        }
        out
    }

    /// Returns the types of the instructions sent.
    fn instructions(&mut self) -> Vec<String> {
        let name = |out| match out {
            TestOutput::Instruct(instruction) => Some(instruction["type"].as_str()?.to_owned()),
            _ => None,
        };
        self.out().into_iter().filter_map(name).collect()
    }

    /// Returns the clients that received replies, and `true` for each `ok`.
    fn replies(&mut self) -> Vec<(&'static str, bool)> {
        let reply = |out| match out {
            TestOutput::Reply(client, reply) => Some((client, reply["ok"] == true)),
            _ => None,
        };
        self.out().into_iter().filter_map(reply).collect()
    }
}

fn stop() -> Value {
    json!({"type": "stop"})
}

#[test]
fn a_safety_stop_is_reported() {
    let mut scene = DispatcherScene::new();
    let mut reported = |safety| {
        scene.observe_with(safety);
        scene.dispatcher.status(scene.now).fri.safety_stop
    };
    assert_eq!(
        [Safety::Normal, Safety::Stop1, Safety::Normal].map(&mut reported),
        [false, true, false]
    );
}

#[test]
fn a_lost_stop_is_repeated() {
    let mut scene = DispatcherScene::new();
    scene.begin_motion();
    scene.acknowledge(1);
    scene.acknowledge(2);
    scene.report(DriveState::RunningMotion, Some(FIRST_RUN), None);
    scene.send("stopper", &stop());
    assert_eq!(scene.instructions(), ["run_motions", "begin", "stop"]);
    scene.report(DriveState::RunningMotion, Some(FIRST_RUN), None);
    assert_eq!(scene.out(), []);
    scene.wait(2.1);
    assert_eq!(scene.out(), [TestOutput::Reconnect]);
    scene.report(DriveState::RunningMotion, Some(FIRST_RUN), None);
    assert_eq!(scene.instructions(), ["stop"]);
    scene.acknowledge(4);
    scene.report(DriveState::Idle, None, Some(FIRST_RUN));
    assert_eq!(scene.replies(), [("runner", true), ("stopper", true)]);
}

#[test]
fn a_lost_end_of_a_trajectory_is_repeated() {
    let mut scene = DispatcherScene::new();
    scene.begin_trajectory();
    scene.acknowledge(1);
    scene.report(DriveState::RunningTrajectory, Some(FIRST_RUN), None);
    let end = |run| FriEvent::Ended(TrajectoryEnd { run, start_s: 0.0, end_s: 1.0, error: None });
    // The end of another run does not end this one.
    scene.dispatcher.fri_event(end(FIRST_RUN - 1), scene.now);
    assert_eq!(scene.instructions(), ["run_trajectory"]);
    scene.dispatcher.fri_event(end(FIRST_RUN), scene.now);
    assert_eq!(scene.instructions(), ["end_trajectory"]);
    scene.wait(2.1);
    scene.report(DriveState::RunningTrajectory, Some(FIRST_RUN), None);
    assert_eq!(scene.instructions(), ["end_trajectory"]);
}

#[test]
fn a_lost_acknowledgement_does_not_delay_a_stop() {
    let mut scene = DispatcherScene::new();
    scene.begin_motion();
    scene.acknowledge(1);
    scene.report(DriveState::RunningMotion, Some(FIRST_RUN), None);
    scene.send("stopper", &stop());
    assert_eq!(scene.instructions(), ["run_motions", "begin", "stop"]);
}

#[test]
fn abandoned_runs_are_stopped_when_they_begin() {
    let mut scene = DispatcherScene::new();
    scene.begin_motion();
    for _ in 0..61 {
        scene.wait(1.0);
        scene.report(DriveState::Idle, None, None);
    }
    assert!(scene.out().contains(&TestOutput::Reconnect));
    // Another run is refused, because the first one has begun after all.
    scene.begin_motion();
    scene.reject(2);
    assert_eq!(scene.instructions(), ["run_motions"]);
    scene.report(DriveState::RunningMotion, Some(FIRST_RUN), None);
    assert_eq!(scene.instructions(), ["stop"]);
    // The stop is repeated if it is lost.
    scene.wait(2.1);
    scene.report(DriveState::RunningMotion, Some(FIRST_RUN), None);
    assert_eq!(scene.instructions(), ["stop"]);
}

#[test]
fn a_foreign_motion_continues_until_it_is_stopped() {
    let mut scene = DispatcherScene::new();
    scene.report(DriveState::RunningMotion, Some(7), None);
    assert_eq!(scene.out(), []);
    scene.send("stopper", &stop());
    assert_eq!(scene.instructions(), ["stop"]);
    scene.acknowledge(1);
    scene.report(DriveState::RunningMotion, Some(7), None);
    // The reply is not sent before the robot is at rest.
    assert_eq!(scene.replies(), []);
    scene.acknowledge(2);
    scene.report(DriveState::Idle, None, Some(7));
    assert_eq!(scene.replies(), [("stopper", true)]);
    // A trajectory without set-points, in contrast, is ended.
    scene.report(DriveState::RunningTrajectory, Some(8), None);
    assert_eq!(scene.instructions(), ["end_trajectory"]);
}

#[test]
fn a_stop_fails_while_the_state_of_the_arm_is_unknown() {
    let mut scene = DispatcherScene::new();
    scene.send("stopper", &stop());
    assert_eq!(scene.replies(), [("stopper", true)]);
    scene.wait(3.1);
    scene.send("stopper", &stop());
    let out = scene.out();
    assert!(out.iter().any(|out| matches!(out, TestOutput::Instruct(it) if it["type"] == "stop")));
    assert!(
        out.iter().any(|out| matches!(out, TestOutput::Reply("stopper", it) if it["ok"] == false)),
        "{out:?}"
    );
}

/// Returns the error of the runner, and true if the stopper was answered.
fn withdrawn(scene: &mut DispatcherScene) -> (String, bool) {
    let mut error = String::new();
    let mut stopped = false;
    for out in scene.out() {
        match out {
            TestOutput::Reply("runner", reply) => error = reply["error"]["message"].to_string(),
            TestOutput::Reply("stopper", reply) => stopped = reply["ok"] == true,
            TestOutput::Instruct(instruction) => assert_ne!(instruction["type"], "begin"),
            other => panic!("{other:?}"),
        }
    }
    (error, stopped)
}

#[test]
fn a_stop_withdraws_a_run_being_checked() {
    let mut scene = DispatcherScene::new();
    scene.request_motion();
    scene.send("stopper", &stop());
    // Immediately: no motion is possible any more.
    let answered = scene.check();
    assert_eq!(answered, [TestOutput::Reply("stopper", json!({"ok": true}))]);
    let (error, _) = withdrawn(&mut scene);
    assert!(error.contains("before the run began"), "{error}");
    // The next run is not affected.
    scene.begin_motion();
    assert_eq!(scene.instructions(), ["run_motions"]);
}

#[test]
fn a_stop_withdraws_a_run_being_planned() {
    let mut scene = DispatcherScene::new();
    scene.begin_motion();
    assert_eq!(scene.instructions(), ["run_motions"]);
    scene.send("stopper", &stop());
    let (error, stopped) = withdrawn(&mut scene);
    assert!(stopped && error.contains("before the run began"), "{error}");
    // The run does not begin after planning.
    scene.acknowledge(1);
    scene.report(DriveState::Idle, None, None);
    assert_eq!(scene.out(), []);
}

#[test]
fn a_stop_withdraws_a_run_being_received() {
    let mut scene = DispatcherScene::new();
    let began = scene.now;
    scene.wait(0.01);
    scene.send("stopper", &stop());
    assert_eq!(scene.replies(), [("stopper", true)]);
    let motions = vec![Motion::Ptp(Ptp::to([0.1; 7]))];
    let body = Request::motions(motions).to_json().into();
    scene.dispatcher.request("runner", IncomingRequest { body, permit: None, began }, scene.now);
    assert_eq!(scene.check().len(), 1);
    scene.begin_motion();
    assert_eq!(scene.instructions(), ["run_motions"]);
}

#[test]
fn a_lost_client_withdraws_its_run_before_it_begins() {
    for stage in ["checked", "planned"] {
        let mut scene = DispatcherScene::new();
        scene.request_motion();
        if stage == "planned" {
            assert_eq!(scene.check(), []);
            assert_eq!(scene.instructions(), ["run_motions"]);
        }
        scene.dispatcher.disconnected(|client| *client == "other", scene.now);
        scene.dispatcher.disconnected(|client| *client == "runner", scene.now);
        scene.check();
        let (error, _) = withdrawn(&mut scene);
        assert!(error.contains("client has disconnected") || stage == "planned", "{error}");
        scene.acknowledge(1);
        assert_eq!(scene.instructions(), [""; 0]);
    }
    // A run that has begun continues without its client.
    let mut scene = DispatcherScene::new();
    scene.begin_motion();
    scene.acknowledge(1);
    scene.acknowledge(2);
    scene.out();
    scene.dispatcher.disconnected(|client| *client == "runner", scene.now);
    assert_eq!(scene.out(), []);
}

#[test]
fn a_stop_waits_for_the_state_after_an_abandoned_run() {
    let mut scene = DispatcherScene::new();
    scene.begin_motion();
    scene.acknowledge(1);
    // The start is not acknowledged.
    scene.wait(2.1);
    scene.out();
    scene.send("stopper", &stop());
    assert_eq!(scene.replies(), []);
    scene.now += Duration::from_millis(10);
    scene.report(DriveState::Idle, None, None);
    assert_eq!(scene.replies(), [("stopper", true)]);
}

#[test]
fn a_stop_times_out_with_an_error() {
    let mut scene = DispatcherScene::new();
    scene.report(DriveState::RunningMotion, Some(7), None);
    scene.send("stopper", &stop());
    for _ in 0..9 {
        scene.wait(0.5);
        scene.report(DriveState::RunningMotion, Some(7), None);
    }
    let replies = scene.out();
    let reply = replies.iter().find_map(|out| match out {
        TestOutput::Reply("stopper", reply) => Some(reply),
        _ => None,
    });
    assert_eq!(reply.unwrap()["error"]["code"], "timeout");
}

#[test]
fn a_restarted_robot_program_gets_a_new_connection_and_no_old_instruction() {
    let mut scene = DispatcherScene::new();
    scene.begin_motion();
    assert_eq!(scene.instructions(), ["run_motions"]);
    let restarted = StateChange { boot: 2, ..StateChange::default() };
    scene.dispatcher.state_changed(restarted.clone(), scene.now);
    let out = scene.out();
    assert_eq!(out[0], TestOutput::Reconnect);
    let ended = |out: &TestOutput| match out {
        TestOutput::Reply("runner", it) => it["error"]["message"].to_string().contains("restarted"),
        _ => false,
    };
    assert!(out.iter().any(ended), "{out:?}");
    // An instruction that the previous program has not acknowledged does not block the next one.
    scene.send("asker", &json!({"type": "list_io"}));
    assert_eq!(scene.instructions(), ["list_io"]);
    // An idle connection is replaced, too.
    scene.acknowledge(2);
    scene.out();
    scene.dispatcher.state_changed(StateChange { boot: 3, ..restarted }, scene.now);
    assert_eq!(scene.out(), [TestOutput::Reconnect]);
}

#[test]
fn an_idle_connection_is_replaced_after_a_silence() {
    let mut scene = DispatcherScene::new();
    scene.wait(3.1);
    assert_eq!(scene.out(), []);
    scene.report(DriveState::Idle, None, None);
    assert_eq!(scene.out(), [TestOutput::Reconnect]);
    // The reconnection does not lose a stop that was sent meanwhile.
    scene.wait(3.1);
    scene.send("stopper", &stop());
    assert_eq!(scene.instructions(), ["stop"]);
    scene.report(DriveState::Idle, None, None);
    assert_eq!(scene.out(), []);
}
