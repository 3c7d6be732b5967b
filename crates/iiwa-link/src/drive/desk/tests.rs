//! What the desk does when something gets lost between it and the robot program.

use iiwa_path::Ptp;
use serde_json::{Value, json};

use super::*;
use crate::robot_program::Outcome;

const FIRST_RUN: RunId = 100;

/// A desk with a clock that is told how late it is.
struct Scene {
    desk: Desk<&'static str>,
    now: Instant,
}

/// What came out, but for orders.
#[derive(Debug, PartialEq)]
enum Out {
    Reply(&'static str, Value),
    Instruct(Value),
    Reconnect,
}

impl Scene {
    /// The robot program is idle, and the robot can be seen.
    fn new() -> Self {
        let mut scene = Self { desk: Desk::new(Robot::default(), FIRST_RUN), now: Instant::now() };
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
        self.desk.request(client, request.to_string().as_bytes(), self.now);
    }

    fn begin_motion(&mut self) {
        let motions = vec![Motion::Ptp(Ptp::to([0.1; 7]))];
        let request = Request::RunMotions { motions }.to_json();
        self.desk.request("runner", request.as_bytes(), self.now);
    }

    fn begin_trajectory(&mut self) {
        let trajectory = TimedJoints { t_s: vec![0.0, 1.0], joints_rad: vec![[0.0; 7]; 2] };
        let request = Request::RunTrajectory { trajectory }.to_json();
        self.desk.request("runner", request.as_bytes(), self.now);
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
        let known = |output| match output {
            Output::Reply(client, text) => Some(Out::Reply(client, json(&text))),
            Output::Instruct(text) => Some(Out::Instruct(json(&text))),
            Output::Reconnect => Some(Out::Reconnect),
            Output::Order(_) => None,
        };
        self.desk.take_outputs().into_iter().filter_map(known).collect()
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
    scene.say(DriveState::RunningMotion, Some(FIRST_RUN), None);
    scene.ask("stopper", &stop());
    assert_eq!(scene.instructions(), ["run_motions", "stop"]);
    scene.say(DriveState::RunningMotion, Some(FIRST_RUN), None);
    assert_eq!(scene.out(), []);
    scene.wait(2.1);
    assert_eq!(scene.out(), [Out::Reconnect]);
    scene.say(DriveState::RunningMotion, Some(FIRST_RUN), None);
    assert_eq!(scene.instructions(), ["stop"]);
    scene.acknowledge(3);
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
    scene.say(DriveState::RunningMotion, Some(FIRST_RUN), None);
    scene.ask("stopper", &stop());
    assert_eq!(scene.instructions(), ["run_motions", "stop"]);
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
