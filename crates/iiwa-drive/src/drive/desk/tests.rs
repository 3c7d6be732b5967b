//! What the desk does when something gets lost between it and the robot program, and that a stop
//! withdraws what has not begun.

use iiwa_kin::Robot;
use iiwa_link::TimedJoints;
use iiwa_path::{Motion, Ptp};
use serde_json::{Value, json};

use super::*;
use crate::{
    drive::checks::{Done, carry_out},
    robot_program::{Acknowledgement, Outcome},
};

const FIRST_RUN: RunId = 100;

/// A desk with a clock that is told how late it is.
struct Scene {
    desk: Desk<&'static str>,
    /// Runs that are to be checked.
    jobs: Vec<Job<&'static str>>,
    now: Instant,
}

/// What came out, but for orders and checks.
#[derive(Debug, PartialEq)]
enum Out {
    Reply(&'static str, Value),
    Instruct(Value),
    Reconnect,
}

impl Scene {
    /// The robot program is idle, and the robot can be seen.
    fn new() -> Self {
        let mut scene = Self { desk: Desk::new(FIRST_RUN), jobs: Vec::new(), now: Instant::now() };
        scene.say(DriveState::Idle, None, None);
        scene
    }

    fn say(&mut self, state: DriveState, run: Option<RunId>, ended: Option<RunId>) {
        let outcome = ended.map(|run| Outcome { run, start_s: None, end_s: 1.0, error: None });
        self.see();
        self.desk.changed(StateChange { boot: 1, state, run, outcome }, self.now);
    }

    fn see(&mut self) {
        let heard = Heard {
            t_s: 2.0,
            clock_ahead_s: 0.0,
            joints_rad: [0.0; 7],
            session: SessionState::MonitoringReady,
            quality: Quality::Excellent,
            safety: Safety::Normal,
            lost: 0,
            late: 0,
            at: self.now,
        };
        self.desk.heard(Event::Heard(heard), self.now);
    }

    fn ask(&mut self, client: &'static str, request: &Value) {
        self.request(client, request.to_string());
    }

    fn request(&mut self, client: &'static str, body: String) {
        let asking = Asking { body: body.into(), permit: None, began: self.now };
        self.desk.request(client, asking, self.now);
    }

    fn ask_for_motion(&mut self) {
        let motions = vec![Motion::Ptp(Ptp::to([0.1; 7]))];
        self.request("runner", Request::RunMotions { motions }.to_json());
    }

    /// What is to be checked is.
    fn check(&mut self) -> Vec<Out> {
        let out = self.out();
        for job in std::mem::take(&mut self.jobs) {
            match carry_out(&Robot::default(), job) {
                Done::Checked(checked) => self.desk.checked(checked, self.now),
                Done::Refused(..) => panic!("none of them is long"),
            }
        }
        out
    }

    fn begin_motion(&mut self) {
        self.ask_for_motion();
        assert_eq!(self.check(), []);
    }

    fn begin_trajectory(&mut self) {
        let trajectory = TimedJoints { t_s: vec![0.0, 1.0], joints_rad: vec![[0.0; 7]; 2] };
        self.request("runner", Request::RunTrajectory { trajectory }.to_json());
        assert_eq!(self.check(), []);
    }

    fn acknowledge(&mut self, seq: u64) {
        let answer = Acknowledgement { seq: Some(seq), ..Acknowledgement::default() };
        self.desk.acknowledged(answer, self.now);
    }

    fn refuse(&mut self, seq: u64) {
        let error = Some(Refusal::new(Code::NotIdle, "busy"));
        let answer = Acknowledgement { seq: Some(seq), error, ..Acknowledgement::default() };
        self.desk.acknowledged(answer, self.now);
    }

    /// Time passes.
    fn wait(&mut self, seconds: f64) {
        self.now += Duration::from_secs_f64(seconds);
        self.desk.tick(self.now);
    }

    fn out(&mut self) -> Vec<Out> {
        let json = |text: &str| serde_json::from_str(text).unwrap();
        let mut out = Vec::new();
        for output in self.desk.take_outputs() {
            match output {
                Output::Reply(client, text) => out.push(Out::Reply(client, json(&text))),
                Output::Answer(answer) => {
                    out.push(Out::Reply(answer.client, json(&answer.write())));
                }
                Output::Instruct(text) => out.push(Out::Instruct(json(&text))),
                Output::Reconnect => out.push(Out::Reconnect),
                Output::Check(job) => self.jobs.push(job),
                Output::Order(_) => {}
            }
        }
        out
    }

    /// The names of the instructions that came out.
    fn instructions(&mut self) -> Vec<String> {
        let name = |out| match out {
            Out::Instruct(instruction) => Some(instruction["type"].as_str()?.to_owned()),
            _ => None,
        };
        self.out().into_iter().filter_map(name).collect()
    }

    /// Whether each client's reply says yes.
    fn replies(&mut self) -> Vec<(&'static str, bool)> {
        let reply = |out| match out {
            Out::Reply(client, reply) => Some((client, reply["ok"] == true)),
            _ => None,
        };
        self.out().into_iter().filter_map(reply).collect()
    }
}

fn stop() -> Value {
    json!({"type": "stop"})
}

#[test]
fn a_stop_that_gets_lost_is_told_again() {
    let mut scene = Scene::new();
    scene.begin_motion();
    scene.acknowledge(1);
    scene.acknowledge(2);
    scene.say(DriveState::RunningMotion, Some(FIRST_RUN), None);
    scene.ask("stopper", &stop());
    assert_eq!(scene.instructions(), ["run_motions", "begin", "stop"]);
    scene.say(DriveState::RunningMotion, Some(FIRST_RUN), None);
    assert_eq!(scene.out(), []);
    scene.wait(2.1);
    assert_eq!(scene.out(), [Out::Reconnect]);
    scene.say(DriveState::RunningMotion, Some(FIRST_RUN), None);
    assert_eq!(scene.instructions(), ["stop"]);
    scene.acknowledge(4);
    scene.say(DriveState::Idle, None, Some(FIRST_RUN));
    assert_eq!(scene.replies(), [("runner", true), ("stopper", true)]);
}

#[test]
fn the_end_of_a_trajectory_that_gets_lost_is_told_again() {
    let mut scene = Scene::new();
    scene.begin_trajectory();
    scene.acknowledge(1);
    scene.say(DriveState::RunningTrajectory, Some(FIRST_RUN), None);
    let over = |run| Event::Over(Over { run, start_s: 0.0, end_s: 1.0, error: None });
    // Of another run: that does not end this one.
    scene.desk.heard(over(FIRST_RUN - 1), scene.now);
    assert_eq!(scene.instructions(), ["run_trajectory"]);
    scene.desk.heard(over(FIRST_RUN), scene.now);
    assert_eq!(scene.instructions(), ["end_trajectory"]);
    scene.wait(2.1);
    scene.say(DriveState::RunningTrajectory, Some(FIRST_RUN), None);
    assert_eq!(scene.instructions(), ["end_trajectory"]);
}

#[test]
fn a_lost_acknowledgement_does_not_hold_up_a_stop() {
    let mut scene = Scene::new();
    scene.begin_motion();
    scene.acknowledge(1);
    scene.say(DriveState::RunningMotion, Some(FIRST_RUN), None);
    scene.ask("stopper", &stop());
    assert_eq!(scene.instructions(), ["run_motions", "begin", "stop"]);
}

#[test]
fn runs_that_were_given_up_are_stopped_whenever_they_begin() {
    let mut scene = Scene::new();
    scene.begin_motion();
    for _ in 0..61 {
        scene.wait(1.0);
        scene.say(DriveState::Idle, None, None);
    }
    assert!(scene.out().contains(&Out::Reconnect));
    // Another one is refused, because the first one has begun after all.
    scene.begin_motion();
    scene.refuse(2);
    assert_eq!(scene.instructions(), ["run_motions"]);
    scene.say(DriveState::RunningMotion, Some(FIRST_RUN), None);
    assert_eq!(scene.instructions(), ["stop"]);
    // And again, if that gets lost.
    scene.wait(2.1);
    scene.say(DriveState::RunningMotion, Some(FIRST_RUN), None);
    assert_eq!(scene.instructions(), ["stop"]);
}

#[test]
fn what_ran_before_is_left_alone_until_it_is_to_stop() {
    let mut scene = Scene::new();
    scene.say(DriveState::RunningMotion, Some(7), None);
    assert_eq!(scene.out(), []);
    scene.ask("stopper", &stop());
    assert_eq!(scene.instructions(), ["stop"]);
    scene.acknowledge(1);
    scene.say(DriveState::RunningMotion, Some(7), None);
    // Not before the arm stands.
    assert_eq!(scene.replies(), []);
    scene.acknowledge(2);
    scene.say(DriveState::Idle, None, Some(7));
    assert_eq!(scene.replies(), [("stopper", true)]);
    // But a trajectory that nobody feeds is ended.
    scene.say(DriveState::RunningTrajectory, Some(8), None);
    assert_eq!(scene.instructions(), ["end_trajectory"]);
}

#[test]
fn nobody_is_told_of_standing_while_nobody_knows() {
    let mut scene = Scene::new();
    scene.ask("stopper", &stop());
    assert_eq!(scene.replies(), [("stopper", true)]);
    scene.wait(3.1);
    scene.ask("stopper", &stop());
    let out = scene.out();
    assert!(out.iter().any(|out| matches!(out, Out::Instruct(it) if it["type"] == "stop")));
    assert!(
        out.iter().any(|out| matches!(out, Out::Reply("stopper", it) if it["ok"] == false)),
        "{out:?}"
    );
}

/// The error of the runner, and whether the stopper was answered.
fn withdrawn(scene: &mut Scene) -> (String, bool) {
    let mut error = String::new();
    let mut stopped = false;
    for out in scene.out() {
        match out {
            Out::Reply("runner", reply) => error = reply["error"]["message"].to_string(),
            Out::Reply("stopper", reply) => stopped = reply["ok"] == true,
            Out::Instruct(instruction) => assert_ne!(instruction["type"], "begin"),
            other => panic!("{other:?}"),
        }
    }
    (error, stopped)
}

#[test]
fn a_stop_withdraws_a_run_that_is_checked() {
    let mut scene = Scene::new();
    scene.ask_for_motion();
    scene.ask("stopper", &stop());
    // At once: nothing can move any more.
    let answered = scene.check();
    assert_eq!(answered, [Out::Reply("stopper", json!({"ok": true}))]);
    let (error, _) = withdrawn(&mut scene);
    assert!(error.contains("before the run was begun"), "{error}");
    // The next one is not affected.
    scene.begin_motion();
    assert_eq!(scene.instructions(), ["run_motions"]);
}

#[test]
fn a_stop_withdraws_a_run_that_is_planned() {
    let mut scene = Scene::new();
    scene.begin_motion();
    assert_eq!(scene.instructions(), ["run_motions"]);
    scene.ask("stopper", &stop());
    let (error, stopped) = withdrawn(&mut scene);
    assert!(stopped && error.contains("before the run was begun"), "{error}");
    // Its planning ends: it does not begin.
    scene.acknowledge(1);
    scene.say(DriveState::Idle, None, None);
    assert_eq!(scene.out(), []);
}

#[test]
fn a_stop_withdraws_a_run_that_is_still_read() {
    let mut scene = Scene::new();
    let began = scene.now;
    scene.wait(0.01);
    scene.ask("stopper", &stop());
    assert_eq!(scene.replies(), [("stopper", true)]);
    let motions = vec![Motion::Ptp(Ptp::to([0.1; 7]))];
    let body = Request::RunMotions { motions }.to_json().into();
    scene.desk.request("runner", Asking { body, permit: None, began }, scene.now);
    assert_eq!(scene.check().len(), 1);
    scene.begin_motion();
    assert_eq!(scene.instructions(), ["run_motions"]);
}

#[test]
fn a_client_that_goes_takes_its_run_with_it_before_it_begins() {
    for stage in ["checked", "planned"] {
        let mut scene = Scene::new();
        scene.ask_for_motion();
        if stage == "planned" {
            assert_eq!(scene.check(), []);
            assert_eq!(scene.instructions(), ["run_motions"]);
        }
        scene.desk.gone(|client| *client == "other", scene.now);
        scene.desk.gone(|client| *client == "runner", scene.now);
        scene.check();
        let (error, _) = withdrawn(&mut scene);
        assert!(error.contains("client has gone") || stage == "planned", "{error}");
        scene.acknowledge(1);
        assert_eq!(scene.instructions(), [""; 0]);
    }
    // From then on it goes on without its client.
    let mut scene = Scene::new();
    scene.begin_motion();
    scene.acknowledge(1);
    scene.acknowledge(2);
    scene.out();
    scene.desk.gone(|client| *client == "runner", scene.now);
    assert_eq!(scene.out(), []);
}

#[test]
fn a_run_that_was_given_up_leaves_a_stop_in_doubt() {
    let mut scene = Scene::new();
    scene.begin_motion();
    scene.acknowledge(1);
    // That it is to begin is not acknowledged.
    scene.wait(2.1);
    scene.out();
    scene.ask("stopper", &stop());
    assert_eq!(scene.replies(), []);
    scene.now += Duration::from_millis(10);
    scene.say(DriveState::Idle, None, None);
    assert_eq!(scene.replies(), [("stopper", true)]);
}

#[test]
fn a_stop_has_an_end_and_a_reason() {
    let mut scene = Scene::new();
    scene.say(DriveState::RunningMotion, Some(7), None);
    scene.ask("stopper", &stop());
    for _ in 0..9 {
        scene.wait(0.5);
        scene.say(DriveState::RunningMotion, Some(7), None);
    }
    let replies = scene.out();
    let reply = replies.iter().find_map(|out| match out {
        Out::Reply("stopper", reply) => Some(reply),
        _ => None,
    });
    assert_eq!(reply.unwrap()["error"]["code"], "timeout");
}
